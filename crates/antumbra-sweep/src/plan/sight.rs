//! Whether a cell sees other cells: the lines to each are filtered down the trees of one sweep.
//!
//! After [Bittner02, 6.5.3]: a target is a virtual segment, or the sides of a region through which lines enter
//! it. It is not inserted, and what lies along it does not hide it.

use antumbra_kernel::{Point2, Rect, orient2d};
use antumbra_lines::SegmentOccluder;
use antumbra_scene::plan::{CellShape, PieceId, Plan};

use super::answer::unblocked;
use super::line::PlanLine;
use super::point::PointLines;
use super::region::{RegionLines, windows};
use super::sweep::{How, Source, Swept, sweep};
use crate::occlusion::{BoxTest, SweepOrder};

/// How two cells see each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sight {
    /// They share a point.
    Touching,
    /// Along this line, from the one to the other, and along all lines near it.
    Line(PlanLine),
}

/// For each target whether it is seen from a cell. Exact; one sweep.
///
/// Two points see each other if no closed segment meets the segment between them, but for those that hold one of the
/// points and those in line with both, which are seen edge-on.
#[must_use]
pub fn sights(plan: &Plan, from: &CellShape, targets: &[CellShape]) -> Vec<Option<Sight>> {
    let how = How {
        order: SweepOrder::Priority,
        test: BoxTest::Exact,
        reach: None,
        growth: false,
    };
    match from {
        CellShape::Point(eye) => {
            let mut swept = sweep(plan, PointLines::new(*eye), how);
            let grazing = vec![swept.source.grazing.clone()];
            let one = |to: &CellShape| match to {
                CellShape::Point(p) => between_points(plan, *eye, *p),
                _ => sight(plan, &mut swept, &grazing, from, to),
            };
            targets.iter().map(one).collect()
        }
        _ => {
            let source = RegionLines::new(plan, from.clone(), false);
            let mut swept = sweep(plan, source, how);
            let grazing = swept.source.grazing.clone();
            let one = |to: &CellShape| match to {
                // Lines through a point are an open set only as seen from the point.
                CellShape::Point(_) => sights(plan, to, std::slice::from_ref(from)).pop().flatten(),
                _ => sight(plan, &mut swept, &grazing, from, to),
            };
            targets.iter().map(one).collect()
        }
    }
}

fn sight<S: Source>(
    plan: &Plan,
    swept: &mut Swept<S>,
    grazing: &[Vec<Point2>],
    from: &CellShape,
    to: &CellShape,
) -> Option<Sight> {
    if from.meets(to) {
        return Some(Sight::Touching);
    }
    let corners = to.corners();
    let mut blockers = Vec::new();
    // Lines enter a region where they could leave it, too: not through walls along its sides.
    let sides = windows(plan, to).into_iter().map(|w| [w.a, w.b]);
    for side in sides.take(if corners.len() == 2 { 1 } else { usize::MAX }) {
        swept
            .source
            .blockers(side, SegmentOccluder::TARGET, &mut blockers);
    }
    let mut found = None;
    for blocker in blockers {
        // Lines enter a region through the sides that it lies behind.
        if found.is_some() || !swept.source.is_behind(blocker.occluder, corners) {
            continue;
        }
        let mut seen = None;
        let tree = &swept.trees[blocker.tree];
        let space = swept.source.space();
        unblocked(space, tree, blocker.piece, blocker.occluder, |piece| {
            seen.get_or_insert_with(|| piece.clone());
        });
        found = seen.map(|piece| {
            let lines = swept.source.extremal(&piece);
            Sight::Line(PlanLine::avoiding(&lines, &grazing[blocker.window]))
        });
    }
    found
}

fn between_points(plan: &Plan, p: Point2, q: Point2) -> Option<Sight> {
    if p == q {
        return Some(Sight::Touching);
    }
    let around = Rect::around([p, q])?;
    let segment = CellShape::Segment([p, q]);
    let blocks = |id: PieceId| {
        let piece = plan.pieces()[id.0 as usize];
        let holds = |p: Point2| CellShape::Point(p).meets_segment(piece);
        let in_line = piece.iter().all(|&e| orient2d(p, q, e) == 0);
        plan.occludes(id) && segment.meets_segment(piece) && !in_line && !holds(p) && !holds(q)
    };
    let blocked = plan.pieces_in(&around).into_iter().any(blocks);
    (!blocked).then(|| Sight::Line(PlanLine::through(p, q)))
}
