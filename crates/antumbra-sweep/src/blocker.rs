//! Blocker cones: the lines between two gates that one occluder blocks, as rows of line space.
//!
//! Only the part of an occluder between the planes of source and target blocks. Usually no clip
//! row is needed for that (`docs/notes/blockers.md` has the proof): edges wholly behind either
//! plane are dropped, and the row of the common line of the occluder's plane and the source's is
//! redundant on real lines unless the occluder's plane crosses the source itself. The same holds
//! for the target.

use antumbra_kernel::plucker::edge_row;
use antumbra_kernel::{I256, Plane, Point, Sign};
use antumbra_lines::{Gate, Halfspace, PluckerSpace, common_line_row};
use antumbra_scene::PolygonRef;

use crate::proof::RowName;

/// The lines that cross one occluder in one direction, between source and target.
#[derive(Clone, Debug)]
pub(crate) struct BlockerCone {
    /// Whether lines cross against the polygon's normal.
    pub negative: bool,
    /// All must hold.
    pub rows: Vec<(Halfspace, RowName)>,
}

/// The blocker cones of an occluder between two gates: none, one, or one for each direction.
pub(crate) fn blocker_cones(
    space: &mut PluckerSpace,
    polygon: &PolygonRef<'_>,
    from: &Gate,
    source_plane_blocks: bool,
    to: &Gate,
) -> Vec<BlockerCone> {
    let front: Vec<Sign> = polygon
        .corners
        .iter()
        .map(|&p| from.plane.side(p))
        .collect();
    let before: Vec<Sign> = polygon
        .corners
        .iter()
        .map(|&p| to.plane.side(p).flip())
        .collect();
    let in_source = front.iter().all(|s| s.is_zero());
    if in_source && !source_plane_blocks {
        return Vec::new();
    }
    if !in_source && !front.iter().any(|s| s.is_positive()) {
        return Vec::new();
    }
    if !before.iter().any(|s| s.is_positive()) {
        return Vec::new();
    }
    if !in_source && !reaches_between(polygon, from, to) {
        return Vec::new();
    }
    let sources = sides(polygon.plane, &from.corners);
    let targets = sides(polygon.plane, &to.corners);
    let along_source = scalar_sign(&from.plane, polygon.plane);
    let possible = |direction: Sign| {
        let leaves = if in_source {
            along_source == direction
        } else {
            sources.contains(&direction.flip())
        };
        leaves && targets.contains(&direction)
    };
    let directions: Vec<Sign> = [Sign::Positive, Sign::Negative]
        .into_iter()
        .filter(|&d| possible(d))
        .collect();
    if directions.is_empty() {
        return Vec::new();
    }
    let mut rows = Vec::with_capacity(polygon.corners.len() + 2);
    let n = polygon.corners.len();
    let behind =
        |s: Sign, t: Sign| !(s.is_positive() || t.is_positive() || s.is_zero() && t.is_zero());
    for i in 0..n {
        let j = (i + 1) % n;
        if behind(front[i], front[j]) || behind(before[i], before[j]) {
            continue;
        }
        let row = edge_row(polygon.corners[i], polygon.corners[j]);
        let name = RowName::Edge {
            polygon: polygon.id,
            edge: i as u32,
        };
        rows.push((space.halfspace(&row, false), name));
    }
    if crossed(&front) && crossed(&sources) {
        let row = common_line_row(&from.plane, polygon.plane);
        rows.push((
            space.intern_wide(row),
            RowName::SourceLine {
                polygon: polygon.id,
            },
        ));
    }
    if crossed(&before) && crossed(&targets) {
        let row = common_line_row(&to.plane.flipped(), polygon.plane);
        rows.push((
            space.intern_wide(row),
            RowName::TargetLine {
                polygon: polygon.id,
            },
        ));
    }
    directions
        .into_iter()
        .map(|d| {
            let negative = d.is_negative();
            let oriented = rows
                .iter()
                .map(|&(h, name)| (if negative { h.opposite() } else { h }, name))
                .collect();
            BlockerCone {
                negative,
                rows: oriented,
            }
        })
        .collect()
}

