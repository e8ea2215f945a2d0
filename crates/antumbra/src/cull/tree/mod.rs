//! The occlusion tree of a frame, in floats: built from occluders, asked about boxes and polygons.
//!
//! After [Bittner02, 4.7 to 4.10] and [BHS98, 5 and 6]. The planes of the tree go through the eye and
//! a line of the scene, *exactly*; doubles only locate things on their sides, and what they cannot
//! locate counts as [`super::bound`] says. A line has one number wherever polygons meet along it, so
//! neighbors share the plane and leave no gap; a corner on the line of a node is found exactly.
//!
//! [`insert`] builds it, [`boxes`] and [`pieces`] ask it, both by what [`place`] says.

mod boxes;
mod insert;
mod pieces;
mod place;

use super::bound::{MAX_DEPTH, TAU, dot, plane_through_eye, size, sub};
use super::fragment::{Block, CORNER, MAX_CORNERS, Vertex};

use boxes::Axis;

/// The line of a plane of the frustum.
const NO_LINE: u32 = u32::MAX;
/// The slot of the root.
pub(super) const ROOT: u32 = NO_LINE;
/// Children above this bit are leaves.
const LEAF: u32 = 1 << 31;
const OPEN: u32 = u32::MAX;
const OUTSIDE: u32 = u32::MAX - 1;

/// The most corners of an occluder.
pub(super) const MAX_OCCLUDER_CORNERS: usize = 24;

#[derive(Clone, Copy)]
struct Node {
    plane: [f64; 3],
    /// Outside, inside.
    children: [u32; 2],
}

/// Around the eye and all that blocks below a node; infinite if something there is open.
///
/// What is beyond it is hidden: let `p[k] > high[k]`. On the way from the eye to `p` something blocks, at
/// `t p`. That lies in the shell: `t p[k] <= high[k] < p[k]`, and `p[k] > 0`, so `t < 1`.
#[derive(Clone, Copy, PartialEq)]
struct Shell {
    low: [f32; 3],
    high: [f32; 3],
}

impl Shell {
    const OPEN: Self = Self {
        low: [f32::NEG_INFINITY; 3],
        high: [f32::INFINITY; 3],
    };
    const EMPTY: Self = Self {
        low: [0.0; 3],
        high: [0.0; 3],
    };

    fn union(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    fn is_open(&self) -> bool {
        self.high[0] == f32::INFINITY
    }

    /// Whether all of a box is beyond. Exact: boxes are differences of grid points with the eye.
    #[inline]
    fn hides(&self, block: &Block) -> bool {
        (0..3).any(|k| {
            block.center[k] - block.half[k] > f64::from(self.high[k])
                || block.center[k] + block.half[k] < f64::from(self.low[k])
        })
    }

    /// Whether all between two corners is beyond, exactly.
    #[inline]
    fn hides_between(&self, [low, high]: [[f64; 3]; 2]) -> bool {
        (0..3).any(|k| low[k] > f64::from(self.high[k]) || high[k] < f64::from(self.low[k]))
    }
}

/// What only insertion needs to know of a node.
#[derive(Clone, Copy)]
struct Origin {
    ends: [[f64; 3]; 2],
    line: u32,
    /// The node above and the side on which this one hangs, times two plus side; none for the root.
    parent: u32,
}

/// A convex polygon: corners on the grid, the lines of its edges, its plane.
#[derive(Clone, Copy)]
pub(super) struct Face<'a> {
    pub corners: &'a [[f64; 3]],
    /// One for each edge, from corner `i` to the next one.
    pub lines: &'a [u32],
    /// Of length one; the corners turn counter-clockwise about it.
    pub normal: [f64; 3],
    /// The exact normal in two parts, see [`super::bound::on_plane`].
    pub parts: [[f64; 3]; 2],
}

/// An occluder in the tree, relative to the eye.
#[derive(Clone, Copy)]
struct Blocker {
    /// `normal . x = offset > 0` on the plane.
    normal: [f64; 3],
    offset: f64,
    zone: f64,
    parts: [[f64; 3]; 2],
    first: u32,
    count: u32,
    /// 1 if the corners turn so that products of neighbors point inward, else -1.
    facing: f64,
    /// Around the eye and the corners.
    low: [f64; 3],
    high: [f64; 3],
    /// The same, rounded outward.
    shell: Shell,
    /// Where its axes start, once they were asked for.
    axes: u32,
}

