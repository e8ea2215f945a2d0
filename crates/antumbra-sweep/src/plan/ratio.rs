//! Where a line meets a segment: an exact fraction of it, and the double nearest to that.
//!
//! With `P = p . l` and `Q = q . l` for the ends of a segment and a line that crosses it, the line
//! meets it at `P / (P - Q)` of the way from p to q. For lines on two grid points P and Q have 50 bits,
//! so that one division rounds to the nearest double; for others big integers do, to the same.

use std::cmp::Ordering;

use antumbra_kernel::Point2;
use dashu_int::IBig;
use dashu_int::ops::{BitTest, DivRem, Gcd, UnsignedAbs};

use super::line::PlanLine;

/// A number from 0 to 1.
#[derive(Clone, Debug)]
pub struct Ratio {
    value: f64,
    exact: Exact,
}

#[derive(Clone, Debug)]
enum Exact {
    Small(i64, i64),
    Big(Box<(IBig, IBig)>),
}

impl Ratio {
    /// Zero.
    pub const ZERO: Self = Self {
        value: 0.0,
        exact: Exact::Small(0, 1),
    };
    /// One.
    pub const ONE: Self = Self {
        value: 1.0,
        exact: Exact::Small(1, 1),
    };

    /// The double nearest to it.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Numerator and denominator.
    #[must_use]
    pub fn parts(&self) -> (IBig, IBig) {
        match &self.exact {
            Exact::Small(n, d) => (IBig::from(*n), IBig::from(*d)),
            Exact::Big(parts) => (parts.0.clone(), parts.1.clone()),
        }
    }

    /// What remains to one.
    #[must_use]
    pub fn rest(&self) -> Self {
        match &self.exact {
            Exact::Small(n, d) => small(*d - *n, *d),
            Exact::Big(parts) => big(&parts.1 - &parts.0, parts.1.clone()),
        }
    }

    /// The place this far on the way between two places, all of a whole.
    #[must_use]
    pub fn between(&self, [from, to]: [i64; 2], whole: i64) -> Self {
        if from == 0 && to == whole {
            return self.clone();
        }
        match &self.exact {
            Exact::Small(0, _) => small(from, whole),
            Exact::Small(n, d) if n == d => small(to, whole),
            Exact::Small(..) | Exact::Big(_) => {
                let (n, d) = self.parts();
                big(&d * from + n * (to - from), d * whole)
            }
        }
    }

    /// The point this far along a segment, each coordinate rounded once.
    #[must_use]
    pub fn point_on(&self, [p, q]: [Point2; 2]) -> [f64; 2] {
        let (n, d) = self.parts();
        [(p.x, q.x), (p.y, q.y)].map(|(p, q)| nearest(&(&d * p + &n * (q - p)), &d))
    }

    /// Where a line meets a segment; `None` if it runs along it.
    #[must_use]
    pub fn on_segment([p, q]: [Point2; 2], line: &PlanLine) -> Option<Self> {
        if let PlanLine::Small(l) = line
            && l[0].unsigned_abs() < 1 << 27
            && l[1].unsigned_abs() < 1 << 27
            && l[2].unsigned_abs() < 1 << 51
        {
            // 50 and 50 and 51 bits: below 2^52 in magnitude, and their difference below 2^53.
            let at = |p: Point2| {
                let [x, y] = p.to_i64();
                l[0] * x + l[1] * y + l[2]
            };
            let (n, m) = (at(p), at(q));
            return (n != m).then(|| small(n, n - m));
        }
        if let PlanLine::Small(l) = line {
            let at = |p: Point2| {
                let [x, y] = p.to_i64();
                i128::from(l[0]) * i128::from(x)
                    + i128::from(l[1]) * i128::from(y)
                    + i128::from(l[2])
            };
            let (n, d) = (at(p), at(p) - at(q));
            if d == 0 {
                return None;
            }
            if n.unsigned_abs() < 1 << 53 && d.unsigned_abs() < 1 << 53 {
                return Some(small(n as i64, d as i64));
            }
        }
        let l = line.big();
        let at = |p: Point2| &l[0] * p.x + &l[1] * p.y + &l[2];
        let (n, d) = (at(p), at(p) - at(q));
        (d != IBig::ZERO).then(|| big(n, d))
    }
}

