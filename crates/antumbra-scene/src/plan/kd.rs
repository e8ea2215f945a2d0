//! The kD-tree over the pieces of a plan [Bittner02, 2.4.1 and 6.6].
//!
//! Splits lie on grid values and are chosen by the surface-area heuristic over a few bins. A piece
//! that straddles a split is listed on both sides, unless it misses the closed box of a side. Each
//! node keeps the part of its box that its pieces' extents fill; so every piece lies in the union
//! of the closed boxes of the leaves that list it. Floats choose splits and decide nothing.

use antumbra_kernel::{Point2, Rect};

use super::PieceId;

/// A node: its closed box, and either two children or a range of items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanNode {
    /// A box that holds all parts of pieces for which the node is responsible.
    pub bounds: Rect,
    first: u32,
    /// Number of items; `INNER` for inner nodes, whose children are `first` and `first + 1`.
    count: u32,
    /// How an inner node is split.
    split: (u8, i32),
}

const INNER: u32 = u32::MAX;

impl PlanNode {
    /// The children of an inner node: lower and upper.
    #[inline]
    #[must_use]
    pub fn children(&self) -> Option<[u32; 2]> {
        (self.count == INNER).then_some([self.first, self.first + 1])
    }

    /// The axis and the place of an inner node's split.
    #[inline]
    #[must_use]
    pub fn split(&self) -> (usize, i32) {
        (usize::from(self.split.0), self.split.1)
    }

    /// How many pieces a leaf lists; zero for inner nodes.
    #[must_use]
    pub fn count(&self) -> usize {
        if self.count == INNER {
            0
        } else {
            self.count as usize
        }
    }
}

/// The tree; node 0 is the root, children come after their parents.
#[derive(Clone, Debug, Default)]
pub struct PlanKd {
    nodes: Vec<PlanNode>,
    items: Vec<PieceId>,
}

impl PlanKd {
    /// All nodes; none if there are no pieces.
    #[must_use]
    pub fn nodes(&self) -> &[PlanNode] {
        &self.nodes
    }

    /// The pieces of a leaf; none for inner nodes.
    #[must_use]
    pub fn items(&self, node: &PlanNode) -> &[PieceId] {
        &self.items[node.first as usize..][..node.count()]
    }

    /// Builds a tree whose leaves list about `leaf` pieces at most.
    pub(super) fn build(ends: &[[Point2; 2]], leaf: usize) -> Self {
        let mut tree = Self::default();
        let Some(bounds) = Rect::around(ends.iter().flatten().copied()) else {
            return tree;
        };
        tree.nodes.push(PlanNode {
            bounds,
            first: 0,
            count: 0,
            split: (0, 0),
        });
        let all = (0..ends.len() as u32).map(PieceId).collect();
        let mut stack = vec![(0_usize, bounds, all, 0_u32)];
        while let Some((index, cell, items, depth)) = stack.pop() {
            let items: Vec<PieceId> = items;
            let filled = filled(ends, &items, &cell);
            tree.nodes[index].bounds = filled;
            let split = (items.len() > leaf && depth < MAX_DEPTH)
                .then(|| best_split(ends, &items, &filled))
                .flatten();
            let Some((axis, at)) = split else {
                tree.nodes[index].first = tree.items.len() as u32;
                tree.nodes[index].count = items.len() as u32;
                tree.items.extend(items);
                continue;
            };
            let [lower, upper] = halves(&filled, axis, at);
            let (mut below, mut above) = (Vec::new(), Vec::new());
            for id in items {
                let piece = ends[id.0 as usize];
                let (low, high) = span(&piece, axis);
                if high <= at {
                    below.push(id);
                } else if low >= at {
                    above.push(id);
                } else {
                    // One of the two always takes it: the piece meets the box that they fill.
                    if lower.meets_segment(piece) {
                        below.push(id);
                    }
                    if upper.meets_segment(piece) {
                        above.push(id);
                    }
                }
            }
            let children = tree.nodes.len();
            let empty = PlanNode {
                bounds: cell,
                first: 0,
                count: 0,
                split: (0, 0),
            };
            tree.nodes.extend([empty; 2]);
            tree.nodes[index].first = children as u32;
            tree.nodes[index].count = INNER;
            tree.nodes[index].split = (axis as u8, at);
            stack.push((children + 1, upper, above, depth + 1));
            stack.push((children, lower, below, depth + 1));
        }
        tree
    }
}

const MAX_DEPTH: u32 = 40;
const BINS: usize = 16;

fn axis_of(p: Point2, axis: usize) -> i32 {
    if axis == 0 { p.x } else { p.y }
}