pub(super) struct Tree {
    eye: [f64; 3],
    nodes: Vec<Node>,
    origins: Vec<Origin>,
    shells: Vec<Shell>,
    /// Whether all below a node hid something at once.
    used: Vec<bool>,
    /// The slots on the way of a fragment whose planes its parts may come near to.
    way: Vec<u32>,
    root: u32,
    /// Nodes of the frustum at the start.
    frame: u32,
    /// Where occluders are inserted: at the root, as far as they are in the frustum, or whole below it.
    base: u32,
    blockers: Vec<Blocker>,
    /// Corners of the blockers, relative to the eye.
    corners: Vec<[f64; 3]>,
    axes: Vec<Axis>,
    /// A stack of fragments.
    fragments: Vec<Vertex>,
    top: usize,
    /// The lower and the upper corner of what is tested in fragments.
    extent: [[f64; 3]; 2],
    /// The widest doubtful zone of what was loaded, and so of all its parts.
    zone: f64,
    /// Whether the fragment that was classified last is far from the plane: twice the zone, so that all
    /// that is cut from it, and any mean of that, is surely on the same side.
    clear: bool,
    signs: [i8; MAX_CORNERS],
    sides: [f64; MAX_CORNERS],
    /// How often each blocker hid something.
    pub hits: Vec<u32>,
    /// Fragments that insertion has taken past a node.
    pub visits: u64,
    /// Nodes visited by tests.
    pub steps: u64,
    /// Whether edges that lie on planes of the way are left out (MOBSP), or come again (OBSP).
    marking: bool,
    /// The planes of the frustum, pointing inward, and the one across the eye.
    frustum: [[f64; 3]; 5],
}

impl Tree {
    /// An empty tree with all the memory it will ever use.
    pub(super) fn new(max_nodes: usize, max_blockers: usize) -> Self {
        Self {
            eye: [0.0; 3],
            nodes: Vec::with_capacity(max_nodes),
            origins: Vec::with_capacity(max_nodes),
            shells: Vec::with_capacity(max_nodes),
            used: Vec::with_capacity(max_nodes),
            way: Vec::with_capacity(MAX_DEPTH),
            root: OPEN,
            frame: 0,
            base: ROOT,
            blockers: Vec::with_capacity(max_blockers),
            corners: Vec::with_capacity(max_blockers * 8),
            axes: Vec::with_capacity(max_blockers * 30),
            fragments: vec![Vertex::NONE; 2 * (MAX_DEPTH + MAX_OCCLUDER_CORNERS + 4) * MAX_CORNERS],
            top: 0,
            clear: false,
            zone: 0.0,
            extent: [[0.0; 3]; 2],
            signs: [0; MAX_CORNERS],
            sides: [0.0; MAX_CORNERS],
            hits: Vec::with_capacity(max_blockers),
            steps: 0,
            visits: 0,
            marking: true,
            frustum: [[0.0; 3]; 5],
        }
    }

    /// Empties the tree, for an eye and a frustum: the planes of neighboring edges point inward. A
    /// framed tree calls invisible what is outside. One that can be turned takes occluders whole.
    pub(super) fn start(
        &mut self,
        eye: [f64; 3],
        edges: &[[f64; 3]; 4],
        framed: bool,
        turning: bool,
        marking: bool,
    ) {
        self.eye = eye;
        self.marking = marking;
        self.nodes.clear();
        self.origins.clear();
        self.shells.clear();
        self.used.clear();
        self.blockers.clear();
        self.corners.clear();
        self.axes.clear();
        self.hits.clear();
        self.root = OPEN;
        self.base = ROOT;
        self.turn(edges);
        let mut parent = ROOT;
        for i in 0..if framed { 4 } else { 0 } {
            let ends = [edges[i], edges[(i + 1) % 4]];
            let node = self.push(parent, self.frustum[i], ends, NO_LINE, OUTSIDE);
            parent = 2 * node + 1;
        }
        self.frame = self.nodes.len() as u32;
        if turning {
            self.base = parent;
        }
    }

