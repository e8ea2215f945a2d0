//! Blocker cones: the lines between two gates that one occluder blocks, as rows of line space.
//!
//! Only the part of an occluder between the planes of source and target blocks. Usually no clip
//! row is needed for that (`docs/notes/blockers.md` has the proof): edges wholly behind either
//! plane are dropped, and the row of the common line of the occluder's plane and the source's is
//! redundant on real lines unless the occluder's plane crosses the source itself. The same holds
//! for the target.

use antumbra_kernel::plucker::edge_row;
use antumbra_kernel::{Plane, Point, Sign};
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
