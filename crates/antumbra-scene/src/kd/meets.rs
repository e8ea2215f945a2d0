//! Whether a convex polygon meets a box: exact, by separating axes.

use antumbra_kernel::{Aabb, Plane, Point};

/// A convex polygon: corners counter-clockwise about the normal of its plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape<'a> {
    /// The corners.
    pub(crate) corners: &'a [Point],
    /// The plane.
    pub(crate) plane: &'a Plane,
}

impl Shape<'_> {
    /// Whether the closed polygon meets a closed box that its bounding box meets.
    ///
    /// Besides the axes of the box, which the bounding boxes have decided, two convex bodies can
    /// only be separated by the plane of the polygon, or by a plane along an edge and a coordinate
    /// axis: an edge in one of the three projections. 51 bits for the edges, 78 for the plane.
    pub(crate) fn meets(&self, bounds: &Aabb) -> bool {
        !self.plane_separates(bounds) && (0..3).all(|axis| !self.edge_separates(bounds, axis))
    }

    /// Whether the box lies strictly on one side of the plane. By twice the center and the extent.
    fn plane_separates(&self, bounds: &Aabb) -> bool {
        let (center, extent) = (bounds.center_doubled(), bounds.extent());
        let dot = |v: [i64; 3]| -> i128 {
            let n = self.plane.normal;
            (0..3).map(|k| i128::from(n[k]) * i128::from(v[k])).sum()
        };
        let away = dot(center) - 2 * self.plane.offset;
        let n = self.plane.normal;
        let reach: i128 = (0..3)
            .map(|k| i128::from(n[k].abs()) * i128::from(extent[k]))
            .sum();
        away.abs() > reach
    }

    /// Whether, seen along an axis, the box lies strictly outside an edge of the polygon.
    fn edge_separates(&self, bounds: &Aabb, axis: usize) -> bool {
        let sign = self.plane.normal[axis].signum();
        if sign == 0 {
            return false;
        }
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (low, high) = (bounds.min.to_i64(), bounds.max.to_i64());
        let n = self.corners.len();
        (0..n).any(|i| {
            let (a, b) = (self.corners[i].to_i64(), self.corners[(i + 1) % n].to_i64());
            let (du, dv) = (sign * (b[u] - a[u]), sign * (b[v] - a[v]));
            // The corner of the box that lies deepest inside.
            let pu = if dv > 0 { low[u] } else { high[u] };
            let pv = if du > 0 { high[v] } else { low[v] };
            du * (pv - a[v]) - dv * (pu - a[u]) < 0
        })
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{Aabb, Plane, Point};
    use proptest::prelude::*;

    use super::Shape;
    use crate::meet::{BoxContact, box_contact};
    use crate::{ObjectId, PolygonId, PolygonRef};

    fn meets(corners: [[i32; 3]; 3], min: [i32; 3], max: [i32; 3]) -> bool {
        let corners = corners.map(Point::from);
        let plane = Plane::through(corners[0], corners[1], corners[2]);
        Shape {
            corners: &corners,
            plane: &plane,
        }
        .meets(&Aabb::new(min.into(), max.into()))
    }

    #[test]
    fn planes_and_edges_separate() {
        let slope = [[0, 0, 0], [10, 0, 10], [0, 10, 10]];
        // Inside the bounding box, above the plane; then across it; then touching it in a point.
        assert!(!meets(slope, [0, 0, 8], [2, 2, 10]));
        assert!(meets(slope, [2, 2, 2], [4, 4, 8]));
        assert!(meets(slope, [0, 0, 4], [4, 4, 10]));
        let flat = [[0, 0, 5], [10, 0, 5], [0, 10, 5]];
        // Beyond the long edge, touching it, and over it.
        assert!(!meets(flat, [6, 6, 0], [9, 9, 9]));
        assert!(meets(flat, [5, 5, 0], [9, 9, 9]));
        assert!(meets(flat, [4, 4, 5], [9, 9, 5]));
    }

    proptest! {
        #[test]
        fn two_separating_axis_tests_agree(
            corners in prop::array::uniform3(prop::array::uniform3(-6..7_i32)),
            a in prop::array::uniform3(-6..7_i32),
            b in prop::array::uniform3(-6..7_i32),
        ) {
            let corners = corners.map(Point::from);
            let plane = Plane::through(corners[0], corners[1], corners[2]);
            let bounds = Aabb::new(Point::from(a), Point::from(a)).with(Point::from(b));
            let polygon = PolygonRef {
                id: PolygonId(0),
                object: ObjectId(0),
                corners: &corners,
                plane: &plane,
                occludes: true,
            };
            prop_assume!(!plane.is_degenerate() && polygon.bounds().touches(&bounds));
            let apart = box_contact(&polygon, &bounds) == BoxContact::Apart;
            prop_assert_eq!(Shape { corners: &corners, plane: &plane }.meets(&bounds), !apart);
        }
    }
}
