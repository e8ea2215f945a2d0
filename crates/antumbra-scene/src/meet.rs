//! Does a polygon meet a box or another polygon? Exact separating-axis tests.

use antumbra_kernel::{Aabb, Point, cross, sub};

use crate::PolygonRef;

/// How a polygon lies with respect to a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxContact {
    /// No common point.
    Apart,
    /// Common points on the boundary of the box only.
    Touches,
    /// A point of the polygon is inside the open box.
    Enters,
}

/// The contact of a closed convex polygon with a closed box. Exact, degree 4.
#[must_use]
pub fn box_contact(polygon: &PolygonRef<'_>, bounds: &Aabb) -> BoxContact {
    if !polygon.bounds().touches(bounds) {
        return BoxContact::Apart;
    }
    let corners = bounds.corners();
    let mut contact = BoxContact::Enters;
    let mut axes: Vec<[i64; 3]> = vec![[1, 0, 0], [0, 1, 0], [0, 0, 1], polygon.plane.normal];
    let n = polygon.corners.len();
    for i in 0..n {
        let e = sub(polygon.corners[(i + 1) % n], polygon.corners[i]);
        axes.extend([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]]);
    }
    for axis in axes {
        if axis == [0; 3] {
            continue;
        }
        match separation(polygon.corners, &corners, axis.map(i128::from)) {
            Separation::Strict => return BoxContact::Apart,
            Separation::Weak => contact = BoxContact::Touches,
            Separation::None => {}
        }
    }
    contact
}

/// Whether two closed convex polygons share a point. Exact, degree 4.
#[must_use]
pub fn polygons_touch(a: &PolygonRef<'_>, b: &PolygonRef<'_>) -> bool {
    if !a.bounds().touches(&b.bounds()) {
        return false;
    }
    let mut axes = vec![
        a.plane.normal.map(i128::from),
        b.plane.normal.map(i128::from),
    ];
    for u in edges(a.corners) {
        axes.push(wide_cross(a.plane.normal, u));
        for v in edges(b.corners) {
            axes.push(cross(u, v).map(i128::from));
        }
    }
    for v in edges(b.corners) {
        axes.push(wide_cross(b.plane.normal, v));
    }
    axes.into_iter()
        .filter(|axis| *axis != [0; 3])
        .all(|axis| separation(a.corners, b.corners, axis) != Separation::Strict)
}

fn edges(corners: &[Point]) -> impl Iterator<Item = [i64; 3]> + '_ {
    let n = corners.len();
    (0..n).map(move |i| sub(corners[(i + 1) % n], corners[i]))
}

fn wide_cross(n: [i64; 3], e: [i64; 3]) -> [i128; 3] {
    let (n, e) = (n.map(i128::from), e.map(i128::from));
    [
        n[1] * e[2] - n[2] * e[1],
        n[2] * e[0] - n[0] * e[2],
        n[0] * e[1] - n[1] * e[0],
    ]
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Separation {
    None,
    Weak,
    Strict,
}

fn separation(a: &[Point], b: &[Point], axis: [i128; 3]) -> Separation {
    let range = |points: &[Point]| {
        let mut lo = i128::MAX;
        let mut hi = i128::MIN;
        for p in points {
            let p = p.to_i64();
            let v = (0..3).map(|k| axis[k] * i128::from(p[k])).sum::<i128>();
            lo = lo.min(v);
            hi = hi.max(v);
        }
        (lo, hi)
    };
    let ((a0, a1), (b0, b1)) = (range(a), range(b));
    if a1 < b0 || b1 < a0 {
        Separation::Strict
    } else if a1 == b0 || b1 == a0 {
        Separation::Weak
    } else {
        Separation::None
    }
}

#[cfg(test)]
mod tests {
    use super::{BoxContact, box_contact, polygons_touch};
    use crate::{ObjectId, PolygonId, PolygonRef};
    use antumbra_kernel::{Aabb, Plane, Point};

    fn contact(c: &[Point]) -> BoxContact {
        let plane = Plane::through(c[0], c[1], c[2]);
        let bounds = Aabb::new(Point::new(0, 0, 0), Point::new(10, 10, 10));
        box_contact(&polygon(c, &plane), &bounds)
    }

    fn polygon<'a>(corners: &'a [Point], plane: &'a Plane) -> PolygonRef<'a> {
        PolygonRef {
            id: PolygonId(0),
            object: ObjectId(0),
            corners,
            plane,
            occludes: true,
        }
    }

    #[test]
    fn a_flush_wall_touches_and_a_diagonal_one_may_miss() {
        let p = Point::new;
        assert_eq!(
            contact(&[p(10, 0, 0), p(10, 9, 0), p(10, 9, 9)]),
            BoxContact::Touches
        );
        assert_eq!(
            contact(&[p(21, 0, -5), p(0, 21, -5), p(0, 21, 15)]),
            BoxContact::Apart
        );
        assert_eq!(
            contact(&[p(20, 0, -5), p(0, 20, -5), p(0, 20, 15)]),
            BoxContact::Touches
        );
        assert_eq!(
            contact(&[p(19, 0, -5), p(0, 19, -5), p(0, 19, 15)]),
            BoxContact::Enters
        );
        assert_eq!(
            contact(&[p(-50, -50, 5), p(50, -50, 5), p(0, 90, 5)]),
            BoxContact::Enters
        );
    }

    #[test]
    fn coplanar_polygons_touch_only_where_they_meet() {
        let p = Point::new;
        let a = [p(0, 0, 0), p(4, 0, 0), p(0, 4, 0)];
        let b = [p(4, 0, 0), p(8, 0, 0), p(8, 4, 0)];
        let c = [p(4, 1, 0), p(8, 1, 0), p(8, 4, 0)];
        let plane = Plane::through(a[0], a[1], a[2]);
        assert!(polygons_touch(&polygon(&a, &plane), &polygon(&b, &plane)));
        assert!(!polygons_touch(&polygon(&a, &plane), &polygon(&c, &plane)));
    }
}
