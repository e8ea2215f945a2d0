//! Inserting occluders: down to the leaves, where the depth order decides.

use super::{Child, Leaf, OcclusionTree, STACK, Slot};
use crate::line_space::{Cut, DepthSpace, Half, LineSpace, Occluder, Order, Wall};

impl<P: Copy + Eq> OcclusionTree<P> {
    /// Inserts an occluder with the piece of lines that it blocks. Where it is behind what is there,
    /// nothing changes; where it is in front, it takes the lines over.
    ///
    /// Returns whether any line is its own now. Every sign is exact.
    pub fn insert<S>(&mut self, space: &mut S, piece: S::Piece, occluder: Occluder) -> bool
    where
        S: DepthSpace<Plane = P>,
    {
        self.insert_at(space, piece, occluder, 0, |_, _| u32::MAX)
    }

    /// As [`OcclusionTree::insert`], for an occluder that is nowhere nearer than `near`: parts of the tree that see
    /// nothing as far away are not entered. `far` tells how far the occluder is at most on the lines of a piece.
    pub fn insert_at<S>(
        &mut self,
        space: &mut S,
        piece: S::Piece,
        occluder: Occluder,
        near: u32,
        far: impl Fn(&S, &S::Piece) -> u32,
    ) -> bool
    where
        S: DepthSpace<Plane = P>,
    {
        let mut seen = false;
        let mut stack = Vec::with_capacity(STACK);
        stack.push((Slot::Root, piece));
        while let Some((slot, piece)) = stack.pop() {
            let reach = self.reach(slot);
            if reach < near {
                space.discard(piece);
                continue;
            }
            match self.child(slot) {
                Child::Node(node) => self.part(space, node, piece, &mut stack),
                Child::Leaf(Leaf::Outside) => space.discard(piece),
                Child::Leaf(Leaf::Open) => {
                    let far = far(space, &piece);
                    self.plant(space, slot, piece, (occluder, far), (Leaf::Open, reach));
                    seen = true;
                }
                Child::Leaf(Leaf::Blocked(old)) => {
                    if let Some(front) = in_front(space, piece, occluder, old) {
                        let far = far(space, &front).min(reach);
                        let around = (Leaf::Blocked(old), reach);
                        self.plant(space, slot, front, (occluder, far), around);
                        seen = true;
                    }
                }
            }
        }
        seen
    }

    /// Replaces a leaf by the elementary tree of a piece inside it.
    fn plant<S>(
        &mut self,
        space: &mut S,
        mut slot: Slot,
        piece: S::Piece,
        (occluder, far): (Occluder, u32),
        around: (Leaf, u32),
    ) where
        S: LineSpace<Plane = P>,
    {
        for facet in space.facets(&piece).filter(|f| f.wall.is_none()) {
            let node = self.put_node(slot, facet.plane, [around; 2]);
            slot = Slot::Side(node, facet.side);
        }
        self.put(slot, Child::Leaf(Leaf::Blocked(occluder)));
        space.discard(piece);
        self.settle(slot, far);
    }

    /// Brings the visibility distances above a slot up to date.
    fn settle(&mut self, mut slot: Slot, mut reach: u32) {
        while let Slot::Side(node, half) = slot {
            let depth = &mut self.depths[node as usize];
            if depth.reach[half.index()] == reach {
                return;
            }
            depth.reach[half.index()] = reach;
            reach = depth.reach[0].max(depth.reach[1]);
            slot = depth.above;
        }
    }
}

/// The part of a piece in which the new occluder comes first; `None` if there is none.
fn in_front<S: DepthSpace>(
    space: &mut S,
    piece: S::Piece,
    new: Occluder,
    old: Occluder,
) -> Option<S::Piece> {
    match space.order(&piece, new, old) {
        Order::Behind => {
            space.discard(piece);
            None
        }
        Order::InFront => Some(piece),
        Order::Crossing(plane, front) => match space.cut(piece, plane, Wall::NONE) {
            Cut::Whole(half, piece) if half == front => Some(piece),
            Cut::Whole(_, piece) => {
                space.discard(piece);
                None
            }
            Cut::Parts([negative, positive]) => {
                let (keep, drop) = match front {
                    Half::Negative => (negative, positive),
                    Half::Positive => (positive, negative),
                };
                space.discard(drop);
                Some(keep)
            }
        },
    }
}
