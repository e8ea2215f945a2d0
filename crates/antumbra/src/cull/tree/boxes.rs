//! Tests of boxes that are not split [Bittner02, 4.10.2].

use super::super::bound::{MAX_DEPTH, TAU, dot, plane_through_eye, size, sub};
use super::super::fragment::Block;
use super::super::options::LeafTest;
use super::{LEAF, MAX_OCCLUDER_CORNERS, NO_LINE, Node, OPEN, OUTSIDE, Tree};

/// An axis that may separate a box from the pyramid of a blocker, and what the pyramid covers on it.
/// It is orthogonal to an axis of the box, so one component is zero.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    direction: [f64; 3],
    low: f64,
    high: f64,
}

impl Tree {
    /// Whether nothing of a box can be seen: [Bittner02, 4.10.2]. The box is not split.
    pub(in crate::cull) fn hides_box(
        &mut self,
        block: &Block,
        test: LeafTest,
        entry: &mut u32,
    ) -> bool {
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
                    if self.shells[child as usize].hides(block) {
                        self.used[child as usize] = true;
                        child = OUTSIDE;
                        break;
                    }
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
    pub(super) fn is_behind(
        &mut self,
        block: &Block,
        zone: f64,
        blocker: usize,
        test: LeafTest,
    ) -> bool {
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
    pub(in crate::cull) fn is_clear(&self, block: &Block) -> bool {
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
}
