//! Gates: the faces of boxes and the two sides of polygons, as lines cross them.

use antumbra_kernel::{Aabb, Plane, Point};
use antumbra_lines::Gate;
use antumbra_scene::PolygonRef;

/// A face of a box: 0..6 for -x, +x, -y, +y, -z, +z.
pub(crate) fn face_axis(face: u32) -> (usize, bool) {
    ((face / 2) as usize, face % 2 == 1)
}

/// A face of a box with its normal outwards; `None` if it has no area.
pub(crate) fn outward_face(b: &Aabb, face: u32) -> Option<Gate> {
    let (k, upper) = face_axis(face);
    let (lo, hi) = (b.min.to_array(), b.max.to_array());
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    if lo[i] == hi[i] || lo[j] == hi[j] {
        return None;
    }
    let at = if upper { hi[k] } else { lo[k] };
    let corner = |a: i32, b: i32| {
        let mut c = [0; 3];
        c[k] = at;
        c[i] = a;
        c[j] = b;
        Point::from(c)
    };
    let mut corners = vec![
        corner(lo[i], lo[j]),
        corner(hi[i], lo[j]),
        corner(hi[i], hi[j]),
        corner(lo[i], hi[j]),
    ];
    if !upper {
        corners.reverse();
    }
    let mut normal = [0_i64; 3];
    normal[k] = if upper { 1 } else { -1 };
    let offset = i128::from(if upper { at } else { -at });
    Some(Gate {
        corners,
        plane: Plane { normal, offset },
    })
}

/// The part of a box in front of an axis-parallel plane (the side its normal points to), `None`
/// if no open set of the box's points, or of a flat box's, is there.
pub(crate) fn part_in_front(b: &Aabb, plane: &Plane) -> Option<Aabb> {
    let k = (0..3).find(|&k| plane.normal[k] != 0)?;
    let (mut lo, mut hi) = (b.min.to_array(), b.max.to_array());
    let at = (plane.offset / i128::from(plane.normal[k])) as i32;
    if plane.normal[k] > 0 {
        if hi[k] <= at {
            return None;
        }
        lo[k] = lo[k].max(at);
    } else {
        if lo[k] >= at {
            return None;
        }
        hi[k] = hi[k].min(at);
    }
    Some(Aabb {
        min: Point::from(lo),
        max: Point::from(hi),
    })
}

/// A polygon as a gate that lines cross along its normal, or against it.
pub(crate) fn polygon_gate(polygon: &PolygonRef<'_>, against: bool) -> Gate {
    let gate = Gate {
        corners: polygon.corners.to_vec(),
        plane: *polygon.plane,
    };
    if against { gate.flipped() } else { gate }
}