/// Whether a point of the polygon is strictly in front of the source and strictly before the
/// target. Corners on both sides of both planes do not imply it: the two parts may be apart.
///
/// Both distances are linear along an edge, and a region between two planes is unbounded, so it
/// meets a convex polygon inside only if it meets an edge. Products have 154 bits.
fn reaches_between(polygon: &PolygonRef<'_>, from: &Gate, to: &Gate) -> bool {
    let values: Vec<(i128, i128)> = polygon
        .corners
        .iter()
        .map(|&p| (from.plane.evaluate(p), -to.plane.evaluate(p)))
        .collect();
    let n = values.len();
    (0..n).any(|i| {
        let ((f, g), (h, k)) = (values[i], values[(i + 1) % n]);
        if f > 0 && g > 0 || h > 0 && k > 0 {
            return true;
        }
        // One end is in front only, the other before only: the front part must reach farther.
        let (f, g, h, k) = if f > 0 { (f, g, h, k) } else { (h, k, f, g) };
        let crossed = f > 0 && g <= 0 && h <= 0 && k > 0;
        crossed && (I256::product_i128(-g, f - h) - I256::product_i128(f, k - g)).is_negative()
    })
}

fn sides(plane: &Plane, points: &[Point]) -> Vec<Sign> {
    points.iter().map(|&p| plane.side(p)).collect()
}

fn crossed(signs: &[Sign]) -> bool {
    signs.contains(&Sign::Positive) && signs.contains(&Sign::Negative)
}

/// The sign of the scalar product of two planes' normals.
fn scalar_sign(a: &Plane, b: &Plane) -> Sign {
    Sign::of(
        (0..3)
            .map(|k| i128::from(a.normal[k]) * i128::from(b.normal[k]))
            .sum::<i128>(),
    )
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{Plane, Point};
    use antumbra_lines::{Gate, PluckerSpace};
    use antumbra_scene::{ObjectId, PolygonId, PolygonRef};

    use super::blocker_cones;

    fn gate(corners: [Point; 3]) -> Gate {
        let plane = Plane::through(corners[0], corners[1], corners[2]);
        Gate {
            corners: corners.to_vec(),
            plane,
        }
    }

    /// A polygon with a corner in front of the source and another before the target, but no point
    /// that is both.
    #[test]
    fn an_occluder_with_no_part_between_blocks_nothing() {
        let p = Point::new;
        let source = gate([p(0, 0, 0), p(4, 0, 0), p(0, 4, 0)]);
        // The target's plane is x + z = 20, crossed along (1, 0, 1).
        let target = gate([p(20, 0, 0), p(16, 8, 4), p(10, 0, 10)]);
        let plane_of = |c: &[Point]| Plane::through(c[0], c[1], c[2]);
        let build = |space: &mut PluckerSpace, corners: &[Point]| {
            let plane = plane_of(corners);
            let polygon = PolygonRef {
                id: PolygonId(0),
                object: ObjectId(0),
                corners,
                plane: &plane,
                occludes: true,
            };
            let target = if target.plane.side(p(0, 0, 0)).is_negative() {
                target.clone()
            } else {
                target.flipped()
            };
            blocker_cones(space, &polygon, &source, true, &target).len()
        };
        let mut space = PluckerSpace::new();
        // In front of the source only beyond the target, before the target only behind the source.
        let apart = [p(30, 0, 5), p(-40, 1, -30), p(32, 9, 4)];
        assert_eq!(build(&mut space, &apart), 0);
        let between = [p(1, 0, 5), p(3, 1, 5), p(2, 9, 6)];
        assert_ne!(build(&mut space, &between), 0);
    }
}
