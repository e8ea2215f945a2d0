//! On which side of a node a fragment lies, and its parts on both sides.
//!
//! A vertex in the doubtful zone is looked at once more: whether it lies on the plane *exactly* is
//! decided from the lines it comes from.

use super::super::bound::{dot, on_line, sub};
use super::super::camera::cross;
use super::super::fragment::{
    CORNER, DOUBTFUL, MAX_CORNERS, NEGATIVE, NO_EDGE, ON, POSITIVE, WALL, clip,
};
use super::{Face, NO_LINE, Origin, Tree};

impl Tree {
    pub(super) fn room(&self, corners: usize) -> bool {
        corners + 2 <= MAX_CORNERS && self.top + 2 * corners + 4 <= self.fragments.len()
    }

    /// The sides of a fragment's vertices on a node's plane: any positive, any negative, any other.
    #[inline]
    pub(super) fn classify(
        &mut self,
        node: u32,
        face: &Face<'_>,
        start: usize,
    ) -> (bool, bool, bool) {
        let plane = self.nodes[node as usize].plane;
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in &self.fragments[start..self.top] {
            let d = dot(plane, v.p);
            lowest = if d < lowest { d } else { lowest };
            highest = if d > highest { d } else { highest };
        }
        let far = 2.0 * self.zone;
        self.clear = lowest > far || highest < -far;
        if self.clear {
            return (lowest > far, highest < -far, false);
        }
        self.classify_each(node, face, start)
    }

    /// The same where vertices are apart or near the plane; keeps their signs.
    fn classify_each(&mut self, node: u32, face: &Face<'_>, start: usize) -> (bool, bool, bool) {
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
    pub(super) fn lies_along(&self, edge: u32, face: &Face<'_>, line: u32) -> bool {
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

    /// Appends one part of a fragment that was classified last.
    pub(super) fn trim(&mut self, node: u32, start: usize, positive: bool) {
        let end = self.top;
        let n = end - start;
        let (old, free) = self.fragments.split_at_mut(end);
        let old = &old[start..];
        let (sides, signs) = (&self.sides[..n], &self.signs[..n]);
        let count = if positive {
            clip::<POSITIVE>(old, sides, signs, WALL | node, free)
        } else {
            clip::<NEGATIVE>(old, sides, signs, WALL | node, free)
        };
        self.top = end + count;
    }

    /// Appends both parts of a fragment that was classified last, the negative one first; returns where
    /// the positive one starts. Each has all of the doubtful zone.
    pub(super) fn split(&mut self, node: u32, start: usize) -> usize {
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
}
