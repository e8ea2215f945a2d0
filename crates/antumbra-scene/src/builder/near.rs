//! Which vertices lie within one grid step of an edge: an exact query on a small point tree.

use antumbra_kernel::{Aabb, Point, sub};

/// How near is near, in grid steps: snapping moves an edge and a vertex by half a step each.
const NEAR: i64 = 1;

/// Points up to this number are tested one by one; more cost less when split once more.
const LEAF: usize = 8;

/// A balanced tree over numbered points.
pub(crate) struct PointTree {
    points: Vec<(Point, u32)>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: Aabb,
    first: u32,
    end: u32,
    /// Index of the second child (the first one follows its parent); zero in a leaf.
    second: u32,
}

impl PointTree {
    /// Builds the tree in `n log n`.
    pub(crate) fn new(points: Vec<(Point, u32)>) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(points.len() / 2 + 1),
            points,
        };
        tree.split(0, tree.points.len());
        tree
    }

    fn split(&mut self, first: usize, end: usize) {
        let Some(bounds) = Aabb::around(self.points[first..end].iter().map(|p| p.0)) else {
            return;
        };
        let node = self.nodes.len();
        self.nodes.push(Node {
            bounds,
            first: first as u32,
            end: end as u32,
            second: 0,
        });
        if end - first <= LEAF {
            return;
        }
        let extent = bounds.extent();
        let axis = (0..3).max_by_key(|&k| extent[k]).unwrap_or(0);
        let middle = (end - first) / 2;
        self.points[first..end]
            .select_nth_unstable_by_key(middle, |(p, i)| (p.to_array()[axis], *i));
        self.split(first, first + middle);
        self.nodes[node].second = self.nodes.len() as u32;
        self.split(first + middle, end);
    }

    /// Calls `found` with every point that is not farther than one grid step, in each coordinate,
    /// from some point of the segment (its ends included). Exact.
    pub(crate) fn for_each_near(&self, a: Point, b: Point, mut found: impl FnMut(Point, u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let segment = Segment::new(a, b);
        let mut stack = vec![0_usize];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at];
            if !segment.is_near(&node.bounds) {
                continue;
            }
            if node.second == 0 {
                for &(p, i) in &self.points[node.first as usize..node.end as usize] {
                    if segment.is_near(&Aabb { min: p, max: p }) {
                        found(p, i);
                    }
                }
            } else {
                stack.push(node.second as usize);
                stack.push(at + 1);
            }
        }
    }
}

/// Whether a point is not farther than one grid step, in each coordinate, from some point of a
/// segment. Exact.
pub(crate) fn is_near(a: Point, b: Point, p: Point) -> bool {
    Segment::new(a, b).is_near(&Aabb { min: p, max: p })
}

/// A segment by twice its middle and twice its half-extent, so that both are integers.
struct Segment {
    middle: [i64; 3],
    half: [i64; 3],
}

impl Segment {
    fn new(a: Point, b: Point) -> Self {
        let (p, q) = (a.to_i64(), b.to_i64());
        Self {
            middle: [p[0] + q[0], p[1] + q[1], p[2] + q[2]],
            half: sub(b, a),
        }
    }

    /// Whether the closed segment meets the closed box grown by one step on every side.
    ///
    /// Six separating axes: those of the box, and their cross products with the segment. Products
    /// of two 27-bit numbers, so exact in 64 bits.
    fn is_near(&self, bounds: &Aabb) -> bool {
        let (center, size) = (bounds.center_doubled(), bounds.extent());
        let reach = size.map(|s| s + 2 * NEAR);
        let away: [i64; 3] = std::array::from_fn(|k| self.middle[k] - center[k]);
        let long = self.half.map(i64::abs);
        (0..3).all(|k| away[k].abs() <= reach[k] + long[k])
            && (0..3).all(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let lever = away[i] * self.half[j] - away[j] * self.half[i];
                lever.abs() <= reach[i] * long[j] + reach[j] * long[i]
            })
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{LIMIT, Point};

    use super::{PointTree, is_near};

    fn near(a: [i32; 3], b: [i32; 3], p: [i32; 3]) -> bool {
        is_near(a.into(), b.into(), p.into())
    }

    #[test]
    fn one_step_is_near_and_more_is_not() {
        assert!(near([0, 0, 0], [100, 0, 0], [50, 1, -1]));
        assert!(!near([0, 0, 0], [100, 0, 0], [50, 2, 0]));
        assert!(near([0, 0, 0], [100, 0, 0], [101, 1, 0]));
        assert!(!near([0, 0, 0], [100, 0, 0], [102, 0, 0]));
        let m = LIMIT - 1;
        assert!(near([-m, -m, -m], [m, m, m - 1], [0, 1, 1]));
        assert!(!near([-m, -m, -m], [m, m, m - 1], [0, 2, 3]));
    }

    #[test]
    fn the_tree_finds_what_a_plain_loop_finds() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 59) as i32
        };
        let points: Vec<(Point, u32)> = (0..500)
            .map(|i| (Point::new(next(), next(), next()), i))
            .collect();
        let tree = PointTree::new(points.clone());
        for pair in points.chunks(2).take(100) {
            let (a, b) = (pair[0].0, pair[1].0);
            let mut found = Vec::new();
            tree.for_each_near(a, b, |_, i| found.push(i));
            found.sort_unstable();
            let expected: Vec<u32> = points
                .iter()
                .filter(|(p, _)| is_near(a, b, *p))
                .map(|&(_, i)| i)
                .collect();
            assert_eq!(found, expected);
        }
    }
}
