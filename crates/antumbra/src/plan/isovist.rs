//! The isovist: all that is seen of the plane from somewhere in a cell.

use antumbra_scene::plan::{Plan, PlanCell};
use antumbra_sweep::plan::{frame, tiles};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::overlay::FloatOverlay;

/// The visible area of a cell within a box around the plan.
///
/// What bounds it is decided exactly: each funnel sweeps a tile whose corners are points of the plan and ends of
/// extremal lines. The union of the tiles is taken in 64-bit fixed point, after they were rounded.
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
    let mut outlines: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut open = false;
    for part in &cell.parts {
        let frame = frame(plan, part);
        for (outline, framed) in tiles(plan, part, &frame) {
            open |= framed;
            outlines.push(outline);
        }
        if part.corners().len() > 2 {
            outlines.push(part.corners().iter().map(|c| c.to_f64()).collect());
        }
    }
    outlines.retain(|o| o.len() > 2);
    let mut union = FloatOverlay::<[f64; 2], i64>::from_subj(&outlines);
    let shapes = union.overlay(OverlayRule::Subject, FillRule::NonZero);
    let scene = |p: [f64; 2]| plan.to_scene_f64(p);
    let polygons: Vec<Vec<Vec<[f64; 2]>>> = shapes
        .into_iter()
        .map(|shape| {
            let contours = shape.into_iter();
            contours
                .map(|c| c.into_iter().map(scene).collect())
                .collect()
        })
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
