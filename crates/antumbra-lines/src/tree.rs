//! The occlusion tree: a binary space partition of line space whose leaves say *open* or *blocked*.
//!
//! After [Bittner02, 3.3, 4.10 and 5.4]. Differs in that a leaf keeps no fragment: where a late
//! occluder is in front, its borders cut the leaf, and what is outside stays blocked by the old one.
//! So nothing but the new occluder is ever split, and the cells are made once, when asked for.
//! Facets that lie on a hyperplane of the way from the root are never inserted again.

mod insert;
mod test;
mod visit;

use crate::line_space::{Cut, Half, LineSpace, Occluder, Wall};

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

    /// Puts the parts of a piece on both sides of a node on a stack, the negative one on top.
    #[inline]
    fn part<S>(&self, space: &mut S, node: u32, piece: S::Piece, stack: &mut Vec<(Slot, S::Piece)>)
    where
        S: LineSpace<Plane = P>,
    {
        let plane = self.nodes[node as usize].plane;
        match space.cut(piece, plane, Wall(node)) {
            Cut::Whole(half, piece) => stack.push((Slot::Side(node, half), piece)),
            Cut::Parts([negative, positive]) => {
                stack.push((Slot::Side(node, Half::Positive), positive));
                stack.push((Slot::Side(node, Half::Negative), negative));
            }
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

    /// How far one sees through a slot at most.
    #[inline]
    fn reach(&self, slot: Slot) -> u32 {
        match slot {
            Slot::Root => u32::MAX,
            Slot::Side(node, half) => self.depths[node as usize].reach[half.index()],
        }
    }
}
