//! The approximate occlusion sweep of a plan with hierarchical tests [Bittner02, 3.2, 3.4 and 6.6].
//!
//! As the sweep of polygons, over pieces and boxes of the plane: nodes of the kD-tree nearest first, each
//! box tested against the trees before it is opened. The trees merge late, closer occluders.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use antumbra_kernel::{Point2, Rect};
use antumbra_lines::{DepthSpace, LineSpace, Occluder, OcclusionTree, SegmentOccluder};
use antumbra_scene::plan::{PieceId, Plan};
use rustc_hash::FxHashSet;

use super::line::PlanLine;
use crate::occlusion::{BoxTest, SweepOrder};
use crate::range::Range;

/// What a segment blocks in one tree.
#[derive(Clone, Debug)]
pub(super) struct Blocker<P> {
    /// The tree.
    pub tree: usize,
    /// The window that the lines leave through.
    pub window: usize,
    /// The lines.
    pub piece: P,
    /// Its number in the line space.
    pub occluder: Occluder,
    /// How far it is from where the lines leave, in grid steps.
    pub range: Range,
}

pub(super) type PlaneOf<S> = <<S as Source>::Space as LineSpace>::Plane;
pub(super) type RayOf<S> = <<S as Source>::Space as LineSpace>::Ray;
pub(super) type PieceOf<S> = <<S as Source>::Space as LineSpace>::Piece;

/// A source of lines in the plane.
pub(super) trait Source {
    /// Its line space.
    type Space: DepthSpace;

    /// The line space.
    fn space(&mut self) -> &mut Self::Space;

    /// How many occlusion trees it fills.
    fn tree_count(&self) -> usize;

    /// The box around it.
    fn bounds(&self) -> Rect;

    /// Whether it meets a closed box. Exact.
    fn meets_rect(&self, rect: &Rect) -> bool;

    /// The lines that a segment blocks; none if they are no open set.
    fn blockers(&mut self, piece: [Point2; 2], key: u32, out: &mut Vec<Blocker<PieceOf<Self>>>);

    /// How many occluders the line space has.
    fn occluder_count(&self) -> usize;

    /// Forgets occluders that left no trace in a tree.
    fn forget(&mut self, from: usize);

    /// Whether something in a box that the source does not meet may be seen: `false` is exact.
    fn sees(
        &mut self,
        trees: &[OcclusionTree<PlaneOf<Self>>],
        bounds: &Rect,
        test: BoxTest,
    ) -> bool;

    /// A ray as a line.
    fn line(&self, ray: &RayOf<Self>) -> PlanLine;

    /// The extreme rays of a piece as lines, in turning order.
    fn extremal(&mut self, piece: &PieceOf<Self>) -> Vec<PlanLine> {
        let rays: Vec<RayOf<Self>> = self.space().rays(piece).cloned().collect();
        rays.iter().map(|ray| self.line(ray)).collect()
    }

    /// Whether points lie behind an occluder, or on its line. Exact.
    fn is_behind(&self, occluder: Occluder, points: &[Point2]) -> bool;

    /// The segment of an occluder, with its ends on the left and on the right of the lines that meet it.
    fn segment(&self, occluder: Occluder) -> &SegmentOccluder;

    /// The piece of an occluder.
    fn depth_key(&self, occluder: Occluder) -> u32 {
        self.segment(occluder).key
    }
}

/// What a sweep did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlanWork {
    /// Nodes of the kD-tree that were tested.
    pub nodes_tested: u64,
    /// Nodes found hidden.
    pub nodes_culled: u64,
    /// Leaves opened.
    pub leaves_opened: u64,
    /// Blocker cones made.
    pub blockers: u64,
    /// Segments inserted.
    pub inserted: u64,
    /// Nodes of the occlusion trees.
    pub tree_nodes: u64,
}

impl PlanWork {
    /// Adds the work of another sweep.
    pub fn add(&mut self, other: &Self) {
        self.nodes_tested += other.nodes_tested;
        self.nodes_culled += other.nodes_culled;
        self.leaves_opened += other.leaves_opened;
        self.blockers += other.blockers;
        self.inserted += other.inserted;
        self.tree_nodes += other.tree_nodes;
    }
}

/// A point of the growth of the trees: blockers inserted so far, nodes so far.
pub type Growth = Vec<(u64, u64)>;

/// How the sweep goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct How {
    pub order: SweepOrder,
    pub test: BoxTest,
    /// No piece that is as a whole farther from the source's box than this, in grid steps, is asked for.
    pub reach: Option<u64>,
    pub growth: bool,
}

