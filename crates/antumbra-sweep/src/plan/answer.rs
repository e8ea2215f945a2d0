//! From occlusion trees to what is seen: funnels, and the visible fragments that they make.
//!
//! The cell of a blocked leaf is a *funnel*: all lines through one part of a window on which one segment
//! comes first. Its extreme rays are extremal lines; where they meet the segment bounds what the funnel
//! sees of it. The fragments of a segment are the unions of these intervals, which depend on what is seen
//! alone and not on how the tree cuts it into funnels.

use antumbra_lines::{
    Cut, DepthSpace, Half, Leaf, LineSpace, Occluder, OcclusionTree, Order, Slot, Wall,
};
use antumbra_scene::plan::{PieceId, Plan};

use super::line::PlanLine;
use super::ratio::Ratio;

/// Lines that leave through one part of a window and see one part of a segment.
#[derive(Clone, Debug)]
pub struct Funnel {
    /// The window; 0 for a point.
    pub window: u32,
    /// The piece that they see.
    pub piece: PieceId,
    /// What they see of it, from its smaller end.
    pub at: [Ratio; 2],
    /// The extremal lines, in turning order.
    pub lines: Vec<PlanLine>,
}

impl Funnel {
    /// The funnel of a cell of line space; `None` if its lines meet the piece in one point only.
    pub(super) fn new(
        plan: &Plan,
        window: u32,
        piece: PieceId,
        lines: Vec<PlanLine>,
    ) -> Option<Self> {
        let ends = plan.pieces()[piece.0 as usize];
        let mut at: Option<[Ratio; 2]> = None;
        for line in &lines {
            // A line along the piece bounds what its neighbors see: they meet it where their common
            // hyperplane does.
            let Some(t) = Ratio::on_segment(ends, line) else {
                continue;
            };
            match &mut at {
                None => at = Some([t.clone(), t]),
                Some([low, high]) => {
                    if t < *low {
                        *low = t;
                    } else if t > *high {
                        *high = t;
                    }
                }
            }
        }
        at.map(|at| Self {
            window,
            piece,
            at,
            lines,
        })
    }
}

/// A maximal visible interval of a piece.
#[derive(Clone, Debug)]
pub struct Fragment {
    /// The piece.
    pub piece: PieceId,
    /// From where to where, from the smaller end.
    pub at: [Ratio; 2],
    /// A line that sees it: it leaves through a window, meets the piece within the fragment and
    /// touches no other segment on the way.
    pub witness: PlanLine,
    /// The window of the witness.
    pub window: u32,
}

/// Unites the funnels of each piece to fragments; sorts them by piece. `middle` gives a line strictly inside
/// a funnel that touches nothing on its way.
pub(super) fn fragments(
    funnels: &mut [Funnel],
    middle: impl Fn(&Funnel) -> PlanLine,
) -> Vec<Fragment> {
    funnels.sort_by(|f, g| (f.piece, &f.at, f.window).cmp(&(g.piece, &g.at, g.window)));
    let mut out: Vec<Fragment> = Vec::new();
    let mut widest = 0.0;
    for funnel in funnels.iter() {
        let [low, high] = &funnel.at;
        let width = high.value() - low.value();
        match out.last_mut() {
            Some(last) if last.piece == funnel.piece && *low <= last.at[1] => {
                if *high > last.at[1] {
                    last.at[1] = high.clone();
                }
                if width > widest {
                    widest = width;
                    (last.witness, last.window) = (middle(funnel), funnel.window);
                }
            }
            _ => {
                widest = width;
                out.push(Fragment {
                    piece: funnel.piece,
                    at: funnel.at.clone(),
                    witness: middle(funnel),
                    window: funnel.window,
                });
            }
        }
    }
    out
}

/// Visits the blocked parts of some pieces of line space.
pub(super) fn blocked<S: LineSpace>(
    space: &mut S,
    tree: &OcclusionTree<S::Plane>,
    roots: Vec<S::Piece>,
    mut visit: impl FnMut(&S, &S::Piece, Occluder),
) where
    S::Plane: Copy + Eq,
{
    for root in roots {
        tree.visit_with(space, Slot::Root, root, |space, leaf, piece| {
            if let Leaf::Blocked(occluder) = leaf {
                visit(space, &piece, occluder);
            }
            space.discard(piece);
        });
    }
}

/// Visits the parts of a piece on which an occluder that is not in the tree would come first
/// [Bittner02, 6.5.3].
pub(super) fn unblocked<S: DepthSpace>(
    space: &mut S,
    tree: &OcclusionTree<S::Plane>,
    piece: S::Piece,
    occluder: Occluder,
    mut visit: impl FnMut(&S::Piece),
) {
    let mut reached = Vec::new();
    tree.visit(space, Slot::Root, piece, |leaf, piece| {
        reached.push((leaf, piece))
    });
    for (leaf, piece) in reached {
        let old = match leaf {
            Leaf::Outside => continue,
            Leaf::Open => {
                visit(&piece);
                continue;
            }
            Leaf::Blocked(old) => old,
        };
        match space.order(&piece, occluder, old) {
            Order::Behind => {}
            Order::InFront => visit(&piece),
            Order::Crossing(plane, front) => match space.cut(piece, plane, Wall::NONE) {
                Cut::Whole(half, piece) if half == front => visit(&piece),
                Cut::Whole(..) => {}
                Cut::Parts([negative, positive]) => visit(match front {
                    Half::Negative => &negative,
                    Half::Positive => &positive,
                }),
            },
        }
    }
}
