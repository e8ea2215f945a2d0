//! Points, vectors and boxes on the integer grid.

use crate::Sign;

/// Coordinates on the grid are signed 24-bit integers: `-LIMIT < x < LIMIT`.
///
/// All proved bounds of this crate start from this number (b = 24 in the tables).
pub const LIMIT: i32 = 1 << 23;

/// A point of the integer grid, in grid steps from the grid's origin.
///
/// Every coordinate is smaller in magnitude than [`LIMIT`]; [`crate::Grid::snap`] guarantees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Point {
    /// First coordinate.
    pub x: i32,
    /// Second coordinate.
    pub y: i32,
    /// Third coordinate (up).
    pub z: i32,
}

impl Point {
    /// A point from its three grid coordinates.
    #[inline]
    #[must_use]
    pub const fn new(x: i32, y: i32, z: i32) -> Self {
        Self { x, y, z }
    }

    /// The coordinates as an array.
    #[inline]
    #[must_use]
    pub const fn to_array(self) -> [i32; 3] {
        [self.x, self.y, self.z]
    }

    /// The coordinates as wide machine integers.
    #[inline]
    #[must_use]
    pub fn to_i64(self) -> [i64; 3] {
        [i64::from(self.x), i64::from(self.y), i64::from(self.z)]
    }

    /// The coordinates as floats: exact, since they have 24 bits.
    #[inline]
    #[must_use]
    pub fn to_f64(self) -> [f64; 3] {
        [f64::from(self.x), f64::from(self.y), f64::from(self.z)]
    }
}

impl From<[i32; 3]> for Point {
    #[inline]
    fn from([x, y, z]: [i32; 3]) -> Self {
        Self { x, y, z }
    }
}

