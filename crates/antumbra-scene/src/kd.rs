//! The kD-tree over the polygons of a scene.
//!
//! Splits lie on grid values. A polygon goes to the lower child if a part of its bounding box lies
//! strictly below the split plane, and to the upper child if a part lies strictly above; one that
//! straddles goes to both, unless the polygon itself misses one of the closed boxes, and one that
//! lies flat in the split plane goes to the lower child only. So every polygon lies in the union of
//! the *closed* boxes of the leaves that list it, and a traversal that enters every closed box it
//! meets misses nothing.

mod build;
mod meets;
mod ropes;

use antumbra_kernel::{Aabb, Point};

use crate::PolygonId;

pub use build::KdHeuristic;
pub(crate) use meets::Shape;
pub use ropes::{BoxFace, Ropes};

/// A kD-tree whose leaves list polygons; a polygon that straddles a split is listed on both sides.
#[derive(Clone, Debug)]
pub struct KdTree {
    pub(crate) bounds: Aabb,
    pub(crate) nodes: Vec<KdNode>,
    pub(crate) items: Vec<PolygonId>,
}

/// A node of a [`KdTree`]; node 0 is the root.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KdNode {
    /// A plane `coordinate[axis] = at`; both children's closed boxes include it.
    Inner {
        /// 0, 1 or 2.
        axis: u8,
        /// Where the plane cuts the axis, in grid steps.
        at: i32,
        /// Index of the lower child.
        lower: u32,
        /// Index of the upper child.
        upper: u32,
    },
    /// A leaf: a range of the item list.
    Leaf {
        /// First item.
        first: u32,
        /// Number of items.
        count: u32,
    },
}

/// A node together with its closed box, which the tree does not store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KdBox {
    /// Index of the node.
    pub node: u32,
    /// Its box; it may be flat.
    pub bounds: Aabb,
}

impl KdTree {
    /// Builds the tree over polygons 0, 1, 2, ... with these bounding boxes and shapes. A polygon
    /// without a shape counts as its box.
    pub(crate) fn build<'a>(
        boxes: &[Aabb],
        shapes: impl Fn(u32) -> Option<Shape<'a>>,
        heuristic: KdHeuristic,
    ) -> Self {
        build::build(boxes, shapes, heuristic)
    }

    /// The box of the root.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// All nodes; index 0 is the root. Children come after their parents.
    #[must_use]
    pub fn nodes(&self) -> &[KdNode] {
        &self.nodes
    }

    /// The polygons of a leaf, by increasing number.
    #[must_use]
    pub fn leaf_items(&self, first: u32, count: u32) -> &[PolygonId] {
        &self.items[first as usize..(first + count) as usize]
    }

    /// The root with its box: where a traversal starts.
    #[must_use]
    pub fn root(&self) -> KdBox {
        KdBox {
            node: 0,
            bounds: self.bounds,
        }
    }

    /// The lower and the upper child with their boxes; `None` for a leaf.
    ///
    /// # Panics
    /// If the tree has no such node.
    #[inline]
    #[must_use]
    pub fn children(&self, parent: &KdBox) -> Option<[KdBox; 2]> {
        let KdNode::Inner {
            axis,
            at,
            lower,
            upper,
        } = self.nodes[parent.node as usize]
        else {
            return None;
        };
        let (below, above) = cut(parent.bounds, usize::from(axis), at);
        Some([
            KdBox {
                node: lower,
                bounds: below,
            },
            KdBox {
                node: upper,
                bounds: above,
            },
        ])
    }

    /// The polygons of a node if it is a leaf, else none.
    ///
    /// # Panics
    /// If the tree has no such node.
    #[inline]
    #[must_use]
    pub fn items(&self, node: u32) -> &[PolygonId] {
        match self.nodes[node as usize] {
            KdNode::Leaf { first, count } => self.leaf_items(first, count),
            KdNode::Inner { .. } => &[],
        }
    }

    /// Calls `visit` with every polygon of every leaf whose closed box meets a closed box: all
    /// polygons that meet the box are among them. One that straddles leaves comes several times
    /// (see [`KdTree::for_each_in_box_once`]).
    pub fn for_each_in_box(&self, query: &Aabb, mut visit: impl FnMut(PolygonId)) {
        let mut stack = vec![self.root()];
        while let Some(here) = stack.pop() {
            if !here.bounds.touches(query) {
                continue;
            }
            match self.children(&here) {
                Some([below, above]) => stack.extend([above, below]),
                None => self.items(here.node).iter().for_each(|&id| visit(id)),
            }
        }
    }

    /// As [`KdTree::for_each_in_box`], each polygon once. `seen` is emptied first and can serve
    /// many queries without being cleared in between.
    pub fn for_each_in_box_once(
        &self,
        query: &Aabb,
        seen: &mut SeenPolygons,
        mut visit: impl FnMut(PolygonId),
    ) {
        seen.clear();
        self.for_each_in_box(query, |id| {
            if seen.insert(id) {
                visit(id);
            }
        });
    }

    /// The length of the longest way from the root to a leaf, in edges.
    #[must_use]
    pub fn depth(&self) -> usize {
        let mut deepest = 0;
        let mut stack = vec![(0_u32, 0)];
        while let Some((node, depth)) = stack.pop() {
            match self.nodes[node as usize] {
                KdNode::Inner { lower, upper, .. } => {
                    stack.extend([(lower, depth + 1), (upper, depth + 1)])
                }
                KdNode::Leaf { .. } => deepest = deepest.max(depth),
            }
        }
        deepest
    }
}

