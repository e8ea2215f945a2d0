//! The occlusion tree: a binary space partition of line space whose leaves say *open* or *blocked*.
//!
//! After [Bittner02, 3.3, 4.10 and 5.4]. Differs in that a leaf keeps no fragment: where a late
//! occluder is in front, its borders cut the leaf, and what is outside stays blocked by the old one.
//! So nothing but the new occluder is ever split, and the cells are made once, when asked for.
//! Facets that lie on a hyperplane of the way from the root are never inserted again.

use crate::line_space::{Cut, DepthSpace, Half, LineSpace, Occluder, Order, Position, Wall};

/// What a leaf says about its lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaf {
    /// No occluder was met.
    Open,
    /// These lines do not belong to the problem; nothing is inserted here.
    Outside,
    /// The occluder that comes first on all of them.
    Blocked(Occluder),
}

/// The three states of a test [Bittner02, Table 3.1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// No open set of lines is free.
    Invisible,
    /// Some lines are free.
    Partial,
    /// All lines are free.
    Full,
}

impl Visibility {
    /// The state of the union of two fragments.
    #[inline]
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        if self == other { self } else { Self::Partial }
    }
}

/// A child of a node: another node, or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// The node with this number.
    Node(u32),
    /// A leaf.
    Leaf(Leaf),
}

/// A hyperplane and what lies on its two sides, negative first.
#[derive(Clone, Copy, Debug)]
pub struct TreeNode<P> {
    /// The hyperplane.
    pub plane: P,
    /// Negative side, positive side.
    pub children: [Child; 2],
}

/// A place in the tree that holds a child: the root, or one side of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The root.
    Root,
    /// A side of a node.
    Side(u32, Half),
}

/// Room for what waits in a walk: it grows where trees are deeper.
const STACK: usize = 32;

/// An occlusion tree over the lines of some space.
#[derive(Clone, Debug)]
pub struct OcclusionTree<P> {
    nodes: Vec<TreeNode<P>>,
    root: Child,
    /// For each node how far one sees at most below it [Bittner02, 6.5.5].
    depths: Vec<Depth>,
}

/// The maximal visibility distances on both sides of a node, and the slot that holds it.
#[derive(Clone, Copy, Debug)]
struct Depth {
    above: Slot,
    reach: [u32; 2],
}

impl<P: Copy + Eq> Default for OcclusionTree<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Copy + Eq> OcclusionTree<P> {
    /// A tree in which every line is open.
    #[must_use]
    pub fn new() -> Self {
        Self {
            nodes: Vec::new(),
            root: Child::Leaf(Leaf::Open),
            depths: Vec::new(),
        }
    }

    /// All nodes; a node comes before those below it.
    #[must_use]
    pub fn nodes(&self) -> &[TreeNode<P>] {
        &self.nodes
    }

    /// What a slot holds.
    ///
    /// # Panics
    /// If there is no such node.
    #[inline]
    #[must_use]
    pub fn child(&self, slot: Slot) -> Child {
        match slot {
            Slot::Root => self.root,
            Slot::Side(node, half) => self.nodes[node as usize].children[half.index()],
        }
    }

    /// How many leaves are blocked, open and outside.
    #[must_use]
    pub fn leaf_counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        let children = self.nodes.iter().flat_map(|n| n.children);
        for child in children.chain([self.root]) {
            match child {
                Child::Leaf(Leaf::Blocked(_)) => counts[0] += 1,
                Child::Leaf(Leaf::Open) => counts[1] += 1,
                Child::Leaf(Leaf::Outside) => counts[2] += 1,
                Child::Node(_) => {}
            }
        }
        counts
    }

    /// Cuts every open leaf by a hyperplane, before anything is inserted: the frame of a problem
    /// whose lines do not fit into one convex piece.
    pub fn partition(&mut self, plane: P) {
        let open: Vec<Slot> = self.slots().filter(|&s| self.is_open(s)).collect();
        for slot in open {
            self.put_node(slot, plane, [(Leaf::Open, u32::MAX); 2]);
        }
    }

    /// Restricts the open leaves to one side of a hyperplane; beyond it is outside.
    pub fn restrict(&mut self, plane: P, side: Half) {
        let open: Vec<Slot> = self.slots().filter(|&s| self.is_open(s)).collect();
        for slot in open {
            let mut leaves = [(Leaf::Outside, 0); 2];
            leaves[side.index()] = (Leaf::Open, u32::MAX);
            self.put_node(slot, plane, leaves);
        }
    }

    fn is_open(&self, slot: Slot) -> bool {
        self.child(slot) == Child::Leaf(Leaf::Open)
    }

    /// All slots: the root, then both sides of each node.
    fn slots(&self) -> impl Iterator<Item = Slot> + use<P> {
        let sides = (0..self.nodes.len() as u32)
            .flat_map(|n| [Half::Negative, Half::Positive].map(|h| Slot::Side(n, h)));
        [Slot::Root].into_iter().chain(sides)
    }

    fn put(&mut self, slot: Slot, child: Child) {
        match slot {
            Slot::Root => self.root = child,
            Slot::Side(node, half) => self.nodes[node as usize].children[half.index()] = child,
        }
    }

    /// Puts a node in the place of a leaf: its leaves, and how far one sees in them.
    fn put_node(&mut self, slot: Slot, plane: P, leaves: [(Leaf, u32); 2]) -> u32 {
        let node = self.nodes.len() as u32;
        let children = leaves.map(|(leaf, _)| Child::Leaf(leaf));
        self.nodes.push(TreeNode { plane, children });
        self.depths.push(Depth {
            above: slot,
            reach: leaves.map(|(_, reach)| reach),
        });
        self.put(slot, Child::Node(node));
        node
    }

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
                Child::Node(node) => {
                    let plane = self.nodes[node as usize].plane;
                    match space.cut(piece, plane, Wall(node)) {
                        Cut::Whole(half, piece) => stack.push((Slot::Side(node, half), piece)),
                        Cut::Parts([negative, positive]) => {
                            stack.push((Slot::Side(node, Half::Positive), positive));
                            stack.push((Slot::Side(node, Half::Negative), negative));
                        }
                    }
                }
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

    /// How far one sees through a slot at most.
    #[inline]
    fn reach(&self, slot: Slot) -> u32 {
        match slot {
            Slot::Root => u32::MAX,
            Slot::Side(node, half) => self.depths[node as usize].reach[half.index()],
        }
    }

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
                    let plane = self.nodes[node as usize].plane;
                    match space.cut(piece, plane, Wall(node)) {
                        Cut::Whole(half, piece) => stack.push((Slot::Side(node, half), piece)),
                        Cut::Parts([negative, positive]) => {
                            stack.push((Slot::Side(node, Half::Positive), positive));
                            stack.push((Slot::Side(node, Half::Negative), negative));
                        }
                    }
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
