//! Visits: all leaves with their cells, or those where a ray lies.

use super::{Child, Leaf, OcclusionTree, Slot, TreeNode};
use crate::line_space::{Cut, LineSpace, Wall};

impl<P: Copy + Eq> OcclusionTree<P> {
    /// Visits the part of a piece in every leaf below a slot that it meets, exactly: with the piece
    /// of the slot itself, all cells of the tree. A facet that a node made has the node's number as
    /// its wall.
    pub fn visit<S>(
        &self,
        space: &mut S,
        slot: Slot,
        piece: S::Piece,
        mut visitor: impl FnMut(Leaf, S::Piece),
    ) where
        S: LineSpace<Plane = P>,
    {
        self.visit_with(space, slot, piece, |_, leaf, piece| visitor(leaf, piece));
    }

    /// As [`OcclusionTree::visit`]; the visitor gets the space, too, to look at pieces and to take them back.
    pub fn visit_with<S>(
        &self,
        space: &mut S,
        slot: Slot,
        piece: S::Piece,
        mut visitor: impl FnMut(&mut S, Leaf, S::Piece),
    ) where
        S: LineSpace<Plane = P>,
    {
        let mut stack = vec![(self.child(slot), piece)];
        while let Some((child, piece)) = stack.pop() {
            match child {
                Child::Leaf(leaf) => visitor(space, leaf, piece),
                Child::Node(node) => {
                    let TreeNode { plane, children } = self.nodes[node as usize];
                    match space.cut(piece, plane, Wall(node)) {
                        Cut::Whole(half, piece) => stack.push((children[half.index()], piece)),
                        Cut::Parts([negative, positive]) => {
                            stack.push((children[1], positive));
                            stack.push((children[0], negative));
                        }
                    }
                }
            }
        }
    }

    /// A leaf whose closed cell holds a ray: one way down, on a hyperplane to its positive side.
    pub fn leaf_at<S>(&self, space: &S, ray: &S::Ray) -> Leaf
    where
        S: LineSpace<Plane = P>,
    {
        let mut child = self.root;
        loop {
            match child {
                Child::Leaf(leaf) => return leaf,
                Child::Node(node) => {
                    let TreeNode { plane, children } = self.nodes[node as usize];
                    let positive = !space.sign(plane, ray).is_negative();
                    child = children[usize::from(positive)];
                }
            }
        }
    }

    /// Visits the leaves whose closed cells a ray lies in: one, or the neighbors around a border.
    pub fn visit_at<S>(&self, space: &S, ray: &S::Ray, mut visitor: impl FnMut(Leaf))
    where
        S: LineSpace<Plane = P>,
    {
        let mut stack = vec![self.root];
        while let Some(child) = stack.pop() {
            match child {
                Child::Leaf(leaf) => visitor(leaf),
                Child::Node(node) => {
                    let TreeNode { plane, children } = self.nodes[node as usize];
                    let sign = space.sign(plane, ray);
                    if !sign.is_negative() {
                        stack.push(children[1]);
                    }
                    if !sign.is_positive() {
                        stack.push(children[0]);
                    }
                }
            }
        }
    }
}
