//! What a convex cell of the plane sees of a plan, exactly.
//!
//! After [Bittner02, ch. 6]: the lines that leave the cell fill occlusion trees over the cone in R^3; the
//! sweep of the plan's kD-tree inserts occluders nearest first, and boxes that the trees hide are never
//! opened. The leaves of the finished trees are the funnels, from which come the visible fragments.

mod answer;
mod area;
mod certificate;
mod distance;
mod line;
mod point;
mod ratio;
mod region;
mod sight;
mod sweep;
mod tiles;

use antumbra_lines::{LineSpace, OcclusionTree};
use antumbra_scene::plan::{CellShape, PieceId, Plan};
use rustc_hash::FxHashSet;

use crate::occlusion::{BoxTest, SweepOrder};
use crate::proof::PlanProof;
use crate::verdict::Accuracy;

pub use answer::{Fragment, Funnel};
pub use area::{Outlines, union};
pub use line::PlanLine;
use point::PointLines;
pub use ratio::Ratio;
use region::RegionLines;
pub use region::Window;
pub use sight::{Sight, sights};
pub use sweep::{Growth, PlanWork};
use sweep::{How, Source, Swept, sweep};
pub use tiles::{Tile, frame, tiles};

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewOptions {
    /// The order of the sweep.
    pub order: SweepOrder,
    /// How boxes are tested.
    pub test: BoxTest,
    /// One tree for all edges of a cell, instead of one for each [Bittner02, 6.5.2].
    pub one_tree: bool,
    /// Leave out pieces that are as a whole farther from the box around the cell than this, in grid steps. What is seen
    /// within it is exact; a piece that goes on beyond it may be seen there through another one that was left
    /// out, and then the view is conservative.
    pub reach: Option<u64>,
    /// Test the opened kD leaves again against the finished trees [Bittner02, 6.6].
    pub second_pass: bool,
    /// Keep the funnels.
    pub funnels: bool,
    /// Keep the certificate (not of points, and not with a reach).
    pub proof: bool,
    /// Record how the trees grow.
    pub growth: bool,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            order: SweepOrder::Priority,
            test: BoxTest::Exact,
            one_tree: false,
            reach: None,
            second_pass: false,
            funnels: false,
            proof: false,
            growth: false,
        }
    }
}

/// What a cell sees.
#[derive(Clone, Debug)]
pub struct PlanView {
    /// The cell.
    pub cell: CellShape,
    /// The windows of the cell; none for a point.
    pub windows: Vec<Window>,
    /// Pieces that meet the closed cell: visible, whatever else is said of them.
    pub touching: Vec<PieceId>,
    /// The visible fragments, by piece.
    pub fragments: Vec<Fragment>,
    /// The funnels, by piece, if they were asked for.
    pub funnels: Vec<Funnel>,
    /// The certificate, if it was asked for.
    pub proof: Option<PlanProof>,
    /// Exact, or conservative if an occluder meets the open interior of the cell or a fragment belongs to a piece that
    /// goes on beyond the reach.
    pub accuracy: Accuracy,
    /// What was done.
    pub work: PlanWork,
    /// Nodes of the kD-tree that were found hidden.
    pub culled: Vec<u32>,
    /// After a second pass: the highest nodes of the kD-tree that are visible with all their leaves.
    pub visible_nodes: Vec<u32>,
    /// After a second pass: leaves that were opened and turned out to be hidden.
    pub reclassified: Vec<u32>,
    /// How the trees grew, if that was asked for.
    pub growth: Growth,
}

/// Looks from a convex cell. Exact; the expected cost grows with what is seen.
#[must_use]
pub fn look(plan: &Plan, cell: &CellShape, options: &ViewOptions) -> PlanView {
    let how = How {
        order: options.order,
        test: options.test,
        reach: options.reach,
        growth: options.growth,
    };
    match cell {
        CellShape::Point(eye) => {
            let mut swept = sweep(plan, PointLines::new(*eye), how);
            let funnels = point_funnels(plan, &mut swept, how.reach);
            let grazing = swept.source.grazing.clone();
            let middle = |f: &Funnel| PlanLine::avoiding(&f.lines, &grazing);
            finish(plan, cell, Vec::new(), (funnels, middle), swept, options)
        }
        CellShape::Segment(_) | CellShape::Region(_) => {
            let source = RegionLines::new(plan, cell.clone(), options.one_tree);
            let mut swept = sweep(plan, source, how);
            let funnels = region_funnels(plan, &mut swept, how.reach);
            let windows = swept.source.windows().to_vec();
            let grazing = swept.source.grazing.clone();
            let middle = |f: &Funnel| PlanLine::avoiding(&f.lines, &grazing[f.window as usize]);
            let trees = (options.proof && options.reach.is_none())
                .then(|| certificate::trees(&swept.source, &swept.trees));
            let mut view = finish(plan, cell, windows, (funnels, middle), swept, options);
            view.proof = trees.map(|trees| certificate::proof(&view, trees));
            view
        }
    }
}