/// Whether a piece comes within the reach of a cell in a box. Exact. Its points that are near lie in leaves that are
/// near, so that the kD-tree has no say in it.
pub(super) fn comes_near(reach: Option<u64>, ends: [Point2; 2], from: &Rect) -> bool {
    reach.is_none_or(|reach| !from.is_beyond(reach, ends))
}

/// Whether a piece goes on beyond the reach of a cell in a box. Exact: distance grows towards one of its ends.
pub(super) fn goes_beyond(reach: Option<u64>, ends: [Point2; 2], from: &Rect) -> bool {
    let beyond = |reach| ends.iter().any(|&p| from.is_beyond(reach, [p, p]));
    reach.is_some_and(beyond)
}

/// What a sweep leaves behind.
#[derive(Clone, Debug)]
pub(super) struct Swept<S: Source> {
    pub source: S,
    pub trees: Vec<OcclusionTree<PlaneOf<S>>>,
    pub work: PlanWork,
    pub culled: Vec<u32>,
    pub opened: Vec<u32>,
    pub growth: Growth,
}

/// Sweeps all occluders of a plan.
pub(super) fn sweep<S: Source>(plan: &Plan, source: S, how: How) -> Swept<S> {
    let trees = vec![OcclusionTree::new(); source.tree_count()];
    let mut sweeper = Sweeper {
        plan,
        how,
        seen: FxHashSet::default(),
        scratch: Vec::new(),
        out: Swept {
            source,
            trees,
            work: PlanWork::default(),
            culled: Vec::new(),
            opened: Vec::new(),
            growth: Vec::new(),
        },
    };
    if !plan.kd().nodes().is_empty() && !sweeper.out.trees.is_empty() {
        match how.order {
            SweepOrder::DepthFirst => sweeper.depth_first(),
            SweepOrder::Priority => sweeper.by_priority(),
        }
    }
    let nodes: usize = sweeper.out.trees.iter().map(|t| t.nodes().len()).sum();
    sweeper.out.work.tree_nodes = nodes as u64;
    sweeper.out
}

/// The second pass [Bittner02, 6.6]: tests the leaves that were opened against the finished trees, exactly. Returns
/// the highest nodes all of whose leaves with pieces are visible, and the leaves that turned out to be hidden.
///
/// A piece along the near side of a leaf hides the whole box, and is seen itself: leaves that hold a piece of
/// which something is seen stay visible.
pub(super) fn second_pass<S: Source>(
    plan: &Plan,
    swept: &mut Swept<S>,
    pieces: &FxHashSet<PieceId>,
) -> (Vec<u32>, Vec<u32>) {
    let nodes = plan.kd().nodes();
    let mut visible = vec![false; nodes.len()];
    let mut hidden = Vec::new();
    for &leaf in &swept.opened {
        let node = &nodes[leaf as usize];
        let source = &mut swept.source;
        let seen = plan.kd().items(node).iter().any(|id| pieces.contains(id))
            || source.meets_rect(&node.bounds)
            || source.sees(&swept.trees, &node.bounds, BoxTest::Exact);
        visible[leaf as usize] = seen;
        if !seen {
            hidden.push(leaf);
        }
    }
    // Children come after their parents. Leaves without pieces ask for nothing.
    for (i, node) in nodes.iter().enumerate().rev() {
        visible[i] = match node.children() {
            Some([a, b]) => visible[a as usize] && visible[b as usize],
            None => visible[i] || node.count() == 0,
        };
    }
    let mut highest = Vec::new();
    let mut stack: Vec<u32> = if nodes.is_empty() {
        Vec::new()
    } else {
        vec![0]
    };
    while let Some(index) = stack.pop() {
        let node = &nodes[index as usize];
        match node.children() {
            _ if visible[index as usize] => {
                let empty = node.children().is_none() && node.count() == 0;
                highest.extend((!empty).then_some(index));
            }
            Some(children) => stack.extend(children),
            None => {}
        }
    }
    highest.sort_unstable();
    hidden.sort_unstable();
    (highest, hidden)
}

/// What waits in the queue of the sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Waiting {
    Node(u32),
    Piece(PieceId),
}

struct Sweeper<'p, S: Source> {
    plan: &'p Plan,
    how: How,
    seen: FxHashSet<PieceId>,
    scratch: Vec<Blocker<PieceOf<S>>>,
    out: Swept<S>,
}