/// Cuts a box at a value within it; both parts are closed and share the cut.
fn cut(bounds: Aabb, axis: usize, at: i32) -> (Aabb, Aabb) {
    let (mut top, mut bottom) = (bounds.max.to_array(), bounds.min.to_array());
    top[axis] = at;
    bottom[axis] = at;
    let below = Aabb {
        min: bounds.min,
        max: Point::from(top),
    };
    let above = Aabb {
        min: Point::from(bottom),
        max: bounds.max,
    };
    (below, above)
}

/// A set of polygons that can be emptied in constant time: scratch for repeated traversals.
#[derive(Clone, Debug, Default)]
pub struct SeenPolygons {
    /// The round in which a polygon was last inserted.
    rounds: Vec<u32>,
    round: u32,
}

impl SeenPolygons {
    /// An empty set.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Empties the set.
    pub fn clear(&mut self) {
        if self.round == u32::MAX {
            self.rounds.fill(0);
            self.round = 0;
        }
        self.round += 1;
    }

    /// Inserts a polygon; returns whether it was absent.
    pub fn insert(&mut self, id: PolygonId) -> bool {
        // Round 0 is never current once something was inserted.
        self.round = self.round.max(1);
        if self.rounds.len() <= id.index() {
            self.rounds.resize(id.index() + 1, 0);
        }
        std::mem::replace(&mut self.rounds[id.index()], self.round) != self.round
    }

    /// Whether a polygon was inserted since the set was last emptied.
    #[must_use]
    pub fn contains(&self, id: PolygonId) -> bool {
        self.round > 0 && self.rounds.get(id.index()) == Some(&self.round)
    }
}

