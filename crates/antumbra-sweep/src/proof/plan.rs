//! The certificate of what a cell of the plane sees: the occlusion trees, and a line for each fragment.
//!
//! Nothing in it has to be believed. A tree only says *where to cut* the lines of a hidden segment, and which
//! segment is in front of each part; that it is, the checker decides from coordinates.

use antumbra_kernel::Point2;
use dashu_int::IBig;

/// What a child of a proof's node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanProofChild {
    /// Another node.
    Node(u32),
    /// Nothing is claimed of these lines.
    Open,
    /// This piece comes first.
    Blocked(u32),
}

/// A cut of line space: lines that have a point on their right, and on their left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanProofNode {
    /// The point, homogeneous.
    pub point: [i128; 3],
    /// What follows for lines with the point on their right, on their left.
    pub children: [PlanProofChild; 2],
}

/// A tree of cuts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanProofTree {
    /// Where it begins.
    pub root: PlanProofChild,
    /// Its nodes; children come after their parents.
    pub nodes: Vec<PlanProofNode>,
}

/// A visible fragment and a line that sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanProofFragment {
    /// The piece.
    pub piece: u32,
    /// From where to where: numerators and positive denominators.
    pub at: [(IBig, IBig); 2],
    /// The line `a x + b y + c`, positive on its left.
    pub line: [IBig; 3],
    /// The window that it leaves through.
    pub window: u32,
}

/// The certificate of one convex cell with corners in counter-clockwise order, or of a segment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanProof {
    /// The corners of the cell.
    pub cell: Vec<Point2>,
    /// The parts of its edges through which lines leave, each with its tree.
    pub windows: Vec<([Point2; 2], PlanProofTree)>,
    /// Pieces that meet the cell.
    pub touching: Vec<u32>,
    /// All visible fragments of the others, by piece.
    pub fragments: Vec<PlanProofFragment>,
}
