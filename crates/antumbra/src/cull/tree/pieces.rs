//! Tests of polygons, and of boxes whose faces or outline are split.

use super::super::bound::{TAU, dot, on_plane, size, sub};
use super::super::fragment::{Block, DOUBTFUL, Vertex, outline};
use super::super::options::LeafTest;
use super::{Blocker, Face, LEAF, NO_LINE, OPEN, OUTSIDE, ROOT, Tree};

impl Tree {
    /// Whether nothing of a polygon can be seen: [Bittner02, 4.8]. The polygon is split. It starts at the
    /// slot that the test of a box around it came to.
    pub(in crate::cull) fn hides_polygon(&mut self, face: &Face<'_>, entry: u32) -> bool {
        self.load(face);
        self.extent = extent(&self.fragments[..self.top]);
        self.filter(face, self.child(entry), 0, None)
    }

    /// Whether nothing of a box can be seen: its faces that look at the eye are split
    /// [Bittner02, 4.9]. The eye must not be in the box.
    pub(in crate::cull) fn hides_faces(&mut self, block: &Block) -> bool {
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
            if !self.hides_polygon(&face, ROOT) {
                return false;
            }
        }
        any
    }

    /// Whether nothing of a box can be seen, where the cone of the box is split at the inner nodes:
    /// [BHS98, 6.2]. The eye must not be in the box.
    pub(in crate::cull) fn hides_outline(&mut self, block: &Block, test: LeafTest) -> bool {
        self.top = outline(block, &mut self.fragments);
        self.zone = block.zone();
        self.extent =
            [-1.0, 1.0].map(|s| std::array::from_fn(|k| block.center[k] + s * block.half[k]));
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
                    if self.shells[child as usize].hides_between(self.extent) {
                        self.used[child as usize] = true;
                        return true;
                    }
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

/// The lower and the upper corner of the box around vertices.
fn extent(vertices: &[Vertex]) -> [[f64; 3]; 2] {
    let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    vertices.iter().fold(start, |[low, high], v| {
        [
            std::array::from_fn(|k| low[k].min(v.p[k])),
            std::array::from_fn(|k| high[k].max(v.p[k])),
        ]
    })
}
