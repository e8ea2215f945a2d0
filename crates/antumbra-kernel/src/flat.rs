//! The plane: grid points, boxes, and the side of a point on the line through two others.
//!
//! Coordinates have 24 bits, so differences have 25, products of two of them 49, and the
//! determinant of three points 51: everything here is exact in 64-bit integers, without a filter.

use crate::{LIMIT, Sign};

/// A point of the integer grid in the plane; coordinates are smaller in magnitude than [`LIMIT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Point2 {
    /// First coordinate.
    pub x: i32,
    /// Second coordinate.
    pub y: i32,
}

impl Point2 {
    /// A point from its coordinates.
    ///
    /// # Panics
    /// In debug builds, if a coordinate is off the grid.
    #[inline]
    #[must_use]
    pub const fn new(x: i32, y: i32) -> Self {
        debug_assert!(-LIMIT < x && x < LIMIT && -LIMIT < y && y < LIMIT);
        Self { x, y }
    }

    /// The coordinates as wide machine integers.
    #[inline]
    #[must_use]
    pub fn to_i64(self) -> [i64; 2] {
        [i64::from(self.x), i64::from(self.y)]
    }

    /// The coordinates as floats, exactly; for sampling and output.
    #[inline]
    #[must_use]
    pub fn to_f64(self) -> [f64; 2] {
        [f64::from(self.x), f64::from(self.y)]
    }
}

/// Twice the signed area of a triangle: positive if `c` lies left of the way from `a` to `b`.
///
/// Degree 2, 51 bits.
///
/// ```
/// use antumbra_kernel::{Point2, orient2d};
/// let p = Point2::new;
/// assert_eq!(orient2d(p(0, 0), p(4, 0), p(1, 3)), 12);
/// assert_eq!(orient2d(p(0, 0), p(4, 2), p(2, 1)), 0);
/// ```
#[inline]
#[must_use]
pub fn orient2d(a: Point2, b: Point2, c: Point2) -> i64 {
    let ([ax, ay], [bx, by], [cx, cy]) = (a.to_i64(), b.to_i64(), c.to_i64());
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// On which side of the way from `a` to `b` a point lies: positive on the left. Exact.
#[inline]
#[must_use]
pub fn side2d(a: Point2, b: Point2, c: Point2) -> Sign {
    Sign::of(i128::from(orient2d(a, b, c)))
}

/// The oriented line from `a` to `b` in line space: `(x, y, z)` such that `x px + y py + z` is
/// [`orient2d`] of `a`, `b` and p. Components have 25, 25 and 48 bits. After [Bittner02, 6.4].
#[inline]
#[must_use]
pub fn line2d(a: Point2, b: Point2) -> [i64; 3] {
    let ([ax, ay], [bx, by]) = (a.to_i64(), b.to_i64());
    [ay - by, bx - ax, ax * by - ay * bx]
}

/// The homogeneous point where the lines of two pairs meet, its weight not negative: the name of a
/// crossing. Components have 75, 75 and 52 bits; the weight is zero if the lines are parallel.
#[must_use]
pub fn crossing2d(first: [Point2; 2], second: [Point2; 2]) -> [i128; 3] {
    let a = line2d(first[0], first[1]).map(i128::from);
    let b = line2d(second[0], second[1]).map(i128::from);
    let m = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    let point = [m(1, 2), m(2, 0), m(0, 1)];
    if point[2] < 0 {
        point.map(|c| -c)
    } else {
        point
    }
}

/// A closed axis-parallel box in the plane; it may be flat, never inverted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rect {
    /// Smallest coordinates.
    pub min: Point2,
    /// Largest coordinates.
    pub max: Point2,
}

