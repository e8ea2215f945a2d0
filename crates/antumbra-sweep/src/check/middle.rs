//! Numbers of twice the width, for the common lines of oblique planes.
//!
//! Rows of 128-bit integers, vertices of 512 bits. The sum of the excesses of any five rows of a
//! cone stays within [`Numbers::ROOM`] = 140, so that scalar products with a row of at most 127
//! bits fit 512 bits (195 + 140 + 130) and forms 1024 (371 + 280).

use antumbra_kernel::{I512, Int, Sign};
use dashu_int::IBig;

use super::fast::{FastRow, FastVertex, big, filtered};
use super::modular::prime;
use super::numbers::Numbers;

/// A row with its rounded coefficients.
#[derive(Clone, Debug)]
pub(super) struct MiddleRow {
    pub exact: [i128; 6],
    approx: [f64; 6],
}

impl PartialEq for MiddleRow {
    fn eq(&self, other: &Self) -> bool {
        self.exact == other.exact
    }
}

impl MiddleRow {
    pub(super) fn new(exact: [i128; 6]) -> Self {
        Self {
            exact,
            approx: exact.map(|c| c as f64),
        }
    }

    pub(super) fn of(row: &FastRow) -> Self {
        Self::new(row.exact.map(i128::from))
    }
}

/// A vertex with its rounded coordinates.
#[derive(Clone, Debug)]
pub(super) struct MiddleVertex {
    exact: [I512; 6],
    approx: [f64; 6],
}

impl MiddleVertex {
    pub(super) fn new(exact: [I512; 6]) -> Self {
        Self {
            exact,
            approx: exact.map(|c| c.to_f64_scaled(0)),
        }
    }

    pub(super) fn of(vertex: &FastVertex) -> Self {
        Self {
            exact: vertex.exact.map(|c| c.resize()),
            approx: vertex.approx,
        }
    }
}

/// The sign of a row at a narrow vertex, exact.
pub(super) fn middle_sign(row: &MiddleRow, vertex: &FastVertex) -> Sign {
    filtered(&row.approx, vertex.approx)
        .unwrap_or_else(|| Middle::sign(row, &MiddleVertex::of(vertex)))
}

/// A product of values that are often much shorter than their type.
fn product(a: &I512, b: &I512) -> I512 {
    match (short(a), short(b)) {
        (Some(a), Some(b)) => I512::product_i128(a, b),
        _ => a.times(b),
    }
}

fn short(v: &I512) -> Option<i128> {
    let limbs = v.limbs();
    let value = (u128::from(limbs[1]) << 64 | u128::from(limbs[0])) as i128;
    let fill = (value >> 127) as u64;
    // The product of magnitudes needs the most negative value to be left out.
    (limbs[2..].iter().all(|&l| l == fill) && value != i128::MIN).then_some(value)
}

/// Numbers of twice the width.
#[derive(Clone, Copy, Debug)]
pub(super) struct Middle;

impl Numbers for Middle {
    type Row = MiddleRow;
    type Vertex = MiddleVertex;
    type Form = Int<16>;

    const ROOM: u32 = 140;

    fn excess(row: &MiddleRow) -> u32 {
        let bits = |c: &[i128]| {
            let bits = c.iter().map(|c| 128 - c.unsigned_abs().leading_zeros());
            bits.max().unwrap_or(0)
        };
        let (moment, direction) = (bits(&row.exact[..3]), bits(&row.exact[3..]));
        moment.saturating_sub(47).max(direction.saturating_sub(24))
    }

    fn sign(row: &MiddleRow, vertex: &MiddleVertex) -> Sign {
        filtered(&row.approx, vertex.approx).unwrap_or_else(|| {
            let terms = row.exact.iter().zip(&vertex.exact);
            let terms = terms.map(|(&r, v)| product(&I512::from_i128(r), v));
            terms.fold(I512::ZERO, |sum, t| sum + t).sign()
        })
    }

    fn residues(row: &MiddleRow) -> [u64; 6] {
        let p = i128::from(prime());
        row.exact.map(|c| c.rem_euclid(p) as u64)
    }

    /// Five by five minors, expanded by the moments of two rows and the directions of three, or
    /// the other way round.
    fn meet(rows: [&MiddleRow; 5]) -> MiddleVertex {
        let rows = rows.map(|r| r.exact.map(I512::from_i128));
        let minor = |i: usize, j: usize, c: usize, d: usize| {
            product(&rows[i][c], &rows[j][d]) - product(&rows[i][d], &rows[j][c])
        };
        // By pairs of rows, without the k-th of three columns.
        let pairs = |i: usize, j: usize, at: usize| {
            [(1, 2), (0, 2), (0, 1)].map(|(c, d)| minor(i, j, at + c, at + d))
        };
        let triple = |i: usize, tail: &[I512; 3], at: usize| {
            product(&rows[i][at], &tail[0]) - product(&rows[i][at + 1], &tail[1])
                + product(&rows[i][at + 2], &tail[2])
        };
        let mut out = [I512::ZERO; 6];
        for i in 0..5 {
            for j in i + 1..5 {
                let mut rest = (0..5).filter(|&k| k != i && k != j);
                let (Some(a), Some(b), Some(c)) = (rest.next(), rest.next(), rest.next()) else {
                    continue;
                };
                let moments = triple(a, &pairs(b, c, 0), 0);
                let directions = triple(a, &pairs(b, c, 3), 3);
                let (m, d) = (pairs(i, j, 0), pairs(i, j, 3));
                for k in 0..3 {
                    let terms = [
                        (k, product(&m[k], &directions)),
                        (3 + k, product(&d[k], &moments)),
                    ];
                    for (column, term) in terms {
                        // Rows i and j come first, column k is dropped.
                        out[column] = if (i + j + 1 + column) % 2 == 0 {
                            out[column] + term
                        } else {
                            out[column] - term
                        };
                    }
                }
            }
        }
        MiddleVertex::new(out)
    }

