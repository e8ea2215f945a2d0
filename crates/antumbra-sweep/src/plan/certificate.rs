//! The certificate of a view, from the trees that made it.

use antumbra_lines::{Child, Leaf, OcclusionTree, Plane3};

use super::PlanView;
use super::region::RegionLines;
use super::sweep::Source as _;
use crate::proof::{PlanProof, PlanProofChild, PlanProofFragment, PlanProofNode, PlanProofTree};

/// The tree of each window, with points for hyperplanes and pieces for occluders.
pub(super) fn trees(source: &RegionLines, trees: &[OcclusionTree<Plane3>]) -> Vec<PlanProofTree> {
    let child = |c: Child| match c {
        Child::Node(n) => PlanProofChild::Node(n),
        Child::Leaf(Leaf::Blocked(o)) => PlanProofChild::Blocked(source.depth_key(o)),
        Child::Leaf(_) => PlanProofChild::Open,
    };
    let one = |tree: &OcclusionTree<Plane3>| PlanProofTree {
        root: child(tree.child(antumbra_lines::Slot::Root)),
        nodes: tree
            .nodes()
            .iter()
            .map(|n| PlanProofNode {
                point: source.point_of(n.plane),
                children: n.children.map(child),
            })
            .collect(),
    };
    let made: Vec<PlanProofTree> = trees.iter().map(one).collect();
    (0..source.windows().len())
        .map(|w| made[source.tree_of(w)].clone())
        .collect()
}

pub(super) fn proof(view: &PlanView, trees: Vec<PlanProofTree>) -> PlanProof {
    let windows = view.windows.iter().map(|w| [w.a, w.b]).zip(trees);
    let fragments = view.fragments.iter().map(|f| PlanProofFragment {
        piece: f.piece.0,
        at: [f.at[0].parts(), f.at[1].parts()],
        line: f.witness.big(),
        window: f.window,
    });
    PlanProof {
        cell: view.cell.corners().to_vec(),
        windows: windows.collect(),
        touching: view.touching.iter().map(|p| p.0).collect(),
        fragments: fragments.collect(),
    }
}
