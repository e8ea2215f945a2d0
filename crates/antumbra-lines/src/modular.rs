//! Which rows are independent: by elimination modulo a prime.

use dashu_int::IBig;

use crate::space::{ExactRow, PluckerSpace, RowId};

impl PluckerSpace {
    /// The rank of some rows modulo a 61-bit prime, and which rows (in order) attain it, stopping
    /// at `wanted`. Independence modulo the prime implies independence.
    pub(crate) fn independent(&self, rows: &[RowId], wanted: usize) -> Vec<RowId> {
        let mut basis: Vec<([u64; 6], usize)> = Vec::with_capacity(wanted);
        let mut chosen = Vec::with_capacity(wanted);
        for &row in rows {
            let mut r = self.residues(row);
            for (b, pivot) in &basis {
                let factor = r[*pivot];
                if factor != 0 {
                    for k in 0..6 {
                        r[k] = sub_mod(r[k], mul_mod(factor, b[k]));
                    }
                }
            }
            if let Some(pivot) = r.iter().position(|&c| c != 0) {
                let inverse = pow_mod(r[pivot], PRIME - 2);
                let b = r.map(|c| mul_mod(c, inverse));
                basis.push((b, pivot));
                chosen.push(row);
                if chosen.len() == wanted {
                    break;
                }
            }
        }
        chosen
    }

    fn residues(&self, row: RowId) -> [u64; 6] {
        match self.exact_row(row) {
            ExactRow::Narrow(r) => r.map(|c| c.rem_euclid(PRIME as i64) as u64),
            ExactRow::Wide(r) => std::array::from_fn(|k| {
                let p = IBig::from(PRIME);
                let m = ((&r[k] % &p) + &p) % &p;
                u64::try_from(&m).unwrap_or(0)
            }),
        }
    }
}

/// The Mersenne prime 2^61 - 1.
const PRIME: u64 = (1 << 61) - 1;

/// For factors below the prime: 2^61 is 1 modulo 2^61 - 1, so the high part is added to the low one.
fn mul_mod(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    let folded = (product as u64 & PRIME) + (product >> 61) as u64;
    if folded >= PRIME {
        folded - PRIME
    } else {
        folded
    }
}

fn sub_mod(a: u64, b: u64) -> u64 {
    if a >= b { a - b } else { a + PRIME - b }
}

fn pow_mod(mut base: u64, mut exponent: u64) -> u64 {
    let mut out = 1;
    while exponent > 0 {
        if exponent & 1 == 1 {
            out = mul_mod(out, base);
        }
        base = mul_mod(base, base);
        exponent >>= 1;
    }
    out
}