fn span(piece: &[Point2; 2], axis: usize) -> (i32, i32) {
    let (a, b) = (axis_of(piece[0], axis), axis_of(piece[1], axis));
    (a.min(b), a.max(b))
}

/// The part of a box that the extents of its pieces fill; a flat corner of it if there are none.
fn filled(ends: &[[Point2; 2]], items: &[PieceId], cell: &Rect) -> Rect {
    let around = Rect::around(items.iter().flat_map(|id| ends[id.0 as usize]));
    let Some(around) = around else {
        return Rect {
            min: cell.min,
            max: cell.min,
        };
    };
    Rect {
        min: Point2::new(cell.min.x.max(around.min.x), cell.min.y.max(around.min.y)),
        max: Point2::new(cell.max.x.min(around.max.x), cell.max.y.min(around.max.y)),
    }
}

fn halves(cell: &Rect, axis: usize, at: i32) -> [Rect; 2] {
    let (mut lower, mut upper) = (*cell, *cell);
    if axis == 0 {
        lower.max.x = at;
        upper.min.x = at;
    } else {
        lower.max.y = at;
        upper.min.y = at;
    }
    [lower, upper]
}

/// The cheapest split that is cheaper than a leaf.
fn best_split(ends: &[[Point2; 2]], items: &[PieceId], cell: &Rect) -> Option<(usize, i32)> {
    let size = [
        f64::from(cell.max.x) - f64::from(cell.min.x),
        f64::from(cell.max.y) - f64::from(cell.min.y),
    ];
    let perimeter = size[0] + size[1];
    let mut best: Option<(f64, usize, i32)> = None;
    for axis in 0..2 {
        let (low, high) = (axis_of(cell.min, axis), axis_of(cell.max, axis));
        if high - low < 2 {
            continue;
        }
        let scale = BINS as f64 / size[axis];
        let bin = |v: i32| (((f64::from(v) - f64::from(low)) * scale) as usize).min(BINS - 1);
        let (mut starts, mut stops) = ([0_usize; BINS], [0_usize; BINS]);
        for id in items {
            let (a, b) = span(&ends[id.0 as usize], axis);
            starts[bin(a.max(low))] += 1;
            stops[bin(b.min(high))] += 1;
        }
        let (mut below, mut above) = (0, items.len());
        for k in 1..BINS {
            below += starts[k - 1];
            above -= stops[k - 1];
            let at = low + (k as f64 / scale).ceil() as i32;
            if at <= low || at >= high {
                continue;
            }
            let part = f64::from(at - low);
            let lower = (part + size[1 - axis]) * below as f64;
            let upper = (size[axis] - part + size[1 - axis]) * above as f64;
            let cost = (lower + upper) / perimeter;
            if best.is_none_or(|(c, ..)| cost < c) {
                best = Some((cost, axis, at));
            }
        }
    }
    let (cost, axis, at) = best?;
    // Opening a node costs about as much as two pieces.
    (cost + 2.0 < items.len() as f64).then_some((axis, at))
}

#[cfg(test)]
mod tests {
    use super::super::PieceId;
    use super::PlanKd;
    use crate::synth::SplitMix64;
    use antumbra_kernel::Point2;

    #[test]
    fn every_piece_is_found_in_every_box_that_it_meets() {
        let mut random = SplitMix64::new(5);
        let mut at = || (random.below(2000) as i32) - 1000;
        let ends: Vec<[Point2; 2]> = (0..500)
            .map(|_| {
                let (x, y) = (at(), at());
                [Point2::new(x, y), Point2::new(x + at() / 9, y + at() / 9)]
            })
            .collect();
        let kd = PlanKd::build(&ends, 4);
        assert!(kd.nodes().len() > 100);
        let mut listed = vec![false; ends.len()];
        for node in kd.nodes() {
            for id in kd.items(node) {
                listed[id.0 as usize] = true;
                assert!(node.bounds.meets_segment(ends[id.0 as usize]));
            }
        }
        assert!(listed.iter().all(|&l| l));
        // Points of pieces lie in a leaf that lists the piece.
        for (i, [a, b]) in ends.iter().enumerate() {
            let m = Point2::new((a.x + b.x) / 2, (a.y + b.y) / 2);
            if (a.x + b.x) % 2 != 0 || (a.y + b.y) % 2 != 0 {
                continue;
            }
            let holds = kd.nodes().iter().any(|n| {
                kd.items(n).contains(&PieceId(i as u32)) && n.bounds.meets_segment([m, m])
            });
            assert!(holds, "piece {i}");
        }
    }
}
