//! Fixed-width numbers: rows of machine integers, vertices of 256 bits, behind a double filter.
//!
//! Edge rows have 47-bit moments and 24-bit directions (magnitudes), so that vertices have 195
//! bits and forms 371. A row may exceed that by some bits; the sum of the excesses of all rows of a
//! cone stays within [`Numbers::ROOM`] = 12, so that 2x2 minors of directions fit 64 bits
//! (49 + 12), those of moments 128 (95 + 12), scalar products 256 (221 + 24), forms 512 (371 + 24).

use antumbra_kernel::plucker::{self, Row, bilinear, cofactors, quadric};
use antumbra_kernel::{I256, I512, Int, Sign};
use dashu_int::{IBig, UBig};

use super::modular::residue;
use super::numbers::Numbers;

/// A row with its rounded coefficients.
#[derive(Clone, Debug)]
pub(super) struct FastRow {
    pub exact: Row,
    approx: [f64; 6],
}

impl PartialEq for FastRow {
    fn eq(&self, other: &Self) -> bool {
        self.exact == other.exact
    }
}

impl FastRow {
    pub(super) fn new(exact: Row) -> Self {
        Self {
            exact,
            approx: exact.map(|c| c as f64),
        }
    }
}

/// A vertex with its rounded coordinates.
#[derive(Clone, Debug)]
pub(super) struct FastVertex {
    pub exact: [I256; 6],
    pub approx: [f64; 6],
}

impl FastVertex {
    pub(super) fn new(exact: [I256; 6]) -> Self {
        Self {
            exact,
            approx: exact.map(|c| c.to_f64_scaled(0)),
        }
    }

    pub(super) fn wide(&self) -> [IBig; 6] {
        std::array::from_fn(|k| big(&self.exact[k]))
    }
}

/// A fixed-width integer as a big one.
pub(super) fn big<const N: usize>(v: &Int<N>) -> IBig {
    let negative = v.is_negative();
    let magnitude = if negative { -*v } else { *v };
    let mut bytes = Vec::with_capacity(8 * N);
    for limb in magnitude.limbs() {
        bytes.extend_from_slice(&limb.to_le_bytes());
    }
    let value = IBig::from(UBig::from_le_bytes(&bytes));
    if negative { -value } else { value }
}

/// Coordinates are rounded once (2^-52), products and five sums once each (2^-53): together less
/// than 2^-49 of the sum of magnitudes.
pub(super) const FILTER: f64 = 1.0 / (1_u64 << 48) as f64;

/// The sign of a sum of products whose factors are right to 2^-52, if that is certain.
#[inline]
pub(super) fn filtered(a: &[f64; 6], b: [f64; 6]) -> Option<Sign> {
    let mut sum = 0.0;
    let mut magnitude = 0.0;
    for k in 0..6 {
        let t = a[k] * b[k];
        sum += t;
        magnitude += t.abs();
    }
    if sum.abs() > magnitude * FILTER {
        Some(if sum > 0.0 {
            Sign::Positive
        } else {
            Sign::Negative
        })
    } else {
        None
    }
}

/// Fixed-width numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fast;

impl Numbers for Fast {
    type Row = FastRow;
    type Vertex = FastVertex;
    type Form = I512;

    const ROOM: u32 = 12;

    fn excess(row: &FastRow) -> u32 {
        let bits = |c: &[i64]| {
            c.iter()
                .map(|c| 64 - c.unsigned_abs().leading_zeros())
                .max()
        };
        let moment = bits(&row.exact[..3]).unwrap_or(0).saturating_sub(47);
        let direction = bits(&row.exact[3..]).unwrap_or(0).saturating_sub(24);
        moment.max(direction)
    }

    #[inline]
    fn sign(row: &FastRow, vertex: &FastVertex) -> Sign {
        filtered(&row.approx, vertex.approx)
            .unwrap_or_else(|| plucker::dot(&row.exact, &vertex.exact).sign())
    }

    fn residues(row: &FastRow) -> [u64; 6] {
        row.exact.map(residue)
    }

    fn meet(rows: [&FastRow; 5]) -> FastVertex {
        FastVertex::new(cofactors(rows.map(|r| &r.exact)))
    }

    fn opposite(vertex: &FastVertex) -> FastVertex {
        FastVertex {
            exact: vertex.exact.map(|c| -c),
            approx: vertex.approx.map(|c| -c),
        }
    }

    fn complement(row: &FastRow) -> FastRow {
        FastRow {
            exact: row.exact.map(|c| -c),
            approx: row.approx.map(|c| -c),
        }
    }

    fn quadric(vertex: &FastVertex) -> I512 {
        quadric(&vertex.exact)
    }

    fn bilinear(v: &FastVertex, w: &FastVertex) -> I512 {
        bilinear(&v.exact, &w.exact)
    }

    #[inline]
    fn bilinear_sign(v: &FastVertex, w: &FastVertex) -> Sign {
        let a = w.approx;
        filtered(&v.approx, [a[3], a[4], a[5], a[0], a[1], a[2]])
            .unwrap_or_else(|| Self::bilinear(v, w).sign())
    }

    fn form_sign(form: &I512) -> Sign {
        form.sign()
    }

    fn crosses(b: &I512, q: &I512, r: &I512) -> bool {
        let (b, q, r) = (b.resize::<16>(), q.resize::<16>(), r.resize::<16>());
        (b.times(&b) - q.times(&r).times_i64(4))
            .sign()
            .is_positive()
    }

    fn wide(row: &FastRow) -> [IBig; 6] {
        row.exact.map(IBig::from)
    }
}
