//! The cells of a finished occlusion tree: every leaf with its convex cone, open ones too.
//!
//! After [Bittner02, 5.6]. Differs in taking all leaves, so that the cells cover the view without
//! gaps: then the only thing left to do is to match the two sides of each wall.

use antumbra_lines::{Corner3, Leaf, LineSpace as _, Ray3, Space3};
use antumbra_sweep::occlusion::{Sweep, View};

/// Walls from here on are those of the view's frame.
const FRAME: u32 = u32::MAX - 64;

/// All cells; corners are numbered through.
pub(super) struct Cells {
    pub(super) corners: Vec<Corner3>,
    /// `corners[first[i]..first[i + 1]]` belong to cell `i`.
    pub(super) first: Vec<u32>,
    pub(super) leaves: Vec<Leaf>,
    /// The cell of each corner.
    pub(super) owner: Vec<u32>,
    /// Vertices that are no corners.
    added: Vec<Ray3>,
}

impl Cells {
    /// Cuts the roots of a view along the tree.
    pub(super) fn of<V: View<Space = Space3>>(sweep: &mut Sweep<V>) -> Self {
        let mut cells = Self {
            corners: Vec::new(),
            first: vec![0],
            leaves: Vec::new(),
            owner: Vec::new(),
            added: Vec::new(),
        };
        for (slot, piece) in sweep.view.roots(&sweep.tree) {
            let space = sweep.view.space();
            sweep
                .tree
                .visit_with(space, slot, piece, |space, leaf, cone| {
                    let cell = cells.leaves.len() as u32;
                    cells.owner.extend(cone.corners.iter().map(|_| cell));
                    cells.corners.extend_from_slice(&cone.corners);
                    cells.first.push(cells.corners.len() as u32);
                    cells.leaves.push(leaf);
                    space.discard(cone);
                });
        }
        cells
    }

    pub(super) fn len(&self) -> usize {
        self.leaves.len()
    }

    /// The numbers of a cell's corners.
    pub(super) fn range(&self, cell: usize) -> std::ops::Range<u32> {
        self.first[cell]..self.first[cell + 1]
    }

    /// The corner after another one, around its cell.
    pub(super) fn next(&self, corner: u32) -> u32 {
        let range = self.range(self.owner[corner as usize] as usize);
        if corner + 1 == range.end {
            range.start
        } else {
            corner + 1
        }
    }

    pub(super) fn ray(&self, corner: u32) -> &Ray3 {
        let given = self.corners.len();
        match self.corners.get(corner as usize) {
            Some(corner) => &corner.ray,
            None => &self.added[corner as usize - given],
        }
    }

    /// Adds a ray that is no corner of a cell; returns its number, after those of all corners.
    pub(super) fn add_ray(&mut self, ray: Ray3) -> u32 {
        self.added.push(ray);
        (self.corners.len() + self.added.len() - 1) as u32
    }

    /// All corners by the wall of their facets, those on its negative side first.
    pub(super) fn by_wall(&self) -> Vec<u32> {
        // Walls are numbers of nodes, and a few of the view's frame, which count down from the largest number: they
        // are sorted by counting.
        let nodes = self.corners.iter().map(|c| c.wall.0).filter(|&w| w < FRAME);
        let nodes = nodes.max().map_or(0, |w| w + 1);
        let key = |c: &Corner3| {
            let wall = c.wall.0;
            let place = if wall < FRAME {
                wall
            } else {
                nodes + (wall - FRAME)
            };
            2 * place as usize + c.side.index()
        };
        let mut starts = vec![0_u32; 2 * (nodes + (u32::MAX - FRAME)) as usize + 3];
        self.corners.iter().for_each(|c| starts[key(c) + 1] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut order = vec![0; self.corners.len()];
        for (corner, i) in self.corners.iter().zip(0..) {
            let start = &mut starts[key(corner)];
            order[*start as usize] = i;
            *start += 1;
        }
        order
    }
}
