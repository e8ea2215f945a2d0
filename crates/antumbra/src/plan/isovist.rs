//! The isovist: all that is seen of the plane from somewhere in a cell.

use antumbra_scene::plan::{Plan, PlanCell};
use antumbra_sweep::plan::{frame, tiles};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::int::shape::{IntContour, IntShapes};

/// The visible area of a cell within a box around the plan.
///
/// What bounds it is decided exactly: each funnel sweeps a tile whose corners are points of the plan and ends of
/// extremal lines. The union of the tiles is taken after they were rounded to 2^-23 of the extent of what is seen, or to the grid.
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
    let parts = parts_of_a_step(&outlines);
    let fixed = |p: &[f64; 2]| {
        let [x, y] = p.map(|v| (v * parts).round() as i64);
        IntPoint::new(x, y)
    };
    let fixed: Vec<IntContour<i64>> = outlines
        .iter()
        .map(|o| o.iter().map(fixed).collect())
        .collect();
    let scene = |p: &IntPoint<i64>| plan.to_scene_f64([p.x, p.y].map(|v| v as f64 / parts));
    let polygons = union(&fixed)
        .iter()
        .map(|shape| {
            let contours = shape.iter();
            contours.map(|c| c.iter().map(scene).collect()).collect()
        })
        .collect();
    measure(plan, cell, polygons, open)
}

/// How many parts of a grid step the union counts in: a power of two that makes 2^23 to 2^24 of the largest coordinate.
/// In finer parts, edges on one line, rounded, would cross each other hundreds of times.
fn parts_of_a_step(outlines: &[Vec<[f64; 2]>]) -> f64 {
    let coordinates = outlines.iter().flatten().flatten();
    let largest = coordinates.fold(1.0_f64, |m, c| m.max(c.abs()));
    (23.0 - largest.log2().floor()).max(0.0).exp2()
}

/// The union of outlines by halves. Neighbors in the list come from neighbors of a tree and overlap; all tiles
/// at once cross each other far too often, unions of neighbors hardly do.
fn union(outlines: &[IntContour<i64>]) -> IntShapes<i64> {
    const FEW: usize = 8;
    let mut overlay = Overlay::<i64>::new(0);
    if outlines.len() <= FEW {
        overlay.add_source(outlines, ShapeType::Subject);
    } else {
        let (left, right) = outlines.split_at(outlines.len() / 2);
        for part in [left, right] {
            overlay.add_source(&union(part), ShapeType::Subject);
        }
    }
    overlay.overlay(OverlayRule::Subject, FillRule::NonZero)
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