/// What must hold for a tree over some boxes and shapes; the first violation as a sentence.
pub(crate) fn check<'a>(
    tree: &KdTree,
    boxes: &[Aabb],
    shapes: impl Fn(u32) -> Option<Shape<'a>>,
) -> Result<(), String> {
    let mut listed = vec![0_u32; boxes.len()];
    let mut stack = vec![(tree.root(), (0..boxes.len() as u32).collect::<Vec<u32>>())];
    let mut visited = 0;
    while let Some((here, mut due)) = stack.pop() {
        visited += 1;
        let Some(children) = tree.children(&here) else {
            due.retain(|&i| shapes(i).is_none_or(|shape| shape.meets(&here.bounds)));
            let items: Vec<u32> = tree.items(here.node).iter().map(|id| id.0).collect();
            if items != due {
                return Err(format!(
                    "leaf {} lists {items:?} and should list {due:?}",
                    here.node
                ));
            }
            due.iter().for_each(|&i| listed[i as usize] += 1);
            continue;
        };
        let KdNode::Inner { axis, at, .. } = tree.nodes[here.node as usize] else {
            continue;
        };
        let k = usize::from(axis);
        if !(here.bounds.min.to_array()[k]..=here.bounds.max.to_array()[k]).contains(&at) {
            return Err(format!(
                "node {} is cut at {at}, outside its box {:?}",
                here.node, here.bounds
            ));
        }
        let [mut lower, mut upper] = [Vec::new(), Vec::new()];
        for i in due {
            let side = build::sides(&boxes[i as usize], k, at);
            if side.lower {
                lower.push(i);
            }
            if side.upper {
                upper.push(i);
            }
        }
        stack.extend(children.into_iter().zip([lower, upper]));
    }
    if visited != tree.nodes.len() {
        return Err(format!(
            "{} of {} nodes are reachable",
            visited,
            tree.nodes.len()
        ));
    }
    match listed.iter().position(|&n| n == 0) {
        Some(i) => Err(format!("polygon {i} is in no leaf")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{Aabb, Point};
    use proptest::prelude::*;

    use super::{KdHeuristic, KdTree, SeenPolygons, check};
    use crate::PolygonId;

    fn boxes(limit: i32, count: usize) -> impl Strategy<Value = Vec<Aabb>> {
        let corner = move || {
            (-limit..limit, -limit..limit, -limit..limit).prop_map(|(x, y, z)| Point::new(x, y, z))
        };
        let one =
            (corner(), 0..limit, 0..limit, 0..limit, 0..8_u8).prop_map(|(p, x, y, z, flat)| {
                let size = |k: u8, s: i32| if flat == k { 0 } else { s / 4 };
                Aabb::new(
                    p,
                    Point::new(p.x + size(0, x), p.y + size(1, y), p.z + size(2, z)),
                )
            });
        prop::collection::vec(one, 0..count)
    }

    proptest! {
        #[test]
        fn every_box_is_where_it_belongs(list in prop_oneof![boxes(8, 60), boxes(1000, 600)], minimal: bool) {
            let heuristic = if minimal { KdHeuristic::MinimalSplit } else { KdHeuristic::SurfaceArea };
            let tree = KdTree::build(&list, |_| None, heuristic);
            prop_assert_eq!(check(&tree, &list, |_| None), Ok(()));
        }

        #[test]
        fn a_box_query_misses_nothing(list in boxes(12, 80), query in boxes(12, 2)) {
            let tree = KdTree::build(&list, |_| None, KdHeuristic::SurfaceArea);
            let mut seen = SeenPolygons::new();
            for q in query {
                let mut found = vec![0; list.len()];
                tree.for_each_in_box_once(&q, &mut seen, |id| found[id.index()] += 1);
                for (i, b) in list.iter().enumerate() {
                    prop_assert!(found[i] <= 1);
                    prop_assert!(!b.touches(&q) || found[i] == 1, "{i}: {b:?} in {q:?}");
                }
            }
        }
    }

    #[test]
    fn a_set_forgets_at_once() {
        let mut seen = SeenPolygons::new();
        assert!(
            seen.insert(PolygonId(5)) && !seen.insert(PolygonId(5)) && seen.insert(PolygonId(0))
        );
        seen.clear();
        assert!(seen.insert(PolygonId(5)));
    }

    #[test]
    fn identical_boxes_end_in_one_leaf() {
        let b = Aabb::new(Point::new(0, 0, 0), Point::new(9, 9, 9));
        let tree = KdTree::build(&[b; 100], |_| None, KdHeuristic::SurfaceArea);
        assert_eq!(check(&tree, &[b; 100], |_| None), Ok(()));
        assert_eq!(tree.nodes().len(), 1);
    }
}