fn region_funnels(plan: &Plan, swept: &mut Swept<RegionLines>, reach: Option<u64>) -> Vec<Funnel> {
    let mut out = Vec::new();
    let source = &mut swept.source;
    for window in 0..source.windows().len() {
        let tree = &swept.trees[source.tree_of(window)];
        let roots = source.roots(window, tree);
        blocked_funnels(plan, source, tree, (window, roots), &mut out);
    }
    glass_funnels(plan, swept, reach, &mut out);
    out
}

fn point_funnels(plan: &Plan, swept: &mut Swept<PointLines>, reach: Option<u64>) -> Vec<Funnel> {
    let mut out = Vec::new();
    let source = &mut swept.source;
    let roots = source.roots();
    blocked_funnels(plan, source, &swept.trees[0], (0, roots), &mut out);
    glass_funnels(plan, swept, reach, &mut out);
    out
}

/// The blocked cells of a tree as funnels.
fn blocked_funnels<S: Source>(
    plan: &Plan,
    source: &mut S,
    tree: &OcclusionTree<sweep::PlaneOf<S>>,
    (window, roots): (usize, Vec<sweep::PieceOf<S>>),
    out: &mut Vec<Funnel>,
) {
    let mut rays = Vec::new();
    let mut cells = Vec::new();
    answer::blocked(source.space(), tree, roots, |space, piece, occluder| {
        rays.extend(space.rays(piece).cloned());
        cells.push((rays.len(), occluder));
    });
    let mut from = 0;
    out.reserve(cells.len());
    for (to, occluder) in cells {
        let lines = rays[from..to].iter().map(|r| source.line(r)).collect();
        from = to;
        let id = PieceId(source.depth_key(occluder));
        out.extend(Funnel::new(plan, window as u32, id, lines));
    }
}

/// The funnels of pieces that block nothing, in the leaves that were opened.
fn glass_funnels<S: Source>(
    plan: &Plan,
    swept: &mut Swept<S>,
    reach: Option<u64>,
    out: &mut Vec<Funnel>,
) {
    let from = swept.source.bounds();
    let near = |id: PieceId| sweep::comes_near(reach, plan.pieces()[id.0 as usize], &from);
    let opened = swept.opened.iter().map(|&i| &plan.kd().nodes()[i as usize]);
    let mut glass: Vec<PieceId> = opened
        .flat_map(|node| plan.kd().items(node))
        .copied()
        .filter(|&id| !plan.occludes(id) && near(id))
        .collect();
    glass.sort_unstable();
    glass.dedup();
    let mut blockers = Vec::new();
    for id in glass {
        let source = &mut swept.source;
        source.blockers(plan.pieces()[id.0 as usize], id.0, &mut blockers);
        for blocker in blockers.drain(..) {
            let tree = &swept.trees[blocker.tree];
            let mut seen = Vec::new();
            answer::unblocked(
                source.space(),
                tree,
                blocker.piece,
                blocker.occluder,
                |piece| seen.push(piece.clone()),
            );
            for piece in seen {
                let lines = source.extremal(&piece);
                out.extend(Funnel::new(plan, blocker.window as u32, id, lines));
            }
        }
    }
}

fn finish<S: Source>(
    plan: &Plan,
    cell: &CellShape,
    windows: Vec<Window>,
    (mut funnels, middle): (Vec<Funnel>, impl Fn(&Funnel) -> PlanLine),
    mut swept: Swept<S>,
    options: &ViewOptions,
) -> PlanView {
    let fragments = answer::fragments(&mut funnels, middle);
    let (visible_nodes, reclassified) = if options.second_pass {
        let seen: FxHashSet<PieceId> = fragments.iter().map(|f| f.piece).collect();
        sweep::second_pass(plan, &mut swept, &seen)
    } else {
        Default::default()
    };
    if !options.funnels {
        funnels.clear();
    }
    let meets = |id: &PieceId| cell.meets_segment(plan.pieces()[id.0 as usize]);
    let touching: Vec<PieceId> = plan
        .pieces_in(&cell.bounds())
        .into_iter()
        .filter(meets)
        .collect();
    let inside = touching
        .iter()
        .any(|&id| plan.occludes(id) && cell.enters(plan.pieces()[id.0 as usize]));
    let from = cell.bounds();
    let beyond = fragments
        .iter()
        .any(|f| sweep::goes_beyond(options.reach, plan.pieces()[f.piece.0 as usize], &from));
    PlanView {
        cell: cell.clone(),
        windows,
        touching,
        fragments,
        funnels,
        proof: None,
        accuracy: if inside || beyond {
            Accuracy::Conservative
        } else {
            Accuracy::Exact
        },
        work: swept.work,
        culled: swept.culled,
        visible_nodes,
        reclassified,
        growth: swept.growth,
    }
}
