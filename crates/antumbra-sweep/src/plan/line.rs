//! An oriented line of the plane as integers: `a x + b y + c`, positive at points on its left.

use antumbra_kernel::Point2;
use antumbra_lines::ExactRay;
use dashu_int::IBig;
use dashu_int::ops::BitTest;

/// A line by its exact coefficients in grid coordinates.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum PlanLine {
    /// Coefficients that fit: all lines on two grid points do.
    Small([i64; 3]),
    /// Others: lines on crossings.
    Big(Box<[IBig; 3]>),
}

impl PlanLine {
    /// From big coefficients.
    #[must_use]
    pub fn new(coefficients: [IBig; 3]) -> Self {
        let small: Vec<i64> = coefficients
            .iter()
            .filter_map(|c| i64::try_from(c).ok())
            .collect();
        match <[i64; 3]>::try_from(small) {
            Ok(small) => Self::Small(small),
            Err(_) => Self::Big(Box::new(coefficients)),
        }
    }

    /// The line from one point to another.
    #[must_use]
    pub fn through(a: Point2, b: Point2) -> Self {
        Self::Small(antumbra_kernel::line2d(a, b))
    }

    /// The same line, looked along the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Small(l) if l.iter().all(|&c| c != i64::MIN) => Self::Small(l.map(|c| -c)),
            _ => Self::new(self.big().map(|c| -c)),
        }
    }

    /// From doubles that round integers: those below 2^53 are exact. `None` if one is larger.
    #[inline]
    #[must_use]
    pub fn of_small(rounded: [f64; 3]) -> Option<Self> {
        let small = rounded.iter().all(|c| c.abs() < (1_u64 << 53) as f64);
        small.then(|| Self::Small(rounded.map(|c| c as i64)))
    }

    /// From a ray of line space.
    #[must_use]
    pub fn of_ray(ray: &ExactRay) -> Self {
        match ray {
            ExactRay::Given(l) => Self::Small(*l),
            ExactRay::Narrow(l) => match l.map(i64::try_from) {
                [Ok(a), Ok(b), Ok(c)] => Self::Small([a, b, c]),
                _ => Self::new(l.map(IBig::from)),
            },
            ExactRay::Wide(l) => Self::new(l.map(|c| {
                let magnitude = if c.is_negative() { -c } else { c };
                let limbs = magnitude.limbs().iter().rev();
                let value = limbs.fold(IBig::ZERO, |sum, &limb| (sum << 64) + IBig::from(limb));
                if c.is_negative() { -value } else { value }
            })),
        }
    }

    /// The coefficients.
    #[must_use]
    pub fn big(&self) -> [IBig; 3] {
        match self {
            Self::Small(l) => l.map(IBig::from),
            Self::Big(l) => (**l).clone(),
        }
    }

    /// The coefficients in doubles, scaled together so that they are of moderate size; for output.
    #[must_use]
    pub fn rounded(&self) -> [f64; 3] {
        match self {
            Self::Small(l) => l.map(|c| c as f64),
            Self::Big(l) => {
                let bits = l.iter().map(|c| c.bit_len()).max().unwrap_or(0);
                let shift = bits.saturating_sub(120);
                let lower = |c: &IBig| i128::try_from(c >> shift).unwrap_or(0) as f64;
                [lower(&l[0]), lower(&l[1]), lower(&l[2])]
            }
        }
    }

    /// How many bits the larger coefficient of its direction has.
    fn bits(&self) -> usize {
        match self {
            Self::Small([a, b, _]) => {
                (64 - (a.unsigned_abs() | b.unsigned_abs()).leading_zeros()) as usize
            }
            Self::Big(l) => l[0].bit_len().max(l[1].bit_len()),
        }
    }

    /// The sum of some lines that all meet the grid: strictly inside their cone if they span one with an interior.
    ///
    /// Powers of two make all of about the same length, so that the sum is near none of them.
    #[must_use]
    pub fn sum(lines: &[Self]) -> Self {
        let most = lines.iter().map(Self::bits).max().unwrap_or(0);
        if lines.iter().any(|line| matches!(line, Self::Big(_))) {
            let mut total = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
            for line in lines {
                for (t, c) in total.iter_mut().zip(line.big()) {
                    *t += c << (most - line.bits());
                }
            }
            return Self::new(total);
        }
        // A line that meets the grid is at most 25 bits longer than its direction: 89 bits each.
        let mut total = [0_i128; 3];
        for line in lines {
            let Self::Small(l) = line else { continue };
            for (t, c) in total.iter_mut().zip(l) {
                *t += i128::from(*c) << (most - line.bits());
            }
        }
        match total.map(i64::try_from) {
            [Ok(a), Ok(b), Ok(c)] => Self::Small([a, b, c]),
            _ => Self::new(total.map(IBig::from)),
        }
    }

    /// A line strictly inside the cone of some lines that avoids some points, none of which all of them pass: sums
    /// with weights 1, w, w^2 ... do, for all w but a few.
    #[must_use]
    pub fn avoiding(lines: &[Self], points: &[Point2]) -> Self {
        let mut found = Self::sum(lines);
        let mut w = 1_u32;
        while points.iter().any(|&p| found.side(p) == 0)
            && (w as usize) <= lines.len() * points.len() + 1
        {
            w += 1;
            let mut total = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
            for line in lines {
                // Horner's rule.
                for (t, c) in total.iter_mut().zip(line.big()) {
                    *t = &*t * IBig::from(w) + c;
                }
            }
            found = Self::new(total);
        }
        found
    }

    /// The sign of a point's side: positive on the left. Exact.
    #[must_use]
    pub fn side(&self, p: Point2) -> i8 {
        match self {
            Self::Small(l) => {
                let [x, y] = p.to_i64().map(i128::from);
                let value = i128::from(l[0]) * x + i128::from(l[1]) * y + i128::from(l[2]);
                value.signum() as i8
            }
            Self::Big(l) => {
                let value: IBig = &l[0] * p.x + &l[1] * p.y + &l[2];
                i8::from(value > IBig::ZERO) - i8::from(value < IBig::ZERO)
            }
        }
    }
}
