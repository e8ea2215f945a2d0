//! How the last frame classified space, and what a moving thing is to it.

use super::Culler;
use super::coherence::State;
use super::hierarchy::Bounds;
use super::options::{LeafTest, Method};
use super::tree::ROOT;

/// What the last frame found out about a cell of space [Bittner02, Figure 4.17].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellState {
    /// Outside the frustum, or not asked.
    Outside,
    /// Nothing of it can be seen.
    Invisible,
    /// The same, found along ropes.
    Propagated,
    /// Something may be seen.
    Partial,
    /// No occluder in the tree is before any of it.
    Full,
}

/// A leaf of the hierarchy in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Smallest coordinates.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
    /// Its state.
    pub state: CellState,
}

impl Culler {
    /// Whether something in a box, in scene units, may be seen in the last frame: for things that move
    /// and are not part of the scene. Before the first frame everything may.
    ///
    /// Never panics; a box that is not finite may be seen.
    pub fn may_see_box(&mut self, min: [f64; 3], max: [f64; 3]) -> bool {
        let (low, high) = (self.grid.to_grid_f64(min), self.grid.to_grid_f64(max));
        // Outward to whole steps, where differences with the eye are exact.
        let bounds = Bounds {
            low: low.map(|c| c.floor() - 1.0),
            high: high.map(|c| c.ceil() + 1.0),
        };
        let fits = |c: &f64| c.abs() < (1_u64 << 31) as f64;
        let usable = bounds.low.iter().chain(&bounds.high).all(fits) && !bounds.is_empty();
        let Some(eye) = self.eye.filter(|_| usable) else {
            return true;
        };
        let block = bounds.seen_from(eye);
        if self.tree.is_outside(&block) {
            return false;
        }
        self.options.method == Method::Frustum
            || !self.tree.hides_box(&block, LeafTest::Exact, &mut { ROOT })
    }

    /// The leaves of the hierarchy as the last frame found them, for pictures.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let leaves = (0..self.hierarchy.nodes.len() as u32)
            .filter(|&n| self.hierarchy.nodes[n as usize].children.is_none());
        leaves.map(|n| {
            let cell = self.hierarchy.cells[n as usize].bounds;
            Cell {
                min: self.grid.to_scene(cell.min),
                max: self.grid.to_scene(cell.max),
                state: self.state_of(n),
            }
        })
    }

    fn state_of(&self, leaf: u32) -> CellState {
        let frame = self.visible.frame;
        let mut node = leaf;
        let memory = loop {
            let memory = self.memory[node as usize];
            let parent = self.hierarchy.nodes[node as usize].parent;
            if memory.frame == frame || parent == node {
                break memory;
            }
            node = parent;
        };
        if memory.frame != frame {
            return CellState::Outside;
        }
        let cell = Bounds::of(&self.hierarchy.cells[leaf as usize].bounds);
        match memory.state {
            State::Outside => CellState::Outside,
            State::Invisible if memory.propagated => CellState::Propagated,
            State::Invisible => CellState::Invisible,
            State::Visible | State::Passed => match self.eye {
                Some(eye) if self.tree.is_clear(&cell.seen_from(eye)) => CellState::Full,
                _ => CellState::Partial,
            },
        }
    }
}
