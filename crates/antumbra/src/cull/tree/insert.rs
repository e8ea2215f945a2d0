//! Insertion of occluders [Bittner02, 4.7].
//!
//! **Why a blocked leaf is right.** Let C be the closed cell of a leaf and P an occluder. Fragments
//! contain `P` within C: a cut keeps everything up to the far end of the doubtful zone. So an edge
//! that is missing in the fragment does not cross C. The leaf is blocked only inside all edges that
//! are not missing, and only if the middle of the fragment lies surely inside C and inside P. Were a
//! direction of the blocked leaf not blocked by P, then on the way to it from that middle, within C,
//! it would leave P through an edge that crosses C: one that is not missing, on whose inside the whole
//! leaf lies. An edge that only touches C in a point that is exactly on its border may be missing:
//! the way can go around a point.

use super::super::bound::{MAX_DEPTH, dot, plane_through_eye};
use super::super::fragment::WALL;
use super::{Blocker, Face, LEAF, NO_LINE, OPEN, OUTSIDE, Origin, ROOT, Shell, Tree};

impl Tree {
    /// Inserts an occluder; whether it blocks any leaf now.
    ///
    /// What is doubtful, too deep or too much is left out.
    pub(in crate::cull) fn insert(&mut self, face: &Face<'_>) -> bool {
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
        let (mut low, mut high) = ([0.0_f64; 3], [0.0_f64; 3]);
        for v in &self.fragments[..self.top] {
            for k in 0..3 {
                low[k] = low[k].min(v.p[k]);
                high[k] = high[k].max(v.p[k]);
            }
        }
        // More than the conversion rounds.
        let shell = Shell {
            low: low.map(|c| (c * 1.000_001) as f32),
            high: high.map(|c| (c * 1.000_001) as f32),
        };
        self.blockers.push(Blocker {
            normal,
            offset,
            zone: first.zone,
            parts: face.parts,
            first: start,
            count,
            facing,
            low,
            high,
            shell,
            axes: NO_LINE,
        });
        self.hits.push(0);
        self.way.clear();
        // The planes of the frustum are on the way of what is tested, if not of the occluder.
        let depth = if self.base == ROOT { 0 } else { 4 };
        let planted = self.descend(face, self.base, 0, depth);
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
                let children = self.nodes[child as usize].children;
                let [outer, inner] = children.map(|c| !self.is_behind_all(c, start));
                if outer && inner {
                    let middle = self.split(child, start);
                    let length = self.way.len();
                    self.way.push(2 * child + 1);
                    planted |= self.descend(face, 2 * child + 1, middle, depth);
                    self.way.truncate(length);
                    self.top = middle;
                    slot = 2 * child;
                } else if outer || inner {
                    self.trim(child, start, inner);
                    slot = 2 * child + u32::from(inner);
                } else {
                    return planted;
                }
                start = end;
                self.way.push(slot);
            } else if positive || negative {
                if doubtful {
                    self.mark(child, face.lines, start);
                }
                slot = 2 * child + u32::from(positive);
                if !self.clear {
                    self.way.push(slot);
                }
            } else {
                // All of it is doubtful.
                return planted;
            }
        }
    }

    /// Whether all of a fragment is surely behind what is below a child.
    #[inline]
    fn is_behind_all(&self, child: u32, start: usize) -> bool {
        let fragment = &self.fragments[start..self.top];
        match child {
            OPEN => false,
            OUTSIDE => true,
            leaf if leaf & LEAF != 0 => {
                let b = &self.blockers[(leaf & !LEAF) as usize];
                let mut behind = true;
                for v in fragment {
                    behind &= dot(b.normal, v.p) - b.offset > v.zone + b.zone;
                }
                behind
            }
            node => {
                let shell = &self.shells[node as usize];
                if shell.is_open() {
                    return false;
                }
                let (mut below, mut above) = ([true; 3], [true; 3]);
                for v in fragment {
                    for k in 0..3 {
                        below[k] &= v.p[k] < f64::from(shell.low[k]);
                        above[k] &= v.p[k] > f64::from(shell.high[k]);
                    }
                }
                below.contains(&true) || above.contains(&true)
            }
        }
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
        for &above in &self.way {
            let node = above / 2;
            let d = dot(self.nodes[node as usize].plane, middle);
            let d = if above % 2 == 1 { d } else { -d };
            if d <= zone {
                return false;
            }
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
        self.close(slot);
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
}
