//! Big integers, for rows that no fixed width holds.

use std::rc::Rc;

use antumbra_kernel::Sign;
use dashu_int::IBig;
use dashu_int::ops::{BitTest, UnsignedAbs};

use super::modular::prime;
use super::numbers::Numbers;

/// Six big integers with a rounded copy, scaled so that the largest is about 2^60.
#[derive(Clone, Debug)]
pub(super) struct Wide {
    pub exact: Rc<[IBig; 6]>,
    /// Each off by less than 2.
    approx: [f64; 6],
}

impl PartialEq for Wide {
    fn eq(&self, other: &Self) -> bool {
        self.exact == other.exact
    }
}

impl Wide {
    pub(super) fn new(exact: [IBig; 6]) -> Self {
        let bits = exact.iter().map(BitTest::bit_len).max().unwrap_or(0);
        let approx = std::array::from_fn(|k| {
            let shifted = if bits > 60 {
                &exact[k] >> (bits - 60)
            } else {
                exact[k].clone()
            };
            // Below 2^61 by construction.
            i64::try_from(shifted).map_or(f64::NAN, |v| v as f64)
        });
        Self {
            exact: Rc::new(exact),
            approx,
        }
    }

    /// The rounded copy: up to a power of two, each off by less than 2.
    pub(super) fn approx(&self) -> &[f64; 6] {
        &self.approx
    }

    fn negated(&self) -> Self {
        Self {
            exact: Rc::new(std::array::from_fn(|k| -&self.exact[k])),
            approx: self.approx.map(|c| -c),
        }
    }
}

/// The sign of a big integer.
pub(super) fn sign_of(v: &IBig) -> Sign {
    if *v == IBig::ZERO {
        Sign::Zero
    } else if *v > IBig::ZERO {
        Sign::Positive
    } else {
        Sign::Negative
    }
}

/// The scalar product.
pub(super) fn dot(a: &[IBig; 6], b: &[IBig; 6]) -> IBig {
    (0..6).map(|k| &a[k] * &b[k]).sum()
}

/// The bilinear form `d . m' + m . d'`.
pub(super) fn form(a: &[IBig; 6], b: &[IBig; 6]) -> IBig {
    (0..6).map(|k| &a[k] * &b[(k + 3) % 6]).sum()
}

/// The greatest common divisor taken out, unless all are zero.
pub(super) fn primitive(row: [IBig; 6]) -> [IBig; 6] {
    use dashu_int::UBig;
    use dashu_int::ops::Gcd;
    let mut divisor = UBig::ZERO;
    for c in &row {
        if *c != IBig::ZERO {
            divisor = if divisor == UBig::ZERO {
                c.unsigned_abs()
            } else {
                divisor.gcd(c.unsigned_abs())
            };
        }
    }
    if divisor == UBig::ZERO || divisor == UBig::ONE {
        return row;
    }
    let divisor = IBig::from(divisor);
    row.map(|c| c / &divisor)
}

/// Big integers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Big;

impl Numbers for Big {
    type Row = Wide;
    type Vertex = Wide;
    type Form = IBig;

    const ROOM: u32 = u32::MAX;

    fn excess(_: &Wide) -> u32 {
        0
    }

    fn sign(row: &Wide, vertex: &Wide) -> Sign {
        let mut sum = 0.0;
        // What rounding of the factors (2 each) and of the sums may hide.
        let mut slack = 64.0;
        for k in 0..6 {
            let t = row.approx[k] * vertex.approx[k];
            sum += t;
            slack += t.abs() * super::fast::FILTER
                + 4.0 * (row.approx[k].abs() + vertex.approx[k].abs());
        }
        if sum > slack {
            Sign::Positive
        } else if sum < -slack {
            Sign::Negative
        } else {
            sign_of(&dot(&row.exact, &vertex.exact))
        }
    }

    fn residues(row: &Wide) -> [u64; 6] {
        let p = IBig::from(prime());
        std::array::from_fn(|k| {
            let r = &row.exact[k] % &p;
            let r = if r < IBig::ZERO { r + &p } else { r };
            u64::try_from(r).unwrap_or(0)
        })
    }

    /// Fraction-free elimination after Bareiss.
    fn meet(rows: [&Wide; 5]) -> Wide {
        let mut m: Vec<[IBig; 6]> = rows.iter().map(|r| (*r.exact).clone()).collect();
        let mut pivots = [0_usize; 5];
        let mut last = IBig::ONE;
        let mut free: Vec<usize> = (0..6).collect();
        for i in 0..5 {
            let found = free.iter().find_map(|&c| {
                let r = (i..5).find(|&r| m[r][c] != IBig::ZERO)?;
                Some((r, c))
            });
            let Some((r, c)) = found else {
                return Wide::new(std::array::from_fn(|_| IBig::ZERO));
            };
            m.swap(i, r);
            free.retain(|&k| k != c);
            pivots[i] = c;
            let (pivot, lead) = (m[i][c].clone(), m[i].clone());
            for (r, row) in m.iter_mut().enumerate() {
                if r != i {
                    let f = row[c].clone();
                    for k in 0..6 {
                        row[k] = (&pivot * &row[k] - &f * &lead[k]) / &last;
                    }
                }
            }
            last = pivot;
        }
        // The matrix is diagonal now, all pivots equal to `last`, but for one free column.
        let open = free[0];
        let mut out: [IBig; 6] = std::array::from_fn(|_| IBig::ZERO);
        for i in 0..5 {
            out[pivots[i]] = -&m[i][open];
        }
        out[open] = last;
        Wide::new(out)
    }

    fn opposite(vertex: &Wide) -> Wide {
        vertex.negated()
    }

    fn complement(row: &Wide) -> Wide {
        row.negated()
    }

    fn quadric(v: &Wide) -> IBig {
        (0..3).map(|k| &v.exact[k] * &v.exact[k + 3]).sum()
    }

    fn bilinear(v: &Wide, w: &Wide) -> IBig {
        form(&v.exact, &w.exact)
    }

    fn bilinear_sign(v: &Wide, w: &Wide) -> Sign {
        sign_of(&Self::bilinear(v, w))
    }

    fn form_sign(form: &IBig) -> Sign {
        sign_of(form)
    }

    fn crosses(b: &IBig, q: &IBig, r: &IBig) -> bool {
        b * b > q * r * IBig::from(4)
    }

    fn wide(row: &Wide) -> [IBig; 6] {
        (*row.exact).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::{Big, Wide, dot, primitive};
    use crate::check::numbers::Numbers;
    use antumbra_kernel::Sign;
    use dashu_int::IBig;

    #[test]
    fn a_meet_lies_on_all_five() {
        let mut state = 5_u64;
        for _ in 0..40 {
            let rows: [Wide; 5] = std::array::from_fn(|_| {
                Wide::new(std::array::from_fn(|_| {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    IBig::from((state >> 40) as i64 % 7 - 3) << (state % 90) as usize
                }))
            });
            let v = Big::meet([&rows[0], &rows[1], &rows[2], &rows[3], &rows[4]]);
            for r in &rows {
                assert_eq!(Big::sign(r, &v), Sign::Zero);
                assert_eq!(dot(&r.exact, &v.exact), IBig::ZERO);
            }
        }
    }

    #[test]
    fn common_factors_are_taken_out() {
        let row = primitive([0, 6, -9, 0, 12, 3].map(IBig::from));
        assert_eq!(row, [0, 2, -3, 0, 4, 1].map(IBig::from));
    }
}