    /// Changes the frustum of a tree whose occluders are whole, and starts to count anew.
    pub(super) fn turn(&mut self, edges: &[[f64; 3]; 4]) {
        // The four sides, and what is behind the eye: straight ahead is the sum of the edges.
        let ahead: [f64; 3] = std::array::from_fn(|k| edges.iter().map(|e| e[k]).sum());
        let ahead = ahead.map(|c| c / size(ahead));
        self.frustum = std::array::from_fn(|i| match i {
            4 => ahead,
            _ => plane_through_eye(edges[i], edges[(i + 1) % 4]),
        });
        for (node, plane) in self.nodes.iter_mut().zip(self.frustum).take(4) {
            node.plane = plane;
        }
        self.hits.fill(0);
        self.used.fill(false);
        self.steps = 0;
        self.visits = 0;
    }

    /// Whether a box is surely outside the frustum.
    pub(super) fn is_outside(&self, block: &Block) -> bool {
        let zone = block.zone();
        let beyond =
            |plane: &[f64; 3]| dot(*plane, block.center) + block.reach(*plane) + zone < 0.0;
        self.frustum.iter().any(beyond)
    }

    pub(super) fn node_count(&self) -> usize {
        self.nodes.len() - self.frame as usize
    }

    /// Hangs a node in a slot (the root, or node times two plus side).
    fn push(
        &mut self,
        slot: u32,
        plane: [f64; 3],
        ends: [[f64; 3]; 2],
        line: u32,
        outer: u32,
    ) -> u32 {
        let node = self.nodes.len() as u32;
        self.nodes.push(Node {
            plane,
            children: [outer, OPEN],
        });
        self.origins.push(Origin {
            ends,
            line,
            parent: slot,
        });
        self.shells.push(Shell::OPEN);
        self.used.push(false);
        self.put(slot, node);
        node
    }

    fn put(&mut self, slot: u32, child: u32) {
        if slot == NO_LINE {
            self.root = child;
        } else {
            self.nodes[slot as usize / 2].children[slot as usize % 2] = child;
        }
    }

    fn child(&self, slot: u32) -> u32 {
        if slot == NO_LINE {
            self.root
        } else {
            self.nodes[slot as usize / 2].children[slot as usize % 2]
        }
    }

    fn shell(&self, child: u32) -> Shell {
        match child {
            OPEN => Shell::OPEN,
            OUTSIDE => Shell::EMPTY,
            leaf if leaf & LEAF != 0 => self.blockers[(leaf & !LEAF) as usize].shell,
            node => self.shells[node as usize],
        }
    }

    /// Tells the nodes above a slot what blocks below now.
    fn close(&mut self, mut slot: u32) {
        while slot != NO_LINE {
            let node = slot / 2;
            let [outer, inner] = self.nodes[node as usize].children;
            let shell = self.shell(outer).union(self.shell(inner));
            let old = std::mem::replace(&mut self.shells[node as usize], shell);
            if old == shell {
                return;
            }
            slot = self.origins[node as usize].parent;
        }
    }

    /// Credits the blockers below nodes that hid something as a whole: all had a part.
    pub(super) fn spread_hits(&mut self) {
        for node in 0..self.nodes.len() {
            if self.used[node] {
                for child in self.nodes[node].children {
                    if child & LEAF == 0 {
                        self.used[child as usize] = true;
                    } else if child < OUTSIDE {
                        self.hits[(child & !LEAF) as usize] += 1;
                    }
                }
            }
        }
    }

    /// Loads a polygon as the first fragment.
    fn load(&mut self, face: &Face<'_>) {
        let eye = self.eye;
        self.top = face.corners.len();
        self.zone = 0.0;
        for (i, (v, &c)) in self.fragments.iter_mut().zip(face.corners).enumerate() {
            let p = sub(c, eye);
            let zone = TAU * size(p);
            self.zone = self.zone.max(zone);
            *v = Vertex {
                p,
                zone,
                edge: i as u32,
                from: CORNER,
            };
        }
    }
}