impl Rect {
    /// The smallest box around some points; `None` if there are none.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = Point2>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let start = Self {
            min: first,
            max: first,
        };
        Some(points.fold(start, |r, p| Self {
            min: Point2::new(r.min.x.min(p.x), r.min.y.min(p.y)),
            max: Point2::new(r.max.x.max(p.x), r.max.y.max(p.y)),
        }))
    }

    /// The corners, counter-clockwise from the smallest.
    #[inline]
    #[must_use]
    pub fn corners(&self) -> [Point2; 4] {
        let (l, h) = (self.min, self.max);
        [l, Point2::new(h.x, l.y), h, Point2::new(l.x, h.y)]
    }

    /// Whether the closed boxes share a point.
    #[inline]
    #[must_use]
    pub fn touches(&self, other: &Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
    }

    /// Whether the closed box and the closed segment share a point. Exact.
    #[must_use]
    pub fn meets_segment(&self, [a, b]: [Point2; 2]) -> bool {
        let box_of = Self {
            min: Point2::new(a.x.min(b.x), a.y.min(b.y)),
            max: Point2::new(a.x.max(b.x), a.y.max(b.y)),
        };
        if !self.touches(&box_of) {
            return false;
        }
        let sides = self.corners().map(|c| orient2d(a, b, c));
        !(sides.iter().all(|&s| s > 0) || sides.iter().all(|&s| s < 0))
    }

    /// The squared distance of two closed boxes; 50 bits.
    #[inline]
    #[must_use]
    pub fn distance_squared(&self, other: &Self) -> i64 {
        let gap = |low: i32, high: i32| (i64::from(low) - i64::from(high)).max(0);
        let x = gap(self.min.x, other.max.x).max(gap(other.min.x, self.max.x));
        let y = gap(self.min.y, other.max.y).max(gap(other.min.y, self.max.y));
        x * x + y * y
    }

    /// Whether all of a closed segment is farther from the closed box than a distance. Exact; 104 bits.
    #[must_use]
    pub fn is_beyond(&self, distance: u64, [p, q]: [Point2; 2]) -> bool {
        let limit = u128::from(distance).pow(2);
        let near = |p: Point2| {
            let gap = self.distance_squared(&Self { min: p, max: p });
            u128::from(gap.unsigned_abs()) <= limit
        };
        if near(p) || near(q) || self.meets_segment([p, q]) {
            return false;
        }
        // What is nearest may also be a corner of the box and a place between the ends.
        let (dx, dy) = (
            i64::from(q.x) - i64::from(p.x),
            i64::from(q.y) - i64::from(p.y),
        );
        let length = (dx * dx + dy * dy).unsigned_abs();
        self.corners().into_iter().all(|c| {
            let (cx, cy) = (
                i64::from(c.x) - i64::from(p.x),
                i64::from(c.y) - i64::from(p.y),
            );
            let along = cx * dx + cy * dy;
            let beside = along <= 0 || along.unsigned_abs() >= length;
            let across = u128::from((dx * cy - dy * cx).unsigned_abs()).pow(2);
            // A limit beyond all numbers is beyond all distances, too.
            beside || limit.checked_mul(length.into()).is_some_and(|l| across > l)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{LIMIT, Point2, Rect, crossing2d, line2d, orient2d};
    use antumbra_testkit::determinant;
    use antumbra_testkit::random::Random;
    use dashu_int::IBig;

    #[test]
    fn orientation_agrees_with_big_integers_at_the_ends_of_the_grid() {
        let m = LIMIT - 1;
        let mut random = Random::new(3);
        let mut pick = || match random.index(4) {
            0 => m,
            1 => -m,
            2 => m - 1,
            _ => random.integer(-i64::from(m), i64::from(m)) as i32,
        };
        for _ in 0..20_000 {
            let [a, b, c] = std::array::from_fn(|_| Point2::new(pick(), pick()));
            let found = orient2d(a, b, c);
            let big = determinant::orient2d(a.to_i64(), b.to_i64(), c.to_i64());
            assert_eq!(IBig::from(found), big);
            assert!(found.unsigned_abs() < 1 << 50);
            let l = line2d(a, b);
            let at = |p: Point2| l[0] * i64::from(p.x) + l[1] * i64::from(p.y) + l[2];
            assert_eq!((at(a), at(b), at(c)), (0, 0, found));
        }
    }

    #[test]
    fn a_crossing_lies_on_both_lines_within_its_bound() {
        let m = LIMIT - 1;
        let ends = [Point2::new(-m, -m), Point2::new(m, m - 1)];
        let other = [Point2::new(-m, m), Point2::new(m, -m)];
        let k = crossing2d(ends, other);
        assert!(k[2] > 0 && k.iter().all(|c| c.unsigned_abs() < 1 << 74));
        for line in [line2d(ends[0], ends[1]), line2d(other[0], other[1])] {
            let value: IBig = (0..3).map(|i| IBig::from(line[i]) * IBig::from(k[i])).sum();
            assert_eq!(value, IBig::ZERO);
        }
        assert_eq!(crossing2d(ends, ends), [0; 3]);
    }

    #[test]
    fn boxes_meet_segments_and_keep_their_distance() {
        let p = Point2::new;
        let r = Rect::around([p(0, 0), p(4, 2)]).expect("points");
        assert!(r.meets_segment([p(-1, 1), p(1, 3)]));
        assert!(!r.meets_segment([p(-2, 1), p(1, 4)]));
        assert!(r.meets_segment([p(4, 2), p(9, 9)]) && r.meets_segment([p(-9, 1), p(9, 1)]));
        let far = Rect::around([p(7, 6), p(9, 9)]).expect("points");
        assert_eq!(r.distance_squared(&far), 25);
        assert_eq!(r.distance_squared(&r), 0);
    }

    /// The box around a slanted segment is near long before the segment itself is.
    #[test]
    fn what_is_beyond_a_distance_is_so_as_a_whole() {
        let p = |x, y| Point2::new(x, y);
        let r = Rect::around([p(-1, -1), p(0, 0)]).expect("points");
        let slanted = [p(10, 0), p(0, 10)];
        // 10 / sqrt(2) = 7.07...
        assert!(r.is_beyond(7, slanted) && !r.is_beyond(8, slanted));
        assert!(r.is_beyond(4, [p(3, 4), p(9, 9)]) && !r.is_beyond(5, [p(9, 9), p(3, 4)]));
        assert!(!r.is_beyond(0, [p(-5, 4), p(4, -5)]) && r.is_beyond(0, [p(-5, 7), p(7, -5)]));
        let m = LIMIT - 1;
        assert!(!r.is_beyond(u64::MAX, [p(m, m), p(m, -m)]));
    }
}