    fn opposite(vertex: &MiddleVertex) -> MiddleVertex {
        MiddleVertex {
            exact: vertex.exact.map(|c| -c),
            approx: vertex.approx.map(|c| -c),
        }
    }

    fn complement(row: &MiddleRow) -> MiddleRow {
        MiddleRow {
            exact: row.exact.map(|c| -c),
            approx: row.approx.map(|c| -c),
        }
    }

    fn quadric(v: &MiddleVertex) -> Int<16> {
        let term = |k: usize| v.exact[k].resize().times(&v.exact[k + 3].resize());
        term(0) + term(1) + term(2)
    }

    fn bilinear(v: &MiddleVertex, w: &MiddleVertex) -> Int<16> {
        let term = |k: usize| v.exact[k].resize().times(&w.exact[(k + 3) % 6].resize());
        (0..6).fold(Int::ZERO, |sum, k| sum + term(k))
    }

    fn bilinear_sign(v: &MiddleVertex, w: &MiddleVertex) -> Sign {
        let a = w.approx;
        filtered(&v.approx, [a[3], a[4], a[5], a[0], a[1], a[2]])
            .unwrap_or_else(|| Self::bilinear(v, w).sign())
    }

    fn form_sign(form: &Int<16>) -> Sign {
        form.sign()
    }

    fn crosses(b: &Int<16>, q: &Int<16>, r: &Int<16>) -> bool {
        let (b, q, r) = (big(b), big(q), big(r));
        &b * &b > q * r * IBig::from(4)
    }

    fn wide_row(row: &MiddleRow) -> [IBig; 6] {
        row.exact.map(IBig::from)
    }

    fn wide_vertex(vertex: &MiddleVertex) -> [IBig; 6] {
        std::array::from_fn(|k| big(&vertex.exact[k]))
    }

    fn approximate(vertex: &MiddleVertex) -> &[f64; 6] {
        &vertex.approx
    }
}

#[cfg(test)]
mod tests {
    use super::super::fast::Fast;
    use super::*;

    #[test]
    fn narrow_rows_meet_where_they_do_in_fixed_width() {
        let mut state = 9_u64;
        for shift in [20, 30, 45] {
            let rows: [FastRow; 5] = std::array::from_fn(|_| {
                let row = std::array::from_fn(|k| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005);
                    state = state.wrapping_add(1_442_695_040_888_963_407);
                    let bits = if k < 3 { shift } else { shift.min(24) };
                    (state as i64) >> (64 - bits)
                });
                FastRow::new(row)
            });
            let wide: [MiddleRow; 5] = std::array::from_fn(|k| MiddleRow::of(&rows[k]));
            let v = Fast::meet(std::array::from_fn(|k| &rows[k]));
            let w = Middle::meet(std::array::from_fn(|k| &wide[k]));
            assert_eq!(w.exact, MiddleVertex::of(&v).exact);
            assert!(w.exact.iter().any(|c| !c.sign().is_zero()));
            for (row, narrow) in wide.iter().zip(&rows) {
                assert_eq!(Middle::sign(row, &w), Sign::Zero);
                assert_eq!(middle_sign(row, &v), Fast::sign(narrow, &v));
            }
            assert_eq!(big(&Middle::quadric(&w)), big(&Fast::quadric(&v)));
            let (b, q) = (Middle::bilinear(&w, &w), Middle::quadric(&w));
            assert_eq!(big(&b), big(&q) * IBig::from(2));
        }
    }

    #[test]
    fn the_widest_rows_stay_in_range() {
        // Two rows with the largest excess that fits, three edge rows; signs alternate.
        let row = |m: u32, d: u32, flip: usize| {
            MiddleRow::new(std::array::from_fn(|k| {
                let top = (1_i128 << if k < 3 { m } else { d }) - 1 - k as i128;
                if (k * k + flip).is_multiple_of(3) {
                    -top
                } else {
                    top
                }
            }))
        };
        let rows = [
            row(117, 94, 0),
            row(117, 94, 1),
            row(47, 24, 2),
            row(47, 24, 0),
            row(46, 24, 1),
        ];
        assert_eq!(rows.iter().map(Middle::excess).sum::<u32>(), Middle::ROOM);
        let five: [&MiddleRow; 5] = std::array::from_fn(|k| &rows[k]);
        let w = Middle::meet(five);
        for row in rows.iter().chain([&row(126, 126, 2)]) {
            let exact: IBig = (0..6)
                .map(|k| IBig::from(row.exact[k]) * big(&w.exact[k]))
                .sum();
            assert_eq!(Middle::sign(row, &w), super::super::big::sign_of(&exact));
        }
    }
}
