//! Exact fractions and points with rational coordinates, kept over one common denominator.

use std::cmp::Ordering;
use std::fmt;

use dashu_int::IBig;
use dashu_int::ops::Gcd;

/// A fraction with a positive denominator; not reduced.
#[derive(Clone, Debug)]
pub struct Fraction {
    numerator: IBig,
    denominator: IBig,
}

impl Fraction {
    /// The quotient of two integers.
    ///
    /// # Panics
    /// If the denominator is zero.
    #[must_use]
    pub fn new(numerator: IBig, denominator: IBig) -> Self {
        match denominator.cmp(&IBig::ZERO) {
            Ordering::Greater => Self {
                numerator,
                denominator,
            },
            Ordering::Less => Self {
                numerator: -numerator,
                denominator: -denominator,
            },
            Ordering::Equal => panic!("a fraction with denominator zero"),
        }
    }

    /// Above the line.
    #[must_use]
    pub fn numerator(&self) -> &IBig {
        &self.numerator
    }

    /// Below the line; positive.
    #[must_use]
    pub fn denominator(&self) -> &IBig {
        &self.denominator
    }

    /// The nearest float, nearly: for messages and for comparison with float oracles.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        ratio_f64(&self.numerator, &self.denominator)
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Fraction {}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }
}

impl From<i64> for Fraction {
    fn from(value: i64) -> Self {
        Self {
            numerator: value.into(),
            denominator: IBig::ONE,
        }
    }
}

impl fmt::Display for Fraction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.numerator, self.denominator)
    }
}

/// A point with rational coordinates: three numerators over one positive denominator.
#[derive(Clone, Debug)]
pub struct RationalPoint {
    numerators: [IBig; 3],
    denominator: IBig,
}

impl RationalPoint {
    /// A point from numerators and their common denominator; kept in lowest terms, lest repeated
    /// bisection grow it without bound.
    ///
    /// # Panics
    /// If the denominator is zero.
    #[must_use]
    pub fn new(numerators: [IBig; 3], denominator: IBig) -> Self {
        assert!(denominator != IBig::ZERO, "a point with denominator zero");
        let by = |a: IBig, b: &IBig| IBig::from(a.gcd(b));
        let mut common = numerators.iter().fold(denominator.clone(), by);
        if denominator < IBig::ZERO {
            common = -common;
        }
        Self {
            numerators: numerators.map(|n| n / &common),
            denominator: denominator / common,
        }
    }

    /// A grid point.
    #[must_use]
    pub fn from_grid(point: [i64; 3]) -> Self {
        Self {
            numerators: point.map(IBig::from),
            denominator: IBig::ONE,
        }
    }

    /// The exact value of three floats; `None` if one is not finite.
    #[must_use]
    pub fn from_f64(point: [f64; 3]) -> Option<Self> {
        if point.iter().any(|c| !c.is_finite()) {
            return None;
        }
        // Every finite float is an integer multiple of 2^-1074; strip what is not needed.
        let parts = point.map(decode);
        let lowest = parts
            .iter()
            .map(|(_, exponent)| *exponent)
            .min()
            .unwrap_or(0)
            .min(0);
        let scaled = parts.map(|(m, e)| IBig::from(m) << (e - lowest) as usize);
        Some(Self {
            numerators: scaled,
            denominator: IBig::ONE << (-lowest) as usize,
        })
    }

    /// The numerators of the coordinates.
    #[must_use]
    pub fn numerators(&self) -> &[IBig; 3] {
        &self.numerators
    }

    /// Their common denominator; positive.
    #[must_use]
    pub fn denominator(&self) -> &IBig {
        &self.denominator
    }

    /// Floats near it, for messages.
    #[must_use]
    pub fn to_f64(&self) -> [f64; 3] {
        std::array::from_fn(|k| ratio_f64(&self.numerators[k], &self.denominator))
    }