/// The difference `b - a`, exact (25 bits).
#[inline]
#[must_use]
pub fn sub(b: Point, a: Point) -> [i64; 3] {
    let (b, a) = (b.to_i64(), a.to_i64());
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

/// The cross product of two difference vectors, exact (51 bits for 25-bit input).
#[inline]
#[must_use]
pub fn cross(u: [i64; 3], v: [i64; 3]) -> [i64; 3] {
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

/// A closed axis-parallel box on the grid; it may be flat, never inverted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Point,
    /// Largest coordinates.
    pub max: Point,
}

impl Aabb {
    /// The box between two corners.
    ///
    /// # Panics
    /// If a coordinate of `min` exceeds that of `max`.
    #[must_use]
    pub fn new(min: Point, max: Point) -> Self {
        assert!(
            min.x <= max.x && min.y <= max.y && min.z <= max.z,
            "an inverted box: {min:?} to {max:?}"
        );
        Self { min, max }
    }

    /// The smallest box around some points; `None` if there are none.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = Point>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        Some(points.fold(
            Self {
                min: first,
                max: first,
            },
            |b, p| b.with(p),
        ))
    }

    /// The smallest box that also contains `p`.
    #[must_use]
    pub fn with(self, p: Point) -> Self {
        Self {
            min: Point::new(
                self.min.x.min(p.x),
                self.min.y.min(p.y),
                self.min.z.min(p.z),
            ),
            max: Point::new(
                self.max.x.max(p.x),
                self.max.y.max(p.y),
                self.max.z.max(p.z),
            ),
        }
    }

    /// The smallest box that contains both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        self.with(other.min).with(other.max)
    }

    /// What the closed boxes share; `None` if that is nothing.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        self.touches(other).then(|| Self {
            min: Point::new(
                self.min.x.max(other.min.x),
                self.min.y.max(other.min.y),
                self.min.z.max(other.min.z),
            ),
            max: Point::new(
                self.max.x.min(other.max.x),
                self.max.y.min(other.max.y),
                self.max.z.min(other.max.z),
            ),
        })
    }

    /// Whether the closed boxes share a point.
    #[inline]
    #[must_use]
    pub fn touches(&self, other: &Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
            && self.min.z <= other.max.z
            && other.min.z <= self.max.z
    }

    /// Whether `other` lies wholly inside this closed box.
    #[inline]
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        self.min.x <= other.min.x
            && self.min.y <= other.min.y
            && self.min.z <= other.min.z
            && other.max.x <= self.max.x
            && other.max.y <= self.max.y
            && other.max.z <= self.max.z
    }

    /// The eight corners, bit `k` of the index choosing the maximum on axis `k`.
    #[must_use]
    pub fn corners(&self) -> [Point; 8] {
        std::array::from_fn(|i| {
            let pick = |k: usize, lo: i32, hi: i32| if i >> k & 1 == 1 { hi } else { lo };
            Point::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// Twice the centre, exact.
    #[must_use]
    pub fn center_doubled(&self) -> [i64; 3] {
        let (a, b) = (self.min.to_i64(), self.max.to_i64());
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }

    /// The three edge lengths in grid steps.
    #[must_use]
    pub fn extent(&self) -> [i64; 3] {
        sub(self.max, self.min)
    }
}

/// An oriented plane `normal . x = offset` through grid points, with exact coefficients.
///
/// The normal has 51 bits at most (a cross product of differences), the offset 76.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Plane {
    /// Integer normal; not reduced.
    pub normal: [i64; 3],
    /// `normal . p` for every point `p` of the plane.
    pub offset: i128,
}

impl Plane {
    /// The plane through three grid points, its normal by the right-hand rule.
    /// The normal is zero if they are collinear.
    #[must_use]
    pub fn through(a: Point, b: Point, c: Point) -> Self {
        let normal = cross(sub(b, a), sub(c, a));
        Self {
            normal,
            offset: dot_point(normal, a),
        }
    }

    /// On which side of the plane a grid point lies: positive is where the normal points.
    /// Exact, degree 3, in 128-bit integers.
    #[inline]
    #[must_use]
    pub fn side(&self, p: Point) -> Sign {
        Sign::of(dot_point(self.normal, p) - self.offset)
    }

    /// `normal . p - offset`, exact (77 bits).
    #[inline]
    #[must_use]
    pub fn evaluate(&self, p: Point) -> i128 {
        dot_point(self.normal, p) - self.offset
    }

    /// Whether the three defining points were collinear.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        self.normal == [0; 3]
    }

    /// The same plane seen from its other side.
    #[must_use]
    pub fn flipped(&self) -> Self {
        Self {
            normal: self.normal.map(|c| -c),
            offset: -self.offset,
        }
    }
}

#[inline]
fn dot_point(n: [i64; 3], p: Point) -> i128 {
    let p = p.to_i64();
    i128::from(n[0]) * i128::from(p[0])
        + i128::from(n[1]) * i128::from(p[1])
        + i128::from(n[2]) * i128::from(p[2])
}

#[cfg(test)]
mod tests {
    use super::{Aabb, LIMIT, Plane, Point};
    use crate::Sign;

    #[test]
    fn plane_side_is_exact_at_the_ends_of_the_grid() {
        let m = LIMIT - 1;
        let plane = Plane::through(
            Point::new(-m, -m, m),
            Point::new(m, -m, -m),
            Point::new(-m, m, -m),
        );
        assert_eq!(plane.side(Point::new(-m, -m, m)), Sign::Zero);
        assert_eq!(
            plane.side(Point::new(-m, -m, m - 1)),
            plane.side(Point::new(-m, -m, -m))
        );
        assert_ne!(plane.side(Point::new(-m, -m, m - 1)), Sign::Zero);
        assert_eq!(
            plane.flipped().side(Point::new(0, 0, 0)),
            plane.side(Point::new(0, 0, 0)).flip()
        );
    }

    #[test]
    fn boxes_touch_and_contain() {
        let a = Aabb::new(Point::new(0, 0, 0), Point::new(2, 2, 2));
        let b = Aabb::new(Point::new(2, 2, 2), Point::new(3, 3, 3));
        assert!(a.touches(&b) && !a.contains(&b) && a.union(b).contains(&b));
        assert_eq!(a.corners()[7], a.max);
        assert_eq!(Aabb::around(a.corners()), Some(a));
    }
}
