//! The occlusion tree of a frame, in floats: built from occluders, asked about boxes and polygons.
//!
//! After [Bittner02, 4.7 to 4.10] and [BHS98, 5 and 6]. The planes of the tree go through the eye and
//! a line of the scene, *exactly*; doubles only locate things on their sides, and what they cannot
//! locate counts as [`super::bound`] says. A line has one number wherever polygons meet along it, so
//! neighbors share the plane and leave no gap; a corner on the line of a node is found exactly.
//!
//! **Why a blocked leaf is right.** Let C be the closed cell of a leaf and P an occluder. Fragments
//! contain `P` within C: a cut keeps everything up to the far end of the doubtful zone. So an edge
//! that is missing in the fragment does not cross C. The leaf is blocked only inside all edges that
//! are not missing, and only if the middle of the fragment lies surely inside C and inside P. Were a
//! direction of the blocked leaf not blocked by P, then on the way to it from that middle, within C,
//! it would leave P through an edge that crosses C: one that is not missing, on whose inside the whole
//! leaf lies. An edge that only touches C in a point that is exactly on its border may be missing:
//! the way can go around a point.

use super::bound::{MAX_DEPTH, TAU, dot, on_line, on_plane, plane_through_eye, size, sub};
use super::camera::cross;
use super::fragment::{
    Block, CORNER, DOUBTFUL, MAX_CORNERS, NEGATIVE, NO_EDGE, ON, POSITIVE, Vertex, WALL, clip,
    outline,
};
use super::options::LeafTest;

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
    /// The exact normal in two parts, see [`on_plane`].
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
    /// Where its axes start, once they were asked for.
    axes: u32,
}

/// An axis that may separate a box from the pyramid of a blocker, and what the pyramid covers on it.
/// It is orthogonal to an axis of the box, so one component is zero.
#[derive(Clone, Copy)]
struct Axis {
    direction: [f64; 3],
    low: f64,
    high: f64,
}

pub(super) struct Tree {
    eye: [f64; 3],
    nodes: Vec<Node>,
    origins: Vec<Origin>,
    root: u32,
    /// Nodes of the frustum at the start.
    frame: u32,
    blockers: Vec<Blocker>,
    /// Corners of the blockers, relative to the eye.
    corners: Vec<[f64; 3]>,
    axes: Vec<Axis>,
    /// A stack of fragments.
    fragments: Vec<Vertex>,
    top: usize,
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
            root: OPEN,
            frame: 0,
            blockers: Vec::with_capacity(max_blockers),
            corners: Vec::with_capacity(max_blockers * 8),
            axes: Vec::with_capacity(max_blockers * 30),
            fragments: vec![Vertex::NONE; 2 * (MAX_DEPTH + MAX_OCCLUDER_CORNERS + 4) * MAX_CORNERS],
            top: 0,
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
    /// framed tree calls invisible what is outside.
    pub(super) fn start(
        &mut self,
        eye: [f64; 3],
        edges: &[[f64; 3]; 4],
        framed: bool,
        marking: bool,
    ) {
        self.eye = eye;
        self.marking = marking;
        self.nodes.clear();
        self.origins.clear();
        self.blockers.clear();
        self.corners.clear();
        self.axes.clear();
        self.hits.clear();
        self.root = OPEN;
        self.turn(edges);
        let mut parent = ROOT;
        for i in 0..if framed { 4 } else { 0 } {
            let ends = [edges[i], edges[(i + 1) % 4]];
            let node = self.push(parent, self.frustum[i], ends, NO_LINE, OUTSIDE);
            parent = 2 * node + 1;
        }
        self.frame = self.nodes.len() as u32;
    }

