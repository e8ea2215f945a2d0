//! The isovist: all that is seen of the plane from somewhere in a cell.

use antumbra_scene::plan::{Plan, PlanCell};
use antumbra_sweep::plan::{Tile, frame, tiles, union};

/// The visible area of a cell within a box around the plan and the cell.
///
/// What bounds it is decided exactly: each funnel sweeps a tile that is bounded by extremal lines, and of their union only the
/// coordinates of corners are rounded. What has no width is no part of it: a wall that is seen from both sides does not cut it.
#[derive(Clone, Debug, PartialEq)]
pub struct Isovist {
    /// Polygons in scene units: an outline counter-clockwise, then holes.
    pub polygons: Vec<Vec<Vec<[f64; 2]>>>,
    /// The area in square units.
    pub area: f64,
    /// The length of all outlines and holes.
    pub perimeter: f64,
    /// The largest distance of a visible point from the middle of the cell's box.
    pub depth: f64,
    /// Whether one sees out of the plan: then the isovist is cut by the box around it.
    pub open: bool,
}

/// The isovist of a cell. The cell itself is part of it.
#[must_use]
pub fn isovist(plan: &Plan, cell: &PlanCell) -> Isovist {
    let frame = frame(plan, &cell.parts);
    let seen = |part| {
        tiles(plan, part, &frame)
            .into_iter()
            .chain(Tile::region(part))
    };
    let tiles: Vec<Tile> = cell.parts.iter().flat_map(seen).collect();
    let open = tiles.iter().any(|tile| tile.framed);
    let scene = |ring: Vec<[f64; 2]>| ring.into_iter().map(|p| plan.to_scene_f64(p)).collect();
    let polygons = union(&tiles)
        .into_iter()
        .map(|rings| rings.into_iter().map(scene).collect())
        .collect();
    measure(plan, cell, polygons, open)
}

fn measure(plan: &Plan, cell: &PlanCell, polygons: Vec<Vec<Vec<[f64; 2]>>>, open: bool) -> Isovist {
    let corners = cell.parts.iter().flat_map(|p| p.corners().to_vec());
    let bounds = antumbra_kernel::Rect::around(corners);
    let middle = bounds.map_or([0.0; 2], |b| {
        let (low, high) = (plan.to_scene(b.min), plan.to_scene(b.max));
        [0, 1].map(|k| (low[k] + high[k]) / 2.0)
    });
    let (mut area, mut perimeter, mut depth) = (0.0, 0.0, 0.0_f64);
    for contour in polygons.iter().flatten() {
        let n = contour.len();
        for i in 0..n {
            // Relative to the middle, so that far coordinates cost no precision.
            let [p, q] =
                [contour[i], contour[(i + 1) % n]].map(|p| [p[0] - middle[0], p[1] - middle[1]]);
            area += (p[0] * q[1] - p[1] * q[0]) / 2.0;
            perimeter += (q[0] - p[0]).hypot(q[1] - p[1]);
            depth = depth.max(p[0].hypot(p[1]));
        }
    }
    Isovist {
        polygons,
        area,
        perimeter,
        depth,
        open,
    }
}
