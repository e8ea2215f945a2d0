//! Canonical planes, and exact turns of coplanar points seen along a coordinate axis.

use antumbra_kernel::{Plane, Point, cross, sub};

/// The plane through three points with a primitive normal whose first non-zero component is
/// positive: two polygons are coplanar if and only if these planes are equal. `None` if the points
/// are collinear.
pub(crate) fn canonical_plane(a: Point, b: Point, c: Point) -> Option<Plane> {
    let normal = cross(sub(b, a), sub(c, a));
    let divisor = gcd(
        gcd(normal[0].unsigned_abs(), normal[1].unsigned_abs()),
        normal[2].unsigned_abs(),
    );
    if divisor == 0 {
        return None;
    }
    let first = if normal[0] != 0 {
        normal[0]
    } else if normal[1] != 0 {
        normal[1]
    } else {
        normal[2]
    };
    // Components have 51 bits, so the divisor fits.
    let divisor = divisor as i64 * first.signum();
    let normal = normal.map(|n| n / divisor);
    let p = a.to_i64();
    let offset = (0..3)
        .map(|k| i128::from(normal[k]) * i128::from(p[k]))
        .sum();
    Some(Plane { normal, offset })
}

/// Whether three points lie on one line.
pub(crate) fn collinear(a: Point, b: Point, c: Point) -> bool {
    cross(sub(b, a), sub(c, a)) == [0; 3]
}

/// A view of a plane along the axis in which its normal is longest. Dropping that axis maps the
/// plane one to one, so turns, areas and containment can be decided from two coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    u: usize,
    v: usize,
    sign: i64,
}

impl Frame {
    /// The view against a normal: counter-clockwise about the normal is a positive turn.
    pub(crate) fn facing(normal: [i64; 3]) -> Self {
        let axis = (0..3)
            .max_by_key(|&k| (normal[k].unsigned_abs(), 2 - k))
            .unwrap_or(0);
        let sign = if normal[axis] < 0 { -1 } else { 1 };
        Self {
            u: (axis + 1) % 3,
            v: (axis + 2) % 3,
            sign,
        }
    }

    /// Twice the signed area of the projected triangle, exact in 52 bits.
    #[inline]
    pub(crate) fn turn(self, a: Point, b: Point, c: Point) -> i64 {
        let (p, q) = (sub(b, a), sub(c, a));
        self.sign * (p[self.u] * q[self.v] - p[self.v] * q[self.u])
    }

    /// The two coordinates kept, in the order that makes counter-clockwise positive for a
    /// positive normal.
    #[inline]
    pub(crate) fn project(self, p: Point) -> [i64; 2] {
        let p = p.to_i64();
        [p[self.u], p[self.v]]
    }

    /// Whether `p`, a point of the plane, lies in a closed convex polygon that turns
    /// counter-clockwise in this view.
    pub(crate) fn holds(self, mut corners: impl Iterator<Item = Point>, p: Point) -> bool {
        let Some(first) = corners.next() else {
            return false;
        };
        let mut last = first;
        for next in corners.chain(std::iter::once(first)) {
            if self.turn(last, next, p) < 0 {
                return false;
            }
            last = next;
        }
        true
    }
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    // Binary: a 64-bit division costs several times a shift.
    if a == 0 || b == 0 {
        return a | b;
    }
    let shift = (a | b).trailing_zeros();
    a >>= a.trailing_zeros();
    loop {
        b >>= b.trailing_zeros();
        if a > b {
            std::mem::swap(&mut a, &mut b);
        }
        b -= a;
        if b == 0 {
            return a << shift;
        }
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{LIMIT, Point};

    use super::{Frame, canonical_plane, gcd};

    #[test]
    fn coplanar_triangles_have_one_plane() {
        let p = |x, y| Point::new(x, y, 7 - 2 * x + 3 * y);
        let a = canonical_plane(p(0, 0), p(100, 1), p(3, 50));
        assert_eq!(a, canonical_plane(p(9, 9), p(-70, 11), p(13, -5)));
        assert_eq!(a.map(|plane| plane.normal), Some([2, -3, 1]));
        assert_eq!(canonical_plane(p(0, 0), p(1, 1), p(2, 2)), None);
    }

    #[test]
    fn extreme_planes_stay_exact() {
        let m = LIMIT - 1;
        let corners = [
            Point::new(-m, -m, m),
            Point::new(m, -m, 1 - m),
            Point::new(-m, m, -m),
        ];
        let plane = canonical_plane(corners[0], corners[1], corners[2]).expect("a triangle");
        for c in corners {
            assert_eq!(plane.evaluate(c), 0);
        }
        let frame = Frame::facing(plane.normal);
        assert!(frame.turn(corners[0], corners[1], corners[2]) != 0);
    }

    #[test]
    fn greatest_common_divisors() {
        assert_eq!(gcd(0, 0), 0);
        assert_eq!(gcd(0, 6), 6);
        assert_eq!(gcd(12, 18), 6);
        assert_eq!(gcd(1 << 50, 3 << 20), 1 << 20);
    }
}
