//! What nodes of the hierarchy remember from frame to frame, and from their neighbors.
//!
//! After [Bittner02, 4.11]: hierarchy updating, conservative hierarchy updating, visibility propagation
//! along ropes; the probabilities of the last two can follow what was seen to change [Bittner02, 9.2.2].

use antumbra_scene::{BoxFace, KdBox, KdTree, Ropes};

use super::hierarchy::{Bounds, Hierarchy};
use super::options::Probability;
use super::sweep::Pass;

/// What is known of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// Outside the frustum.
    Outside,
    /// Nothing of it is seen.
    Invisible,
    /// Something of it may be seen: an inner node is open.
    Visible,
    /// Not asked: all its objects were known to be visible.
    Passed,
}

/// So many frames a node waits after a test in vain. 2 to 8 save the same at walking speed; 64 saves 3 %
/// less where much changes, 1 tests in vain again.
const VAIN: u8 = 4;

#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    /// The frame of the state.
    pub frame: u32,
    pub state: State,
    /// Children known to be invisible in this frame.
    pub hidden_children: u8,
    /// Whether propagation found the state.
    pub propagated: bool,
    /// Whether its own test was made in this frame.
    pub tested: bool,
    /// The frame of the last first look at which an inner node was open, or as good as open.
    pub opened: u32,
    /// For how many frames its own test is not worth making: it failed although all children are
    /// hidden, and would be made again and again.
    pub stubborn: u8,
}

impl Memory {
    pub(super) const NEW: Self = Self {
        frame: 0,
        state: State::Visible,
        hidden_children: 0,
        propagated: false,
        tested: false,
        opened: 0,
        stubborn: 0,
    };
}

impl Memory {
    /// What stays known of a node that a look has found in some state. The second look leaves alone
    /// what the next frame's first one needs.
    pub(super) fn carried(self, state: State, pass: Pass, looked: u32, frame: u32) -> Self {
        let open = match state {
            State::Visible => true,
            // One that was passed by is as it was.
            State::Passed => self.opened == looked,
            State::Outside | State::Invisible => false,
        };
        match pass {
            Pass::Second => self,
            Pass::First if open => Self {
                opened: frame,
                ..self
            },
            Pass::First => Self {
                opened: 0,
                stubborn: 0,
                ..self
            },
        }
    }

    /// All children are hidden, so the node is. In the next frame it is tested itself, and hides them at
    /// once: unless it was, in vain.
    pub(super) fn close(&mut self, pass: Pass) {
        self.state = State::Invisible;
        if pass == Pass::Second {
            return;
        }
        self.stubborn = if self.tested {
            VAIN
        } else {
            self.stubborn.saturating_sub(1)
        };
        self.opened = if self.stubborn > 0 { self.frame } else { 0 };
    }
}

/// A probability that may follow the rate of successes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chance {
    value: f64,
    tuned: bool,
}

impl Chance {
    pub(super) fn new(probability: Option<Probability>) -> Self {
        match probability {
            None => Self {
                value: 0.0,
                tuned: false,
            },
            Some(Probability::Fixed(value)) => Self {
                value,
                tuned: false,
            },
            Some(Probability::SelfTuned) => Self {
                value: 0.5,
                tuned: true,
            },
        }
    }

    pub(super) fn value(&self) -> f64 {
        self.value
    }

    /// Takes an outcome into account: moves a thirtieth of the way, within 0.05 and 0.95, so that it
    /// goes on learning.
    pub(super) fn learn(&mut self, success: bool) {
        if self.tuned {
            let goal = if success { 0.95 } else { 0.05 };
            self.value += (goal - self.value) / 30.0;
        }
    }
}

/// Visibility propagation.
pub(super) struct Propagation {
    ropes: Ropes,
    stack: Vec<KdBox>,
}

impl Propagation {
    pub(super) fn new(kd: &KdTree) -> Self {
        Self {
            ropes: Ropes::new(kd),
            stack: Vec::with_capacity(4 * kd.depth() + 64),
        }
    }

    /// Whether a node's cell is hidden because everything beyond its faces that look at the eye is: a
    /// line from the eye enters the cell through one of them.
    ///
    /// The states must be those of cells, not of the tight boxes in them.
    pub(super) fn hides(
        &mut self,
        kd: &KdTree,
        hierarchy: &Hierarchy,
        memory: &[Memory],
        node: u32,
        eye: [f64; 3],
        frame: u32,
    ) -> bool {
        let here = hierarchy.cells[node as usize];
        let cell = Bounds::of(&here.bounds);
        let mut any = false;
        for face in BoxFace::ALL {
            let k = face.axis as usize;
            let looks = if face.upper {
                eye[k] > cell.high[k]
            } else {
                eye[k] < cell.low[k]
            };
            if !looks {
                continue;
            }
            any = true;
            let Some(beyond) = self.ropes.beyond(here.node, face) else {
                return false;
            };
            let flat = face.of(&here.bounds);
            self.stack.clear();
            self.stack.push(beyond);
            while let Some(other) = self.stack.pop() {
                if !other.bounds.touches(&flat) {
                    continue;
                }
                let number = hierarchy.of_kd[other.node as usize];
                match state_above(hierarchy, memory, number, frame) {
                    Some(State::Invisible | State::Outside) => continue,
                    None | Some(State::Passed) => return false,
                    Some(State::Visible) => {}
                }
                let inner = hierarchy.nodes[number as usize].children.is_some();
                match kd.children(&other).filter(|_| inner) {
                    Some(children) if self.stack.len() + 2 <= self.stack.capacity() => {
                        self.stack.extend(children);
                    }
                    _ => return false,
                }
            }
        }
        any
    }
}

/// The state of a node in this frame: its own, or an invisible one above where the sweep ended.
fn state_above(
    hierarchy: &Hierarchy,
    memory: &[Memory],
    mut node: u32,
    frame: u32,
) -> Option<State> {
    loop {
        let Memory {
            frame: last, state, ..
        } = memory[node as usize];
        if last == frame {
            return Some(state);
        }
        let parent = hierarchy.nodes[node as usize].parent;
        if parent == node {
            return None;
        }
        node = parent;
        // An open node above says nothing of a child that was not visited.
        let Memory {
            frame: last, state, ..
        } = memory[node as usize];
        if last == frame && state == State::Visible {
            return None;
        }
    }
}
