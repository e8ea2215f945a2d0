//! Stage A: does one occluder block every line from a source to a target?
//!
//! Every line from p in the source to q in the target is a positive combination of the lines
//! through pairs of vertices, so if each edge of the occluder has one weak sign on all of them,
//! and the occluder's plane separates the two, all lines cross it. Only orient3d is needed.

use antumbra_kernel::plucker::side;
use antumbra_kernel::{Point, Sign};
use antumbra_scene::PolygonRef;

/// Whether the target may lie in the occluder's plane partly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Behind {
    /// A box must lie strictly behind: it may hold a polygon coplanar with the occluder.
    Strictly,
    /// A polygon may touch the plane, but not lie in it.
    Weakly,
}

/// Whether a polygon blocks all lines from the hull of `sources` to the hull of `targets`.
///
/// Exact. Sources may touch the occluder's plane but not all lie in it.
pub(crate) fn covers(
    polygon: &PolygonRef<'_>,
    sources: &[Point],
    targets: &[Point],
    behind: Behind,
) -> bool {
    let Some(source_side) = one_side(polygon, sources) else {
        return false;
    };
    let Some(target_side) = one_side(polygon, targets) else {
        return false;
    };
    if source_side == target_side {
        return false;
    }
    if behind == Behind::Strictly && targets.iter().any(|&p| polygon.plane.side(p).is_zero()) {
        return false;
    }
    let n = polygon.corners.len();
    (0..n).all(|i| {
        let (u, v) = (polygon.corners[i], polygon.corners[(i + 1) % n]);
        sources.iter().all(|&p| {
            targets
                .iter()
                .all(|&q| side(u, v, p, q).times(target_side) != Sign::Negative)
        })
    })
}

/// The weak side of the polygon's plane that all points lie on, if there is one and not all lie in
/// the plane.
fn one_side(polygon: &PolygonRef<'_>, points: &[Point]) -> Option<Sign> {
    let mut found = Sign::Zero;
    for &p in points {
        let s = polygon.plane.side(p);
        if s.is_zero() {
            continue;
        }
        if found.is_zero() {
            found = s;
        } else if s != found {
            return None;
        }
    }
    (!found.is_zero()).then_some(found)
}
