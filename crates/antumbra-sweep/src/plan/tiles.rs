//! The area that is seen, in tiles: each funnel sweeps the area between its window and what it sees.
//!
//! A frame of four segments around everything closes the view. A point lies in the tile of a funnel if it is beyond
//! the window, before what is seen, and on some line of the funnel: then some of the funnel's extreme lines have it on their
//! left, others on their right. So a tile is a few lines with signs, all exact; no corner of it is ever computed.

use antumbra_kernel::{LIMIT, Point2, Rect};
use antumbra_scene::plan::{CellShape, Plan};

use super::answer::blocked;
use super::line::PlanLine;
use super::point::PointLines;
use super::region::RegionLines;
use super::sweep::{How, Source, Swept, sweep};
use crate::occlusion::{BoxTest, SweepOrder};

/// The part of the plane that is looked at: a box around the plan, with its segments without length, and the parts of a cell.
#[must_use]
pub fn frame(plan: &Plan, cell: &[CellShape]) -> Rect {
    let ends = |r: Rect| [r.min, r.max];
    let points = plan.points().iter().map(|&(_, p)| p);
    let cell = cell.iter().flat_map(|part| ends(part.bounds()));
    let corners = plan.bounds().map(ends).into_iter().flatten();
    let all = Rect::around(corners.chain(cell).chain(points)).unwrap_or(Rect {
        min: Point2::new(0, 0),
        max: Point2::new(0, 0),
    });
    let margin = 1 + (all.max.x - all.min.x).max(all.max.y - all.min.y) / 64;
    let keep = |v: i32| v.clamp(2 - LIMIT, LIMIT - 2);
    Rect {
        min: Point2::new(keep(all.min.x - margin), keep(all.min.y - margin)),
        max: Point2::new(keep(all.max.x + margin), keep(all.max.y + margin)),
    }
}

/// A bounded set of points, by exact lines.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Lines that have all of the tile on their left.
    pub halves: Vec<PlanLine>,
    /// The extreme lines of a funnel: every point of the tile is on the left of some and on the right of others. None
    /// for a convex tile.
    pub fan: Vec<PlanLine>,
    /// A box around the tile in grid steps: smallest and largest coordinates.
    pub bounds: [[f64; 2]; 2],
    /// Whether it ends at the frame.
    pub framed: bool,
}

impl Tile {
    /// A convex polygon, given counter-clockwise; `None` if it is no region.
    #[must_use]
    pub fn region(cell: &CellShape) -> Option<Self> {
        let CellShape::Region(corners) = cell else {
            return None;
        };
        let n = corners.len();
        Some(Self {
            halves: (0..n)
                .map(|k| PlanLine::through(corners[k], corners[(k + 1) % n]))
                .collect(),
            fan: Vec::new(),
            bounds: around(corners.iter().map(|c| c.to_f64())),
            framed: false,
        })
    }
}

/// The tiles of a convex cell, which may overlap. Those of a point do not.
#[must_use]
pub fn tiles(plan: &Plan, cell: &CellShape, frame: &Rect) -> Vec<Tile> {
    let how = How {
        order: SweepOrder::Priority,
        test: BoxTest::Exact,
        reach: None,
        growth: false,
    };
    match cell {
        CellShape::Point(eye) => {
            let mut swept = sweep(plan, PointLines::new(*eye), how);
            close(&mut swept, frame);
            point_tiles(*eye, &mut swept)
        }
        CellShape::Segment(_) | CellShape::Region(_) => {
            let source = RegionLines::new(plan, cell.clone(), false);
            let mut swept = sweep(plan, source, how);
            close(&mut swept, frame);
            let windows = 0..swept.source.windows().len();
            windows
                .flat_map(|window| window_tiles(window, &mut swept))
                .collect()
        }
    }
}

/// Wedges from the eye to what is seen.
fn point_tiles(eye: Point2, swept: &mut Swept<PointLines>) -> Vec<Tile> {
    let source = &mut swept.source;
    let roots = source.roots();
    let mut cells = Vec::new();
    blocked(source.space(), &swept.trees[0], roots, |_, wedge, k| {
        cells.push((*wedge, k));
    });
    let mut out = Vec::new();
    for (wedge, k) in cells {
        let target = source.segment(k);
        let (ends, framed) = ([target.right, target.left], target.key >= FRAME);
        let borders = source.extremal(&wedge);
        let hits = borders.iter().flat_map(|l| hits(l, ends));
        let bounds = around(hits.chain([eye.to_f64()]));
        let [right, left] = [0, 1].map(|k| borders[k].clone());
        out.push(Tile {
            halves: vec![right, left.reversed(), PlanLine::through(ends[0], ends[1])],
            fan: Vec::new(),
            bounds,
            framed,
        });
    }
    out
}

/// The funnels through a window.
fn window_tiles(window: usize, swept: &mut Swept<RegionLines>) -> Vec<Tile> {
    let source = &mut swept.source;
    let tree = &swept.trees[window];
    let roots = source.roots(window, tree);
    let mut cells = Vec::new();
    blocked(source.space(), tree, roots, |_, cone, k| {
        cells.push((cone.clone(), k));
    });
    let w = source.windows()[window];
    let mut out = Vec::new();
    for (cone, k) in cells {
        let target = source.segment(k);
        // The lines come from the left of the way from their right to their left.
        let (ends, framed) = ([target.right, target.left], target.key >= FRAME);
        let fan = source.extremal(&cone);
        let hits = fan
            .iter()
            .flat_map(|l| hits(l, [w.a, w.b]).into_iter().chain(hits(l, ends)));
        let bounds = around(hits);
        out.push(Tile {
            halves: vec![
                PlanLine::through(w.b, w.a),
                PlanLine::through(ends[0], ends[1]),
            ],
            fan,
            bounds,
            framed,
        });
    }
    out
}

/// Keys of the frame's sides.
const FRAME: u32 = u32::MAX - 8;

/// Inserts the frame behind everything.
fn close<S: Source>(swept: &mut Swept<S>, frame: &Rect) {
    let corners = frame.corners();
    let mut blockers = Vec::new();
    for k in 0..4 {
        let side = [corners[k], corners[(k + 1) % 4]];
        swept.source.blockers(side, FRAME + k as u32, &mut blockers);
    }
    for b in blockers {
        let tree = &mut swept.trees[b.tree];
        tree.insert(swept.source.space(), b.piece, b.occluder);
    }
}

/// About where a line meets a segment, to half a step; both ends if that is not clear.
fn hits(line: &PlanLine, [p, q]: [Point2; 2]) -> [[f64; 2]; 2] {
    let l = line.rounded();
    let (p, q) = (p.to_f64(), q.to_f64());
    let at = |p: [f64; 2]| l[0] * p[0] + l[1] * p[1] + l[2];
    let (u, v) = (at(p), at(q));
    let [dx, dy] = [0, 1].map(|k| q[k] - p[k]);
    // Values are right to 2^-27 of the line's length: with an angle above 2^-16 that is 2^-11 steps.
    let clear = l[0].hypot(l[1]) * dx.hypot(dy) / (1 << 16) as f64;
    if (u - v).abs() <= clear {
        return [p, q];
    }
    let t = (u / (u - v)).clamp(0.0, 1.0);
    [[p[0] + t * dx, p[1] + t * dy]; 2]
}

/// The box around some points, a step wider.
fn around(points: impl IntoIterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    points.into_iter().fold(start, |[low, high], p| {
        [
            [0, 1].map(|k| low[k].min(p[k] - 1.0)),
            [0, 1].map(|k| high[k].max(p[k] + 1.0)),
        ]
    })
}
