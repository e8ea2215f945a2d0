//! The area that is seen, in tiles: each funnel sweeps the area between its window and what it sees.
//!
//! A frame of four segments around everything closes the view. The area that a funnel sweeps is bounded by its
//! window, by what it sees, and on both sides by chains: the points left of all its lines make a convex set, and
//! so do those right of them. The corners of the chains are points of the plan: the funnel's facets. Which they
//! are, and in which order, is decided exactly; their coordinates and ends are rounded, for output.

use antumbra_kernel::{LIMIT, Point2, Rect};
use antumbra_lines::Half;
use antumbra_scene::plan::{CellShape, Plan};

use super::answer::blocked;
use super::line::PlanLine;
use super::point::PointLines;
use super::region::RegionLines;
use super::sweep::{How, Source, Swept, sweep};
use crate::occlusion::{BoxTest, SweepOrder};

/// The part of the plane that is looked at: a box around plan and cell.
#[must_use]
pub fn frame(plan: &Plan, cell: &CellShape) -> Rect {
    let around = cell.bounds();
    let all = plan.bounds().map_or(around, |b| {
        Rect::around([b.min, b.max, around.min, around.max]).unwrap_or(b)
    });
    let margin = 1 + (all.max.x - all.min.x).max(all.max.y - all.min.y) / 64;
    let keep = |v: i32| v.clamp(2 - LIMIT, LIMIT - 2);
    Rect {
        min: Point2::new(keep(all.min.x - margin), keep(all.min.y - margin)),
        max: Point2::new(keep(all.max.x + margin), keep(all.max.y + margin)),
    }
}

/// The outlines of the tiles in grid steps, counter-clockwise; and whether each ends at the frame. They may overlap.
#[must_use]
pub fn tiles(plan: &Plan, cell: &CellShape, frame: &Rect) -> Vec<(Vec<[f64; 2]>, bool)> {
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
            let roots = swept.source.roots();
            let mut cells = Vec::new();
            blocked(
                swept.source.space(),
                &swept.trees[0],
                roots,
                |_, wedge, k| {
                    cells.push((*wedge, k));
                },
            );
            let eye = eye.to_f64();
            cells
                .into_iter()
                .map(|(wedge, k)| {
                    let (target, framed) = target(plan, frame, swept.source.depth_key(k));
                    let lines = swept.source.extremal(&wedge);
                    let hits = lines.iter().map(|l| meet(l, target));
                    ([eye].into_iter().chain(hits).collect(), framed)
                })
                .collect()
        }
        _ => {
            let source = RegionLines::new(plan, cell.clone(), false);
            let mut swept = sweep(plan, source, how);
            close(&mut swept, frame);
            let mut out = Vec::new();
            for window in 0..swept.source.windows().len() {
                let tree = &swept.trees[window];
                let roots = swept.source.roots(window, tree);
                let mut cells = Vec::new();
                blocked(swept.source.space(), tree, roots, |_, cone, k| {
                    cells.push((cone.clone(), k));
                });
                let w = swept.source.windows()[window];
                for (cone, k) in cells {
                    let (target, framed) = target(plan, frame, swept.source.depth_key(k));
                    let facets: Vec<([f64; 2], Half)> = cone
                        .corners
                        .iter()
                        .map(|c| {
                            let [x, y, w] = swept.source.point_of(c.plane).map(|v| v as f64);
                            ([x / w, y / w], c.side)
                        })
                        .collect();
                    let tile = Tile {
                        lines: swept.source.extremal(&cone),
                        facets,
                        window: [w.a, w.b],
                        target,
                    };
                    out.push((tile.outline(), framed));
                }
            }
            out
        }
    }
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

/// The ends of what a key stands for, and whether it is the frame.
fn target(plan: &Plan, frame: &Rect, key: u32) -> ([Point2; 2], bool) {
    match plan.pieces().get(key as usize) {
        Some(&piece) => (piece, false),
        None => {
            let k = (key - FRAME) as usize;
            let corners = frame.corners();
            ([corners[k], corners[(k + 1) % 4]], true)
        }
    }
}

/// Where a line meets a segment, rounded.
fn meet(line: &PlanLine, [p, q]: [Point2; 2]) -> [f64; 2] {
    let l = line.rounded();
    let (p, q) = (p.to_f64(), q.to_f64());
    let at = |p: [f64; 2]| l[0] * p[0] + l[1] * p[1] + l[2];
    let (u, v) = (at(p), at(q));
    let t = if u == v {
        0.0
    } else {
        (u / (u - v)).clamp(0.0, 1.0)
    };
    [0, 1].map(|k| p[k] + t * (q[k] - p[k]))
}

/// A funnel: line i meets facets i - 1 and i.
struct Tile {
    lines: Vec<PlanLine>,
    facets: Vec<([f64; 2], Half)>,
    window: [Point2; 2],
    target: [Point2; 2],
}

impl Tile {
    fn outline(&self) -> Vec<[f64; 2]> {
        // The left chain from window to target, and the right one back: clockwise.
        let mut out = self.chain(Half::Positive);
        let right = self.chain(Half::Negative);
        out.extend(right.into_iter().rev());
        out.reverse();
        out
    }

    /// The points that bound the lines on one side, from the window to the target.
    fn chain(&self, side: Half) -> Vec<[f64; 2]> {
        let n = self.facets.len();
        let on = |i: usize| self.facets[i % n].1 == side;
        let Some(start) = (0..n).find(|&i| on(i) && !on(i + n - 1)) else {
            return Vec::new();
        };
        let count = (start..start + n).take_while(|&i| on(i)).count();
        let mut lines: Vec<&PlanLine> = (start..=start + count)
            .map(|i| &self.lines[i % n])
            .collect();
        let mut pivots: Vec<[f64; 2]> = (start..start + count)
            .map(|i| self.facets[i % n].0)
            .collect();
        // Lines of the left chain turn left on their way, those of the right chain right.
        let (first, last) = (lines[0].rounded(), lines[count].rounded());
        let turn = first[0] * last[1] - first[1] * last[0];
        if (turn < 0.0) == (side == Half::Positive) {
            lines.reverse();
            pivots.reverse();
        }
        let beyond = |p: [f64; 2]| -> f64 { -turn_of(self.window, p) };
        // The line of the target may cross the window: what counts is where a line inside the funnel starts.
        let start = meet(&PlanLine::sum(&self.lines), self.window);
        let sign = -turn_of(self.target, start);
        let behind = |p: [f64; 2]| turn_of(self.target, p) * sign;
        let skip = pivots.iter().take_while(|&&p| beyond(p) <= 0.0).count();
        let keep = pivots
            .iter()
            .take_while(|&&p| behind(p) < 0.0)
            .count()
            .max(skip);
        let mut out = vec![self.end(lines[skip], self.window, &pivots, skip)];
        out.extend(&pivots[skip..keep]);
        out.push(self.end(lines[keep], self.target, &pivots, keep));
        out
    }

    /// Where a line of a chain ends on a segment; one that runs along it ends where it turns.
    fn end(
        &self,
        line: &PlanLine,
        segment: [Point2; 2],
        pivots: &[[f64; 2]],
        at: usize,
    ) -> [f64; 2] {
        let along = segment.iter().all(|&p| line.side(p) == 0);
        if along && !pivots.is_empty() {
            return pivots[at.min(pivots.len() - 1)];
        }
        meet(line, segment)
    }
}

/// Twice the signed area of the triangle of a segment and a point.
fn turn_of([a, b]: [Point2; 2], p: [f64; 2]) -> f64 {
    let (a, b) = (a.to_f64(), b.to_f64());
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}