fn small(n: i64, d: i64) -> Ratio {
    let (n, d) = if d < 0 { (-n, -d) } else { (n, d) };
    Ratio {
        value: n as f64 / d as f64,
        exact: Exact::Small(n, d),
    }
}

fn big(n: IBig, d: IBig) -> Ratio {
    let (n, d) = if d < IBig::ZERO { (-n, -d) } else { (n, d) };
    let common = IBig::from((&n).gcd(&d));
    let (n, d) = (n / &common, d / common);
    if let (Ok(n), Ok(d)) = (i64::try_from(&n), i64::try_from(&d))
        && n.unsigned_abs() < 1 << 53
        && d.unsigned_abs() < 1 << 53
    {
        return small(n, d);
    }
    Ratio {
        value: nearest(&n, &d),
        exact: Exact::Big(Box::new((n, d))),
    }
}

/// The double nearest to a fraction below 2^62 in magnitude with a positive denominator.
fn nearest(n: &IBig, d: &IBig) -> f64 {
    // At least 64 bits of the quotient, the last one odd if anything is left.
    let shift = (65 + d.bit_len()).saturating_sub(n.bit_len());
    let scaled = n.unsigned_abs() << shift;
    let (quotient, left) = scaled.div_rem(d.unsigned_abs());
    let bits = u128::try_from(quotient).unwrap_or(u128::MAX) | u128::from(!left.is_zero());
    let magnitude = bits as f64 * 0.5_f64.powi(shift as i32);
    if *n < IBig::ZERO {
        -magnitude
    } else {
        magnitude
    }
}

impl PartialEq for Ratio {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ratio {}

impl PartialOrd for Ratio {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ratio {
    fn cmp(&self, other: &Self) -> Ordering {
        // Rounding keeps the order, so only equal doubles need a closer look.
        match self.value.partial_cmp(&other.value) {
            Some(Ordering::Less) => return Ordering::Less,
            Some(Ordering::Greater) => return Ordering::Greater,
            _ => {}
        }
        if let (Exact::Small(a, b), Exact::Small(c, d)) = (&self.exact, &other.exact) {
            let (a, b, c, d) = (
                i128::from(*a),
                i128::from(*b),
                i128::from(*c),
                i128::from(*d),
            );
            return (a * d).cmp(&(c * b));
        }
        let ((a, b), (c, d)) = (self.parts(), other.parts());
        (a * d).cmp(&(c * b))
    }
}

#[cfg(test)]
mod tests {
    use super::{Ratio, big, small};
    use antumbra_kernel::Point2;
    use dashu_int::IBig;

    #[test]
    fn equal_fractions_are_equal_whatever_they_are_made_of() {
        let third = small(1, 3);
        let wide = big(IBig::from(7) << 300, IBig::from(21) << 300);
        assert_eq!(third, wide);
        assert_eq!(third.value().to_bits(), wide.value().to_bits());
        assert_eq!(third.rest(), small(2, 3));
        assert_eq!(small(-1, -3), third);
        assert_eq!(Ratio::ONE.rest(), Ratio::ZERO);
    }

    #[test]
    fn fractions_are_rounded_once_however_small_they_are() {
        let tiny = big(IBig::from(3), IBig::ONE << 200);
        assert_eq!(tiny.value(), 3.0 * 0.5_f64.powi(200));
        // 2/3 by way of thirds and quarters of other denominators.
        assert_eq!(small(1, 3).between([4, 8], 8).value(), 2.0 / 3.0);
        assert_eq!(small(5, 9).between([9, 0], 9).value(), 4.0 / 9.0);
        assert_eq!(Ratio::ONE.between([1, 3], 7).value(), 3.0 / 7.0);
        let ends = [Point2::new(-3, 5), Point2::new(4, 5)];
        assert_eq!(small(1, 3).point_on(ends), [-2.0 / 3.0, 5.0]);
    }

    #[test]
    fn close_fractions_are_told_apart() {
        let d = IBig::from(3) << 200;
        let n = IBig::from(1) << 200;
        let (a, b) = (big(n.clone(), d.clone()), big(n + IBig::ONE, d));
        assert_eq!(a.value(), b.value());
        assert!(a < b && a != b);
    }
}