impl<S: Source> Sweeper<'_, S> {
    fn depth_first(&mut self) {
        let nodes = self.plan.kd().nodes();
        let around = self.out.source.bounds();
        let middle = [
            i64::from(around.min.x) + i64::from(around.max.x),
            i64::from(around.min.y) + i64::from(around.max.y),
        ];
        let mut stack = vec![0_u32];
        let mut pieces = Vec::new();
        while let Some(index) = stack.pop() {
            if !self.opens(index) {
                continue;
            }
            let node = &nodes[index as usize];
            let Some([lower, upper]) = node.children() else {
                self.leaf(index, &mut pieces);
                pieces.drain(..).for_each(|id| self.insert(id));
                continue;
            };
            let (axis, at) = node.split();
            if middle[axis] < 2 * i64::from(at) {
                stack.extend([upper, lower]);
            } else {
                stack.extend([lower, upper]);
            }
        }
    }

    fn by_priority(&mut self) {
        let nodes = self.plan.kd().nodes();
        let around = self.out.source.bounds();
        let distance = |index: u32| nodes[index as usize].bounds.distance_squared(&around);
        // Of equally near things the later one: it is deeper, so that pieces come soon. Pieces wait in the queue, too,
        // so that they come in their own order rather than that of their leaves.
        let mut queue = BinaryHeap::from([(Reverse(distance(0)), Waiting::Node(0))]);
        let mut pieces = Vec::new();
        while let Some((_, waiting)) = queue.pop() {
            let index = match waiting {
                Waiting::Node(index) => index,
                Waiting::Piece(id) => {
                    self.insert(id);
                    continue;
                }
            };
            if !self.opens(index) {
                continue;
            }
            match nodes[index as usize].children() {
                Some(children) => {
                    queue.extend(children.map(|c| (Reverse(distance(c)), Waiting::Node(c))));
                }
                None => {
                    self.leaf(index, &mut pieces);
                    queue.extend(pieces.drain(..).map(|id| {
                        let ends = self.plan.pieces()[id.0 as usize];
                        let rect = Rect::around(ends).unwrap_or(around);
                        (Reverse(rect.distance_squared(&around)), Waiting::Piece(id))
                    }));
                }
            }
        }
    }

    /// Whether anything in a node's closed box may be seen.
    fn opens(&mut self, index: u32) -> bool {
        let node = &self.plan.kd().nodes()[index as usize];
        let out = &mut self.out;
        if node.children().is_none() && node.count() == 0 {
            return false;
        }
        let from = out.source.bounds();
        let beyond = |reach| from.distance_squared(&node.bounds).unsigned_abs() > squared(reach);
        if self.how.reach.is_some_and(beyond) {
            return false;
        }
        if self.how.test == BoxTest::Never {
            return true;
        }
        out.work.nodes_tested += 1;
        let seen = out.source.meets_rect(&node.bounds)
            || out.source.sees(&out.trees, &node.bounds, self.how.test);
        if !seen {
            out.work.nodes_culled += 1;
            out.culled.push(index);
        }
        seen
    }

    /// The pieces of a leaf that are to be inserted.
    fn leaf(&mut self, index: u32, pieces: &mut Vec<PieceId>) {
        self.out.work.leaves_opened += 1;
        self.out.opened.push(index);
        let plan = self.plan;
        for &id in plan.kd().items(&plan.kd().nodes()[index as usize]) {
            let ends = plan.pieces()[id.0 as usize];
            let near = comes_near(self.how.reach, ends, &self.out.source.bounds());
            if near && plan.occludes(id) && self.seen.insert(id) {
                pieces.push(id);
            }
        }
    }

    fn insert(&mut self, id: PieceId) {
        let out = &mut self.out;
        let count = out.source.occluder_count();
        let mut blockers = std::mem::take(&mut self.scratch);
        let ends = self.plan.pieces()[id.0 as usize];
        out.source.blockers(ends, id.0, &mut blockers);
        out.work.blockers += blockers.len() as u64;
        let mut seen = false;
        for blocker in blockers.drain(..) {
            let tree = &mut out.trees[blocker.tree];
            seen |= tree.insert_at(
                out.source.space(),
                blocker.piece,
                blocker.occluder,
                blocker.range.near,
                |_, _| blocker.range.far,
            );
        }
        self.scratch = blockers;
        if seen {
            out.work.inserted += 1;
        } else {
            out.source.forget(count);
        }
        if self.how.growth {
            let nodes: usize = out.trees.iter().map(|t| t.nodes().len()).sum();
            out.growth.push((out.work.blockers, nodes as u64));
        }
    }
}

fn squared(reach: u64) -> u64 {
    reach.saturating_mul(reach)
}