    /// The exact weighted mean of some points.
    ///
    /// # Panics
    /// If the lists differ in length or the weights add up to zero.
    #[must_use]
    pub fn mean(points: &[&Self], weights: &[IBig]) -> Self {
        assert_eq!(points.len(), weights.len(), "one weight a point");
        let common: IBig = points.iter().fold(IBig::ONE, |c, p| c * &p.denominator);
        let mut numerators = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
        let mut total = IBig::ZERO;
        for (point, weight) in points.iter().zip(weights) {
            let scale = &common / &point.denominator * weight;
            for (sum, n) in numerators.iter_mut().zip(&point.numerators) {
                *sum += &scale * n;
            }
            total += weight;
        }
        Self::new(numerators, total * common)
    }

    /// The point half way between two.
    #[must_use]
    pub fn midpoint(&self, other: &Self) -> Self {
        if self.denominator == other.denominator {
            let sum = std::array::from_fn(|k| &self.numerators[k] + &other.numerators[k]);
            return Self::new(sum, &self.denominator * IBig::from(2));
        }
        Self::mean(&[self, other], &[IBig::ONE, IBig::ONE])
    }
}

impl PartialEq for RationalPoint {
    fn eq(&self, other: &Self) -> bool {
        (0..3).all(|k| {
            &self.numerators[k] * &other.denominator == &other.numerators[k] * &self.denominator
        })
    }
}

impl Eq for RationalPoint {}

impl fmt::Display for RationalPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = &self.numerators;
        write!(f, "({x}, {y}, {z})/{}", self.denominator)
    }
}

/// Mantissa and exponent: value = mantissa * 2^exponent, the mantissa odd or zero.
fn decode(value: f64) -> (i64, i64) {
    let bits = value.to_bits();
    let raw = (bits >> 52 & 0x7ff) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mut mantissa, mut exponent) = if raw == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, raw - 1075)
    };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    mantissa >>= zeros;
    exponent += i64::from(zeros);
    (if value < 0.0 { -mantissa } else { mantissa }, exponent)
}

/// The quotient of two integers of any size as a float, good to about 2^-52.
fn ratio_f64(numerator: &IBig, denominator: &IBig) -> f64 {
    // 64 fractional bits are enough for a message, whatever the sizes.
    let shifted: IBig = (numerator << 64_usize) / denominator;
    shifted.to_f64().value() / 2.0_f64.powi(64)
}

#[cfg(test)]
mod tests {
    use dashu_int::IBig;

    use super::{Fraction, RationalPoint};
    use crate::random::Random;

    #[test]
    fn floats_are_taken_exactly() {
        let mut random = Random::new(5);
        for _ in 0..200 {
            let p: [f64; 3] = std::array::from_fn(|_| (random.unit() - 0.5) * 1e7);
            let q = RationalPoint::from_f64(p).expect("finite");
            for (a, b) in p.into_iter().zip(q.to_f64()) {
                assert!((a - b).abs() <= 1e-9, "{a} {b}");
            }
        }
        let half = RationalPoint::from_f64([0.5, -0.25, 3.0]).expect("finite");
        assert_eq!(
            half,
            RationalPoint::new([2, -1, 12].map(IBig::from), IBig::from(4))
        );
        assert!(RationalPoint::from_f64([f64::NAN, 0.0, 0.0]).is_none());
    }

    #[test]
    fn fractions_compare_by_value() {
        let third = Fraction::new(IBig::from(-1), IBig::from(-3));
        assert_eq!(third, Fraction::new(IBig::from(2), IBig::from(6)));
        assert!(third < Fraction::new(IBig::from(1), IBig::from(2)));
        assert!((third.to_f64() - 1.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn means_are_exact() {
        let a = RationalPoint::from_grid([0, 0, 0]);
        let b = RationalPoint::from_grid([3, 6, 9]);
        let m = RationalPoint::mean(&[&a, &b], &[IBig::from(1), IBig::from(2)]);
        assert_eq!(m, RationalPoint::from_grid([2, 4, 6]));
        assert_eq!(a.midpoint(&b), b.midpoint(&a));
    }
}
