//! What is still undecided, object by object and node by node.
//!
//! States are kept in the order of the target hierarchy, so that hiding a node fills a range, and
//! every node counts what is decided below it, so that its box is at hand until something is.

use antumbra_kernel::Aabb;
use antumbra_scene::{ObjectId, TargetKind, TargetTree};

/// What is known of an object so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Undecided,
    Visible,
    Hidden,
    Unknown,
    /// The source itself, or an object without polygons.
    Absent,
}

/// A side of a plane across an axis: `sign * coordinate > bound`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond {
    pub axis: usize,
    pub positive: bool,
    pub bound: i64,
}

impl Beyond {
    /// The nearest and the farthest coordinate of a box along the axis, signed.
    pub(super) fn span(&self, bounds: &Aabb) -> (i64, i64) {
        let lo = bounds.min.to_i64()[self.axis];
        let hi = bounds.max.to_i64()[self.axis];
        if self.positive { (lo, hi) } else { (-hi, -lo) }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Live<'a> {
    tree: &'a TargetTree,
    /// By place.
    states: Vec<State>,
    /// By node; nodes below a hidden one are out of date.
    decided: Vec<u32>,
}

impl<'a> Live<'a> {
    /// Everything undecided but the absent objects.
    pub(super) fn new(
        tree: &'a TargetTree,
        objects: usize,
        absent: impl IntoIterator<Item = ObjectId>,
    ) -> Self {
        let mut live = Self {
            tree,
            states: vec![State::Undecided; objects],
            decided: vec![0; tree.node_count()],
        };
        for id in absent {
            live.set(id, State::Absent);
        }
        live
    }

    /// Everything absent but one object.
    pub(super) fn only(tree: &'a TargetTree, objects: usize, id: ObjectId) -> Self {
        let mut live = Self {
            tree,
            states: vec![State::Absent; objects],
            decided: vec![0; tree.node_count()],
        };
        live.states[tree.place(id)] = State::Undecided;
        live
    }

    pub(super) fn state(&self, id: ObjectId) -> State {
        self.states[self.tree.place(id)]
    }

    pub(super) fn undecided(&self, id: ObjectId) -> bool {
        self.state(id) == State::Undecided
    }

    /// Decides an object.
    pub(super) fn set(&mut self, id: ObjectId, state: State) {
        let place = self.tree.place(id);
        let before = std::mem::replace(&mut self.states[place], state);
        if before == State::Undecided
            && let Some(root) = self.tree.object_root(id)
        {
            self.count(root, 1);
        }
    }

    /// Counts newly decided objects at a node and above.
    fn count(&mut self, mut index: u32, more: u32) {
        loop {
            self.decided[index as usize] += more;
            let parent = self.tree.node(index).parent;
            if parent == index {
                return;
            }
            index = parent;
        }
    }

    /// Hides everything undecided below a node.
    pub(super) fn hide(&mut self, index: u32) {
        let places = self.tree.node(index).places();
        let mut more = 0;
        for state in &mut self.states[places] {
            if *state == State::Undecided {
                *state = State::Hidden;
                more += 1;
            }
        }
        self.count(index, more);
    }

    /// Hides everything undecided below a node that lies beyond a plane.
    pub(super) fn hide_beyond(&mut self, index: u32, beyond: &Beyond) {
        let node = self.tree.node(index);
        let (near, far) = beyond.span(&node.bounds);
        if near > beyond.bound {
            self.hide(index);
        } else if far > beyond.bound
            && node.object.is_none()
            && let TargetKind::Inner(a, b) = node.kind
        {
            self.hide_beyond(a, beyond);
            self.hide_beyond(b, beyond);
        }
    }

    /// How many objects below a node are undecided.
    pub(super) fn left(&self, index: u32) -> u32 {
        self.tree.node(index).count - self.decided[index as usize]
    }

    /// The box around everything undecided below a node of whole objects.
    pub(super) fn bounds(&self, index: u32) -> Option<Aabb> {
        let node = self.tree.node(index);
        match (self.left(index), node.kind) {
            (0, _) => None,
            (left, _) if left == node.count => Some(node.bounds),
            (_, TargetKind::Inner(a, b)) => union(self.bounds(a), self.bounds(b)),
            (_, TargetKind::Polygon(_)) => None,
        }
    }

    /// The box around everything undecided below a node that lies beyond a plane, and how many
    /// objects that are.
    pub(super) fn bounds_beyond(&self, index: u32, beyond: &Beyond) -> (Option<Aabb>, u32) {
        let node = self.tree.node(index);
        let (near, far) = beyond.span(&node.bounds);
        if self.left(index) == 0 || far <= beyond.bound {
            return (None, 0);
        }
        if near > beyond.bound {
            return (self.bounds(index), self.left(index));
        }
        match node.kind {
            TargetKind::Inner(a, b) if node.object.is_none() => {
                let (first, n) = self.bounds_beyond(a, beyond);
                let (second, m) = self.bounds_beyond(b, beyond);
                (union(first, second), n + m)
            }
            _ => (None, 0),
        }
    }

    /// The objects that are neither visible, hidden nor absent, in the order of their ids.
    pub(super) fn open(&self) -> Vec<ObjectId> {
        let mut open: Vec<ObjectId> = self
            .states
            .iter()
            .enumerate()
            .filter(|(_, s)| matches!(s, State::Undecided | State::Unknown))
            .map(|(place, _)| self.tree.object_at(place))
            .collect();
        open.sort_unstable();
        open
    }
}

fn union(a: Option<Aabb>, b: Option<Aabb>) -> Option<Aabb> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (a, b) => a.or(b),
    }
}
