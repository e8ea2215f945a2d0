//! The exact side of the cone in R^3: names become integers only where a float filter gave up.
//!
//! Widths (n bits: |v| < 2^(n-1)), each tested on extreme input below:
//!
//! | quantity | bound | type |
//! |---|---|---|
//! | given ray | 36 bits | `i64` |
//! | row of two given rays, narrow | 63 bits | `i64` |
//! | row of a crossing in the plane, middle | 77 bits | `i128` |
//! | row of a common line, wide | 161 bits | `I256` |
//! | ray of two narrow rows | 127 bits | `i128` |
//! | ray of a middle row and a narrow one below 2^49 | 127 bits | `i128` |
//! | middle row . ray of 127 bits | 205 bits | `I256` |
//! | other rays where a row is not narrow | 323 bits | `Int<6>` |
//! | narrow row . ray of narrow rows | 191 bits | `Int<3>` |
//! | wide row . given ray | 198 bits | `I256` |
//! | any row . any ray | 485 bits | `I512` |

use antumbra_kernel::{I256, I512, Int, Sign};

/// A row as integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    Narrow([i64; 3]),
    /// Below 2^76.
    Middle([i128; 3]),
    Wide([I256; 3]),
}

/// A ray as integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactRay {
    /// A ray that was given.
    Given([i64; 3]),
    /// Where two narrow hyperplanes meet.
    Narrow([i128; 3]),
    /// Where two hyperplanes meet of which one is wide.
    Wide([Int<6>; 3]),
}

impl ExactRay {
    /// The components in the common width.
    #[must_use]
    pub fn wide(&self) -> [Int<6>; 3] {
        match self {
            Self::Given(v) => v.map(Int::from_i64),
            Self::Narrow(v) => v.map(Int::from_i128),
            Self::Wide(v) => *v,
        }
    }

    /// The components as doubles, each within a relative error of 2^-52. Filters and output.
    #[must_use]
    pub fn to_f64(&self) -> [f64; 3] {
        match self {
            Self::Given(v) => v.map(|c| c as f64),
            Self::Narrow(v) => v.map(rounded),
            Self::Wide(v) => v.map(|c| c.to_f64_scaled(0)),
        }
    }

    /// The product with a row below 2^52 in magnitude, rounded once: within a relative error of
    /// 2^-52, however nearly the ray lies on the row's hyperplane. Output. (323 + 53 + 2 bits.)
    #[must_use]
    pub fn dot(&self, row: [i64; 3]) -> f64 {
        debug_assert!(row.iter().all(|c| c.abs() < 1 << 52));
        let v = self.wide();
        let t = |k: usize| v[k].times_i64(row[k]);
        (t(0) + t(1) + t(2)).to_f64_scaled(0)
    }
}

impl Row {
    pub(super) fn wide(&self) -> [I256; 3] {
        match self {
            Self::Narrow(v) => v.map(Int::from_i64),
            Self::Middle(v) => v.map(Int::from_i128),
            Self::Wide(v) => *v,
        }
    }

    pub(super) fn to_f64(self) -> [f64; 3] {
        match self {
            Self::Narrow(v) => v.map(|c| c as f64),
            Self::Middle(v) => v.map(|c| c as f64),
            Self::Wide(v) => v.map(|c| c.to_f64_scaled(0)),
        }
    }

    /// The row, as narrow as it is.
    pub(super) fn of_wide(row: [I256; 3]) -> Self {
        if row.iter().all(|c| c.bits() <= MIDDLE) {
            Self::Middle(row.map(|c| {
                let [low, high, ..] = *c.limbs();
                (u128::from(low) | u128::from(high) << 64) as i128
            }))
        } else {
            Self::Wide(row)
        }
    }
}

/// The double of an integer, within a relative error of 2^-52: its leading 63 bits, then rounded. Twice as fast as
/// the conversion that rounds once.
fn rounded(v: i128) -> f64 {
    let low = v as i64;
    if i128::from(low) == v {
        return low as f64;
    }
    let magnitude = v.unsigned_abs();
    let shift = 65 - magnitude.leading_zeros();
    let leading = (magnitude >> shift) as i64 as f64;
    let scaled = leading * f64::from_bits(u64::from(1023 + shift) << 52);
    if v < 0 { -scaled } else { scaled }
}

/// Bits of a middle row's magnitude.
const MIDDLE: u32 = 76;

/// The ray of two rows whose products stay below 2^126.
fn small_meet(a: &[i128; 3], b: &[i128; 3]) -> ExactRay {
    let m = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    ExactRay::Narrow([m(1, 2), m(2, 0), m(0, 1)])
}

fn below_49_bits(row: &[i64; 3]) -> bool {
    row.iter().all(|c| c.unsigned_abs() < 1 << 49)
}

/// The ray `a x b`.
#[inline]
pub(super) fn meet(a: &Row, b: &Row) -> ExactRay {
    if let (Row::Narrow(a), Row::Narrow(b)) = (a, b) {
        let m = |i: usize, j: usize| {
            i128::from(a[i]) * i128::from(b[j]) - i128::from(a[j]) * i128::from(b[i])
        };
        return ExactRay::Narrow([m(1, 2), m(2, 0), m(0, 1)]);
    }
    match (a, b) {
        (Row::Middle(a), Row::Narrow(b)) if below_49_bits(b) => {
            return small_meet(a, &b.map(i128::from));
        }
        (Row::Narrow(a), Row::Middle(b)) if below_49_bits(a) => {
            return small_meet(&a.map(i128::from), b);
        }
        _ => {}
    }
    let a = a.wide().map(|c| c.resize::<6>());
    let b = b.wide().map(|c| c.resize::<6>());
    let m = |i: usize, j: usize| a[i].times(&b[j]) - a[j].times(&b[i]);
    ExactRay::Wide([m(1, 2), m(2, 0), m(0, 1)])
}

