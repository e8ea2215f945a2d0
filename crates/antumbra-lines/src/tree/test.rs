//! Tests: whether an occluder or a region would be seen, exactly or without splitting.

use super::{Child, Leaf, OcclusionTree, STACK, Slot, Visibility};
use crate::line_space::{DepthSpace, Half, LineSpace, Occluder, Order, Position};

impl<P: Copy + Eq> OcclusionTree<P> {
    /// Whether an occluder would be seen, were it inserted. Exact; stops as soon as the answer is
    /// *partial*.
    pub fn test<S>(&self, space: &mut S, piece: S::Piece, occluder: Occluder) -> Visibility
    where
        S: DepthSpace<Plane = P>,
    {
        self.test_at(space, piece, occluder, 0)
    }

    /// As [`OcclusionTree::test`], for an occluder that is nowhere nearer than `near`.
    pub fn test_at<S>(
        &self,
        space: &mut S,
        piece: S::Piece,
        occluder: Occluder,
        near: u32,
    ) -> Visibility
    where
        S: DepthSpace<Plane = P>,
    {
        self.test_region_at(space, piece, near, |space, piece, old| {
            match space.order(piece, occluder, old) {
                Order::Behind => Visibility::Invisible,
                Order::InFront => Visibility::Full,
                Order::Crossing(..) => Visibility::Partial,
            }
        })
    }

    /// Whether a region can be seen that is met by the lines of a piece. At a blocked leaf `judge`
    /// decides, for the part of the piece in that leaf. The piece is split; exact as far as `judge`
    /// is.
    pub fn test_region<S>(
        &self,
        space: &mut S,
        piece: S::Piece,
        judge: impl FnMut(&mut S, &S::Piece, Occluder) -> Visibility,
    ) -> Visibility
    where
        S: LineSpace<Plane = P>,
    {
        self.test_region_at(space, piece, 0, judge)
    }

    /// As [`OcclusionTree::test_region`], for a region that is nowhere nearer than `near`: where nothing as far away
    /// is seen, the region is not, and the tree is not entered.
    pub fn test_region_at<S>(
        &self,
        space: &mut S,
        piece: S::Piece,
        near: u32,
        mut judge: impl FnMut(&mut S, &S::Piece, Occluder) -> Visibility,
    ) -> Visibility
    where
        S: LineSpace<Plane = P>,
    {
        let mut result = None;
        let mut stack = Vec::with_capacity(STACK);
        stack.push((Slot::Root, piece));
        while let Some((slot, piece)) = stack.pop() {
            let state = match self.child(slot) {
                _ if self.reach(slot) < near => Visibility::Invisible,
                Child::Node(node) => {
                    self.part(space, node, piece, &mut stack);
                    continue;
                }
                Child::Leaf(Leaf::Open) => Visibility::Full,
                Child::Leaf(Leaf::Outside) => Visibility::Invisible,
                Child::Leaf(Leaf::Blocked(old)) => judge(space, &piece, old),
            };
            space.discard(piece);
            let combined = result.map_or(state, |r: Visibility| r.and(state));
            if combined == Visibility::Partial {
                stack
                    .into_iter()
                    .for_each(|(_, piece)| space.discard(piece));
                return Visibility::Partial;
            }
            result = Some(combined);
        }
        result.unwrap_or(Visibility::Invisible)
    }

    /// Whether a region may be seen: [Bittner02, 4.10]. The piece is never split, so leaves that it
    /// only seems to reach are asked, too: *invisible* is always right, the other two states may be
    /// too good. Stops at the first leaf that is not invisible.
    pub fn test_without_splitting<S>(
        &self,
        space: &S,
        piece: &S::Piece,
        hidden_behind: impl FnMut(Occluder) -> bool,
    ) -> Visibility
    where
        S: LineSpace<Plane = P>,
    {
        self.test_without_splitting_at(space, piece, 0, hidden_behind)
    }

    /// As [`OcclusionTree::test_without_splitting`], for a region that is nowhere nearer than `near`.
    pub fn test_without_splitting_at<S>(
        &self,
        space: &S,
        piece: &S::Piece,
        near: u32,
        mut hidden_behind: impl FnMut(Occluder) -> bool,
    ) -> Visibility
    where
        S: LineSpace<Plane = P>,
    {
        let mut stack = Vec::with_capacity(STACK);
        stack.push(Slot::Root);
        while let Some(slot) = stack.pop() {
            match self.child(slot) {
                _ if self.reach(slot) < near => {}
                Child::Node(node) => {
                    let plane = self.nodes[node as usize].plane;
                    match space.position(piece, plane) {
                        Position::In(half) => stack.push(Slot::Side(node, half)),
                        Position::Both => stack.extend([
                            Slot::Side(node, Half::Positive),
                            Slot::Side(node, Half::Negative),
                        ]),
                    }
                }
                Child::Leaf(Leaf::Outside) => {}
                Child::Leaf(Leaf::Open) => return Visibility::Partial,
                Child::Leaf(Leaf::Blocked(old)) => {
                    if !hidden_behind(old) {
                        return Visibility::Partial;
                    }
                }
            }
        }
        Visibility::Invisible
    }
}
