//! Grid points that hurt: uniform, on a coarse grid, nearly equal, at the limits, collinear, coplanar.

use crate::random::Random;

/// Grid coordinates are smaller in magnitude than this: signed 24-bit numbers.
pub const LIMIT: i64 = 1 << 23;

/// A seeded source of grid points; see [`Points::any`].
#[derive(Clone, Debug)]
pub struct Points {
    random: Random,
    /// Where the nearly equal points gather.
    center: [i64; 3],
}

impl Points {
    /// A source; equal seeds give equal points.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut points = Self {
            random: Random::new(seed),
            center: [0; 3],
        };
        points.center = points.uniform();
        points
    }

    /// The generator behind it, for other choices of a test.
    pub fn random(&mut self) -> &mut Random {
        &mut self.random
    }

    /// Anywhere on the grid.
    pub fn uniform(&mut self) -> [i64; 3] {
        std::array::from_fn(|_| self.random.integer(1 - LIMIT, LIMIT - 1))
    }

    /// One of 125 points around the origin: every degeneracy occurs within a few draws.
    pub fn coarse(&mut self) -> [i64; 3] {
        std::array::from_fn(|_| self.random.integer(-2, 2))
    }

    /// Within one step of a far point that stays the same for a while.
    pub fn nearly_equal(&mut self) -> [i64; 3] {
        if self.random.index(16) == 0 {
            self.center = self.uniform();
        }
        let center = self.center;
        std::array::from_fn(|k| {
            (center[k] + self.random.integer(-1, 1)).clamp(1 - LIMIT, LIMIT - 1)
        })
    }

    /// At or next to the ends of the range, or next to zero: largest values, worst cancellation.
    pub fn extreme(&mut self) -> [i64; 3] {
        std::array::from_fn(|_| {
            let inward = self.random.integer(0, 1);
            match self.random.index(5) {
                0 | 1 => LIMIT - 1 - inward,
                2 | 3 => 1 - LIMIT + inward,
                _ => inward,
            }
        })
    }

    /// From one of the families above, chosen anew for each call.
    pub fn any(&mut self) -> [i64; 3] {
        match self.random.index(4) {
            0 => self.uniform(),
            1 => self.coarse(),
            2 => self.nearly_equal(),
            _ => self.extreme(),
        }
    }

    /// Exactly collinear, distinct points, over as much of the grid as the direction allows.
    pub fn collinear(&mut self, count: usize) -> Vec<[i64; 3]> {
        let direction = loop {
            let d: [i64; 3] = std::array::from_fn(|_| self.random.integer(-9, 9));
            if d != [0; 3] {
                break d;
            }
        };
        let start: [i64; 3] = std::array::from_fn(|_| self.random.integer(-LIMIT / 2, LIMIT / 2));
        let reach = LIMIT / 2 / 10;
        let mut steps: Vec<i64> = Vec::new();
        while steps.len() < count {
            let step = self.random.integer(-reach, reach);
            if !steps.contains(&step) {
                steps.push(step);
            }
        }
        let along = |step: i64| std::array::from_fn(|k| start[k] + step * direction[k]);
        steps.into_iter().map(along).collect()
    }

    /// Exactly coplanar points, of a plane with small integer directions; they may coincide.
    pub fn coplanar(&mut self, count: usize) -> Vec<[i64; 3]> {
        let mut small = || std::array::from_fn(|_| self.random.integer(-7, 7));
        let (u, v): ([i64; 3], [i64; 3]) = (small(), small());
        let start: [i64; 3] = std::array::from_fn(|_| self.random.integer(-LIMIT / 2, LIMIT / 2));
        let reach = LIMIT / 2 / 16;
        let mut point = || {
            let (s, t) = (
                self.random.integer(-reach, reach),
                self.random.integer(-reach, reach),
            );
            std::array::from_fn(|k| start[k] + s * u[k] + t * v[k])
        };
        (0..count).map(|_| point()).collect()
    }
}

#[cfg(test)]
mod tests {
    use dashu_int::IBig;

    use super::{LIMIT, Points};
    use crate::determinant::orient3d;

    #[test]
    fn all_families_stay_on_the_grid() {
        let mut points = Points::new(3);
        for _ in 0..2000 {
            for c in points.any() {
                assert!(-LIMIT < c && c < LIMIT);
            }
        }
        for p in points.collinear(50).into_iter().chain(points.coplanar(50)) {
            assert!(p.iter().all(|c| -LIMIT < *c && *c < LIMIT));
        }
    }

    #[test]
    fn degenerate_families_are_degenerate() {
        let mut points = Points::new(4);
        for _ in 0..50 {
            let plane = points.coplanar(4);
            assert_eq!(orient3d(plane[0], plane[1], plane[2], plane[3]), IBig::ZERO);
            let line = points.collinear(3);
            let anywhere = points.uniform();
            assert_eq!(orient3d(line[0], line[1], line[2], anywhere), IBig::ZERO);
        }
    }
}