/// The sign of `row . ray`.
pub(super) fn sign(row: &Row, ray: &ExactRay) -> Sign {
    match (row, ray) {
        (Row::Narrow(r), ExactRay::Given(v)) => Sign::of(
            (0..3)
                .map(|k| i128::from(r[k]) * i128::from(v[k]))
                .sum::<i128>(),
        ),
        (Row::Narrow(r), ExactRay::Narrow(v)) => {
            let t = |k: usize| Int::<3>::from_i128(v[k]).times_i64(r[k]);
            (t(0) + t(1) + t(2)).sign()
        }
        (Row::Middle(r), ExactRay::Narrow(v)) => {
            let t = |k: usize| I256::product_i128(r[k], v[k]);
            (t(0) + t(1) + t(2)).sign()
        }
        (Row::Wide(r), ExactRay::Given(v)) => {
            let t = |k: usize| r[k].times_i64(v[k]);
            (t(0) + t(1) + t(2)).sign()
        }
        _ => {
            let r = row.wide().map(|c| c.resize::<8>());
            let v = ray.wide().map(|c| c.resize::<8>());
            let t = |k: usize| -> I512 { r[k].times(&v[k]) };
            (t(0) + t(1) + t(2)).sign()
        }
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{I256, Int, Sign};
    use dashu_int::IBig;

    use super::{ExactRay, Row, meet, rounded, sign};

    fn big<const N: usize>(v: &Int<N>) -> IBig {
        let negative = v.is_negative();
        let m = if negative { -*v } else { *v };
        let mut out = IBig::ZERO;
        for &l in m.limbs().iter().rev() {
            out = (out << 64) + IBig::from(l);
        }
        if negative { -out } else { out }
    }

    fn big_dot(row: &Row, ray: &ExactRay) -> IBig {
        let (r, v) = (row.wide(), ray.wide());
        (0..3).map(|k| big(&r[k]) * big(&v[k])).sum()
    }

    fn big_cross(a: &Row, b: &Row) -> [IBig; 3] {
        let (a, b) = (a.wide().map(|c| big(&c)), b.wide().map(|c| big(&c)));
        let m = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
        [m(1, 2), m(2, 0), m(0, 1)]
    }

    /// Rows at the ends of their ranges, with every pattern of signs.
    fn extreme() -> Vec<Row> {
        let narrow = (1_i64 << 62) - 1;
        let wide = I256::product_i128((1 << 80) - 1, 1 << 80);
        let mut out = Vec::new();
        for signs in 0..8_u32 {
            let flip = |k: u32| signs >> k & 1 == 1;
            let n = |k: u32, v: i64| if flip(k) { -v } else { v };
            let w = |k: u32, v: I256| if flip(k) { -v } else { v };
            out.push(Row::Narrow([n(0, narrow), n(1, narrow - 2), n(2, narrow)]));
            out.push(Row::Narrow([n(0, 1), n(1, narrow), n(2, 3)]));
            let middle = (1_i128 << 76) - 1;
            let m = |k: u32, v: i128| if flip(k) { -v } else { v };
            out.push(Row::Middle([m(0, middle), m(1, middle - 5), m(2, middle)]));
            let forty_nine = (1_i64 << 49) - 1;
            out.push(Row::Narrow([
                n(0, forty_nine),
                n(1, 3 - forty_nine),
                n(2, 7),
            ]));
            let less = wide - I256::from_i64(7);
            out.push(Row::Wide([w(0, wide), w(1, less), w(2, wide)]));
        }
        out
    }

    #[test]
    fn integers_are_rounded_within_their_bound() {
        for shift in 0..127 {
            for offset in [-1_i128, 0, 1, 12_345_678_901_234_567] {
                for v in [
                    (1_i128 << shift) + offset,
                    -(1 << shift) - offset,
                    i128::MIN + offset.abs(),
                ] {
                    let exact = IBig::from(v);
                    let error = IBig::try_from(rounded(v)).expect("an integer") - &exact;
                    let size = if exact < IBig::ZERO { -&exact } else { exact };
                    let error = if error < IBig::ZERO { -error } else { error };
                    assert!((error << 52) <= size, "{v}");
                }
            }
        }
    }

    #[test]
    fn signs_agree_with_big_integers_at_the_ends_of_the_ranges() {
        let rows = extreme();
        let mut rays = vec![
            ExactRay::Given([(1 << 35) - 1, -((1 << 35) - 1), (1 << 35) - 1]),
            ExactRay::Given([1, 0, -1]),
        ];
        for a in &rows {
            for b in &rows {
                let ray = meet(a, b);
                assert_eq!(ray.wide().map(|c| big(&c)), big_cross(a, b));
                assert_eq!(sign(a, &ray), Sign::Zero);
                rays.push(ray);
            }
        }
        for row in &rows {
            for ray in &rays {
                let expected = big_dot(row, ray).cmp(&IBig::ZERO);
                assert_eq!(sign(row, ray), Sign::of_ordering(expected));
            }
        }
        let widest = [(1 << 52) - 1, 1 - (1 << 52), (1 << 52) - 1];
        for ray in &rays {
            let exact = big_dot(&Row::Narrow(widest), ray).to_f64().value();
            let rounded = ray.dot(widest);
            let error = (rounded - exact).abs();
            assert!(
                error <= exact.abs() * 2.0_f64.powi(-51),
                "{rounded}, not {exact}"
            );
        }
    }
}