    /// Changes the frustum of a tree that is not framed, and starts to count anew.
    pub(super) fn turn(&mut self, edges: &[[f64; 3]; 4]) {
        // The four sides, and what is behind the eye: straight ahead is the sum of the edges.
        let ahead: [f64; 3] = std::array::from_fn(|k| edges.iter().map(|e| e[k]).sum());
        let ahead = ahead.map(|c| c / size(ahead));
        self.frustum = std::array::from_fn(|i| match i {
            4 => ahead,
            _ => plane_through_eye(edges[i], edges[(i + 1) % 4]),
        });
        self.hits.fill(0);
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

    /// Loads a polygon as the first fragment.
    fn load(&mut self, face: &Face<'_>) {
        let eye = self.eye;
        self.top = face.corners.len();
        for (i, (v, &c)) in self.fragments.iter_mut().zip(face.corners).enumerate() {
            let p = sub(c, eye);
            *v = Vertex {
                p,
                zone: TAU * size(p),
                edge: i as u32,
                from: CORNER,
            };
        }
    }

    /// Inserts an occluder; whether it blocks any leaf now.
    ///
    /// What is doubtful, too deep or too much is left out.
    pub(super) fn insert(&mut self, face: &Face<'_>) -> bool {
        if self.blockers.len() == self.blockers.capacity()
            || self.corners.len() + face.corners.len() > self.corners.capacity()
        {
            return false;
        }
        self.load(face);
        let first = self.fragments[0];
        let mut normal = face.normal;
        let mut offset = dot(normal, first.p);
        // From within its plane an occluder hides nothing.
        if offset.abs() <= first.zone {
            return false;
        }
        // Seen from before, the corners turn the other way, and products of neighbors point outward.
        let facing = if offset < 0.0 { -1.0 } else { 1.0 };
        offset *= facing;
        normal = normal.map(|c| c * facing);
        let start = self.corners.len() as u32;
        let count = face.corners.len() as u32;
        self.corners
            .extend(self.fragments[..self.top].iter().map(|v| v.p));
        let corners = &self.fragments[..self.top];
        self.blockers.push(Blocker {
            normal,
            offset,
            zone: first.zone,
            parts: face.parts,
            first: start,
            count,
            facing,
            low: std::array::from_fn(|k| corners.iter().fold(0.0_f64, |m, c| m.min(c.p[k]))),
            high: std::array::from_fn(|k| corners.iter().fold(0.0_f64, |m, c| m.max(c.p[k]))),
            axes: NO_LINE,
        });
        self.hits.push(0);
        let planted = self.descend(face, NO_LINE, 0, 0);
        if !planted {
            self.blockers.pop();
            self.hits.pop();
            self.corners.truncate(start as usize);
        }
        planted
    }

    /// Takes the fragment on top of the stack, from `start` on, down from a slot.
    fn descend(
        &mut self,
        face: &Face<'_>,
        mut slot: u32,
        mut start: usize,
        mut depth: usize,
    ) -> bool {
        let mut planted = false;
        loop {
            let child = self.child(slot);
            if child & LEAF != 0 {
                return self.reach(face, slot, child, start) | planted;
            }
            depth += 1;
            self.visits += 1;
            if depth > MAX_DEPTH {
                return planted;
            }
            let (positive, negative, doubtful) = self.classify(child, face, start);
            if positive && negative {
                let end = self.top;
                if !self.room(end - start) {
                    return planted;
                }
                let middle = self.split(child, start);
                planted |= self.descend(face, 2 * child + 1, middle, depth);
                self.top = middle;
                slot = 2 * child;
                start = end;
            } else if positive || negative {
                if doubtful {
                    self.mark(child, face.lines, start);
                }
                slot = 2 * child + u32::from(positive);
            } else {
                // All of it is doubtful.
                return planted;
            }
        }
    }

    fn room(&self, corners: usize) -> bool {
        corners + 2 <= MAX_CORNERS && self.top + 2 * corners + 4 <= self.fragments.len()
    }

    /// The sides of a fragment's vertices on a node's plane: any positive, any negative, any other.
    #[inline]
    fn classify(&mut self, node: u32, face: &Face<'_>, start: usize) -> (bool, bool, bool) {
        let plane = self.nodes[node as usize].plane;
        let (mut positive, mut negative, mut doubtful) = (false, false, false);
        let fragment = &self.fragments[start..self.top];
        let places = self.sides.iter_mut().zip(&mut self.signs);
        for (v, (side, sign)) in fragment.iter().zip(places) {
            let d = dot(plane, v.p);
            *side = d;
            let (above, below) = (d > v.zone, d < -v.zone);
            positive |= above;
            negative |= below;
            doubtful |= !(above | below);
            *sign = if above {
                POSITIVE
            } else if below {
                NEGATIVE
            } else {
                DOUBTFUL
            };
        }
        if doubtful {
            self.settle(node, face, start);
        }
        (positive, negative, doubtful)
    }

    /// Finds the doubtful vertices that lie exactly on the plane of a node: on its line, or on the ray
    /// through a point that the lines of their two makers and of the node have in common.
    #[inline(never)]
    fn settle(&mut self, node: u32, face: &Face<'_>, start: usize) {
        let Origin { ends, line, .. } = self.origins[node as usize];
        if line == NO_LINE {
            return;
        }
        let n = self.top - start;
        for i in 0..n {
            if self.signs[i] != DOUBTFUL {
                continue;
            }
            let v = &self.fragments[start + i];
            let before = &self.fragments[start + (i + n - 1) % n];
            let on = self.lies_along(v.edge, face, line)
                || self.lies_along(before.edge, face, line)
                || match v.from {
                    CORNER => on_line(v.p, ends[0], ends[1]),
                    makers => self.meet(v.p, makers, ends, face),
                };
            if on {
                self.signs[i] = ON;
            }
        }
    }

    /// Whether an edge lies on a line.
    fn lies_along(&self, edge: u32, face: &Face<'_>, line: u32) -> bool {
        if edge == NO_EDGE {
            false
        } else if edge & WALL == 0 {
            face.lines[edge as usize] == line
        } else {
            self.origins[(edge & !WALL) as usize].line == line
        }
    }

    /// Whether the lines of two edges and a third line have a grid point in common.
    fn meet(&self, p: [f64; 3], makers: [u32; 2], ends: [[f64; 3]; 2], face: &Face<'_>) -> bool {
        let ends_of = |edge: u32| {
            if edge == NO_EDGE {
                None
            } else if edge & WALL == 0 {
                let i = edge as usize;
                let next = (i + 1) % face.corners.len();
                Some([i, next].map(|k| sub(face.corners[k], self.eye)))
            } else {
                let Origin { ends, line, .. } = self.origins[(edge & !WALL) as usize];
                (line != NO_LINE).then_some(ends)
            }
        };
        let (Some(a), Some(b)) = (ends_of(makers[0]), ends_of(makers[1])) else {
            return false;
        };
        // Where the ray through the vertex comes nearest to the third line is the only candidate.
        let (from, along) = (ends[0], sub(ends[1], ends[0]));
        let (f, g) = (cross(from, p), cross(along, p));
        let t = -dot(f, g) / dot(g, g);
        let point: [f64; 3] = std::array::from_fn(|k| {
            let corner = (from[k] + t * along[k] + self.eye[k]).round();
            corner - self.eye[k]
        });
        [a, b, ends].iter().all(|l| on_line(point, l[0], l[1]))
    }

    /// Marks the edges of a fragment that lie on the line of a node: its plane is on the way.
    #[inline(never)]
    fn mark(&mut self, node: u32, lines: &[u32], start: usize) {
        let line = self.origins[node as usize].line;
        for v in &mut self.fragments[start..self.top] {
            if v.edge & WALL == 0 && lines[v.edge as usize] == line {
                v.edge = WALL | node;
            }
        }
    }

    /// Appends both parts of a fragment that was classified last, the negative one first; returns where
    /// the positive one starts. Each has all of the doubtful zone.
    fn split(&mut self, node: u32, start: usize) -> usize {
        let end = self.top;
        let n = end - start;
        let (old, free) = self.fragments.split_at_mut(end);
        let old = &old[start..];
        let (sides, signs) = (&self.sides[..n], &self.signs[..n]);
        let below = clip::<NEGATIVE>(old, sides, signs, WALL | node, free);
        let above = clip::<POSITIVE>(old, sides, signs, WALL | node, &mut free[below..]);
        self.top = end + below + above;
        end + below
    }

    /// An occluder's fragment in a leaf.
    fn reach(&mut self, face: &Face<'_>, slot: u32, leaf: u32, start: usize) -> bool {
        match leaf {
            OUTSIDE => false,
            OPEN => self.plant(face, slot, OPEN, start),
            old => self.merge(face, slot, old, start),
        }
    }

    /// A fragment where something blocks already. Whoever blocks a leaf blocks it; the nearer one
    /// hides more. Where the order changes, the old one stays: a cut through their common line would
    /// not go through points of the grid.
    fn merge(&mut self, face: &Face<'_>, slot: u32, old: u32, start: usize) -> bool {
        let Blocker {
            normal,
            offset,
            zone,
            ..
        } = self.blockers[(old & !LEAF) as usize];
        let mut before = false;
        for v in &self.fragments[start..self.top] {
            let depth = dot(normal, v.p) - offset;
            if depth > v.zone + zone {
                return false;
            }
            before |= depth < -(v.zone + zone);
        }
        before && self.plant(face, slot, old, start)
    }

    /// Puts the edges of a fragment below a leaf.
    fn plant(&mut self, face: &Face<'_>, mut slot: u32, around: u32, start: usize) -> bool {
        let end = self.top;
        if end - start < 3 || self.nodes.len() + (end - start) > self.nodes.capacity() {
            return false;
        }
        let blocker = self.blockers.len() - 1;
        let Blocker {
            first,
            count,
            facing,
            ..
        } = self.blockers[blocker];
        let edge_plane = |tree: &Self, i: u32| {
            let a = tree.corners[(first + i) as usize];
            let b = tree.corners[(first + (i + 1) % count) as usize];
            (plane_through_eye(a, b).map(|c| c * facing), [a, b])
        };
        // The middle must be surely inside the leaf and the occluder.
        let scale = 1.0 / (end - start) as f64;
        let mut middle = [0.0; 3];
        let mut zone = 0.0_f64;
        for v in &self.fragments[start..end] {
            for k in 0..3 {
                middle[k] += scale * v.p[k];
            }
            zone = zone.max(v.zone);
        }
        let mut above = slot;
        while above != NO_LINE {
            let node = above / 2;
            let d = dot(self.nodes[node as usize].plane, middle);
            let d = if above % 2 == 1 { d } else { -d };
            if d <= zone {
                return false;
            }
            above = self.origins[node as usize].parent;
        }
        for i in 0..count {
            if dot(edge_plane(self, i).0, middle) <= zone {
                return false;
            }
        }
        for i in start..end {
            let edge = self.fragments[i].edge;
            // A doubtful cut can leave two pieces of an edge.
            let repeated = self.fragments[start..i].iter().any(|v| v.edge == edge);
            if repeated {
                continue;
            }
            let (plane, ends, line) = if edge & WALL == 0 {
                let (plane, ends) = edge_plane(self, edge);
                (plane, ends, face.lines[edge as usize])
            } else if self.marking {
                continue;
            } else {
                self.again(edge & !WALL, middle)
            };
            let node = self.push(slot, plane, ends, line, around);
            slot = 2 * node + 1;
        }
        self.put(slot, LEAF | blocker as u32);
        true
    }

    /// The plane of a node, with a point on its positive side.
    fn again(&self, node: u32, middle: [f64; 3]) -> ([f64; 3], [[f64; 3]; 2], u32) {
        let plane = self.nodes[node as usize].plane;
        let Origin { ends, line, .. } = self.origins[node as usize];
        if dot(plane, middle) > 0.0 {
            (plane, ends, line)
        } else {
            (plane.map(|c| -c), ends, line)
        }
    }

    /// Whether nothing of a box can be seen: [Bittner02, 4.10.2]. The box is not split.
    pub(super) fn hides_box(&mut self, block: &Block, test: LeafTest, entry: &mut u32) -> bool {
        let zone = block.zone();
        let mut stack = [0_u32; MAX_DEPTH + MAX_OCCLUDER_CORNERS + 4];
        let mut top = 0;
        let mut slot = *entry;
        let mut child = self.child(slot);
        let mut steps = 0;
        // Down to the first plane that the box crosses: what is in the box starts there.
        while child & LEAF == 0 {
            let Node { plane, children } = self.nodes[child as usize];
            let d = dot(plane, block.center);
            let reach = block.reach(plane) + zone;
            if d > reach {
                slot = 2 * child + 1;
                child = children[1];
            } else if d < -reach {
                slot = 2 * child;
                child = children[0];
            } else {
                break;
            }
            steps += 1;
        }
        *entry = slot;
        let hidden = loop {
            while child & LEAF == 0 {
                steps += 1;
                let Node { plane, children } = self.nodes[child as usize];
                let d = dot(plane, block.center);
                let reach = block.reach(plane) + zone;
                if d > reach {
                    child = children[1];
                } else if d < -reach {
                    child = children[0];
                } else {
                    child = children[1];
                    let other = children[0];
                    if other == OPEN {
                        self.steps += steps;
                        return false;
                    }
                    stack[top] = other;
                    top += 1;
                }
            }
            match child {
                OPEN => break false,
                OUTSIDE => {}
                leaf => {
                    let blocker = (leaf & !LEAF) as usize;
                    if !self.is_behind(block, zone, blocker, test) {
                        break false;
                    }
                    self.hits[blocker] += 1;
                }
            }
            if top == 0 {
                break true;
            }
            top -= 1;
            child = stack[top];
        };
        self.steps += steps;
        hidden
    }

    /// Whether no point of a box is in front of a blocker, or on it, as seen through the blocker.
    #[inline]
    fn is_behind(&mut self, block: &Block, zone: f64, blocker: usize, test: LeafTest) -> bool {
        let b = &self.blockers[blocker];
        let d = dot(b.normal, block.center) - b.offset;
        d - block.reach(b.normal) > zone + b.zone
            || (test == LeafTest::Exact && self.misses_pyramid(block, zone, blocker))
    }

    /// Whether a box surely misses the pyramid of the eye and a blocker: by the axes of the box, the
    /// planes of the pyramid, and the products of their edges.
    #[inline(never)]
    fn misses_pyramid(&mut self, block: &Block, zone: f64, blocker: usize) -> bool {
        let b = self.blockers[blocker];
        let gap = zone + b.zone;
        for k in 0..3 {
            let (center, reach) = (block.center[k], block.half[k] + gap);
            if center - reach > b.high[k] || center + reach < b.low[k] {
                return true;
            }
        }
        let corners = &self.corners[b.first as usize..(b.first + b.count) as usize];
        let mut inside = true;
        let mut previous = corners[corners.len() - 1];
        for &corner in corners {
            let plane = plane_through_eye(previous, corner);
            let d = dot(plane, block.center) * b.facing;
            if d + block.reach(plane) + zone < 0.0 {
                return true;
            }
            inside &= d > 0.0;
            previous = corner;
        }
        // The middle of the box is seen through the blocker, and the box reaches in front of it.
        if inside {
            return false;
        }
        self.axes_of(blocker).iter().any(|axis| {
            let d = dot(axis.direction, block.center);
            let reach = block.reach(axis.direction) + gap;
            d - reach > axis.high || d + reach < axis.low
        })
    }

    /// The products of the edges of a pyramid with those of a box, made when they are asked for.
    fn axes_of(&mut self, blocker: usize) -> &[Axis] {
        let b = self.blockers[blocker];
        let count = 6 * b.count as usize;
        if b.axes == NO_LINE {
            if self.axes.len() + count > self.axes.capacity() {
                return &[];
            }
            let start = self.axes.len() as u32;
            let corners = &self.corners[b.first as usize..(b.first + b.count) as usize];
            let mut previous = corners[corners.len() - 1];
            for &corner in corners {
                for edge in [corner, sub(corner, previous)] {
                    let scale = 1.0 / size(edge);
                    let e = edge.map(|c| c * scale);
                    for direction in [[0.0, e[2], -e[1]], [-e[2], 0.0, e[0]], [e[1], -e[0], 0.0]] {
                        let (mut low, mut high, mut zone) = (0.0_f64, 0.0_f64, 0.0_f64);
                        for c in corners {
                            let d = dot(direction, *c);
                            low = low.min(d);
                            high = high.max(d);
                            zone = zone.max(TAU * size(*c));
                        }
                        self.axes.push(Axis {
                            direction,
                            low: low - zone,
                            high: high + zone,
                        });
                    }
                }
                previous = corner;
            }
            self.blockers[blocker].axes = start;
        }
        let start = self.blockers[blocker].axes as usize;
        &self.axes[start..start + count]
    }

    /// Whether a box is inside the frustum and no blocker is before any of it, as far as a walk without
    /// splitting can tell.
    pub(super) fn is_clear(&self, block: &Block) -> bool {
        let zone = block.zone();
        let within =
            |plane: &[f64; 3]| dot(*plane, block.center) - block.reach(*plane) - zone > 0.0;
        if !self.frustum.iter().all(within) {
            return false;
        }
        let mut stack = vec![self.root];
        while let Some(child) = stack.pop() {
            if child & LEAF == 0 {
                let Node { plane, children } = self.nodes[child as usize];
                let d = dot(plane, block.center);
                let reach = block.reach(plane) + zone;
                if d >= -reach {
                    stack.push(children[1]);
                }
                if d <= reach {
                    stack.push(children[0]);
                }
            } else if child < OUTSIDE {
                let b = &self.blockers[(child & !LEAF) as usize];
                if dot(b.normal, block.center) + block.reach(b.normal) + zone >= b.offset {
                    return false;
                }
            }
        }
        true
    }

    /// Whether nothing of a polygon can be seen: [Bittner02, 4.8]. The polygon is split.
    pub(super) fn hides_polygon(&mut self, face: &Face<'_>) -> bool {
        self.load(face);
        self.filter(face, self.root, 0, None)
    }

    /// Whether nothing of a box can be seen: its faces that look at the eye are split
    /// [Bittner02, 4.9]. The eye must not be in the box.
    pub(super) fn hides_faces(&mut self, block: &Block) -> bool {
        let eye = self.eye;
        let at = |corner: usize| -> [f64; 3] {
            std::array::from_fn(|k| {
                let h = block.half[k];
                block.center[k] + if corner >> k & 1 == 1 { h } else { -h } + eye[k]
            })
        };
        let mut any = false;
        for axis in 0..3 {
            let (c, h) = (block.center[axis], block.half[axis]);
            let side = if c - h > 0.0 {
                0
            } else if c + h < 0.0 {
                1
            } else {
                continue;
            };
            any = true;
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let base = side << axis;
            let corners = [base, base | u, base | u | v, base | v].map(at);
            let none = [NO_LINE - 1; 4];
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            let face = Face {
                corners: &corners,
                lines: &none,
                normal: unit,
                parts: [[0.0; 3], unit],
            };
            if !self.hides_polygon(&face) {
                return false;
            }
        }
        any
    }

    /// Whether nothing of a box can be seen, where the cone of the box is split at the inner nodes:
    /// [BHS98, 6.2]. The eye must not be in the box.
    pub(super) fn hides_outline(&mut self, block: &Block, test: LeafTest) -> bool {
        self.top = outline(block, &mut self.fragments);
        if self.top == 0 {
            return false;
        }
        let none = Face {
            corners: &[],
            lines: &[],
            normal: [0.0; 3],
            parts: [[0.0; 3]; 2],
        };
        self.filter(&none, self.root, 0, Some((block, test)))
    }

    /// Whether the fragment on top of the stack is hidden below a child. Doubtful vertices go to both
    /// sides.
    fn filter(
        &mut self,
        face: &Face<'_>,
        mut child: u32,
        mut start: usize,
        block: Option<(&Block, LeafTest)>,
    ) -> bool {
        loop {
            if child & LEAF != 0 {
                return match child {
                    OPEN => false,
                    OUTSIDE => true,
                    leaf => self.judge(face, start, (leaf & !LEAF) as usize, block),
                };
            }
            self.steps += 1;
            let (positive, negative, doubtful) = self.classify(child, face, start);
            let children = self.nodes[child as usize].children;
            let end = self.top;
            let unsure = doubtful && self.signs[..end - start].contains(&DOUBTFUL);
            match (positive || unsure, negative || unsure) {
                (true, true) => {
                    if children.contains(&OPEN) || !self.room(end - start) {
                        return false;
                    }
                    let middle = self.split(child, start);
                    let hidden = self.filter(face, children[1], middle, block);
                    if !hidden {
                        return false;
                    }
                    self.top = middle;
                    child = children[0];
                    start = end;
                }
                (true, false) => child = children[1],
                (false, true) => child = children[0],
                // On the plane, as a whole: it has no inside that could be seen.
                (false, false) => return false,
            }
        }
    }

    /// Whether a fragment, or the box it is the outline of, is behind the blocker of a leaf.
    fn judge(
        &mut self,
        face: &Face<'_>,
        start: usize,
        blocker: usize,
        block: Option<(&Block, LeafTest)>,
    ) -> bool {
        let hidden = match block {
            Some((block, test)) => self.is_behind(block, block.zone(), blocker, test),
            None => {
                let Blocker {
                    normal,
                    offset,
                    zone,
                    ..
                } = self.blockers[blocker];
                let gap = zone;
                self.fragments[start..self.top]
                    .iter()
                    .all(|v| dot(normal, v.p) - offset > v.zone + gap)
                    || self.touches_from_behind(face, blocker)
            }
        };
        if hidden {
            self.hits[blocker] += 1;
        }
        hidden
    }

    /// Whether a polygon is behind the plane of a blocker and only touches it: no corner is before it,
    /// and not all are on it. Then nothing of it is seen through the blocker.
    #[inline(never)]
    fn touches_from_behind(&self, face: &Face<'_>, blocker: usize) -> bool {
        let b = &self.blockers[blocker];
        let corner = self.corners[b.first as usize];
        let mut behind = false;
        for &c in face.corners {
            let p = sub(c, self.eye);
            let depth = dot(b.normal, p) - b.offset;
            if depth > b.zone + TAU * size(p) {
                behind = true;
            } else if !on_plane(sub(p, corner), b.parts) {
                return false;
            }
        }
        behind
    }
}
