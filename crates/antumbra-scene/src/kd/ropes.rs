//! Ropes: from a leaf through each of its faces to the node on the other side.
//!
//! After [HBZ98] and [Bittner02, 4], where visibility is propagated from leaf to leaf. A rope
//! leads to the smallest node whose closed box holds the whole face; below it lie all leaves that
//! meet the face from the other side.

use antumbra_kernel::{Aabb, Point};

use super::{KdBox, KdNode, KdTree, cut};

/// The face of a box: its axis, and whether it is the upper one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BoxFace {
    /// 0, 1 or 2.
    pub axis: u8,
    /// Whether it is the face with the larger coordinate.
    pub upper: bool,
}

impl BoxFace {
    /// All six: lower x, upper x, lower y, and so on.
    pub const ALL: [Self; 6] = {
        let mut all = [Self {
            axis: 0,
            upper: false,
        }; 6];
        let mut i = 0;
        while i < 6 {
            all[i] = Self {
                axis: i as u8 / 2,
                upper: i % 2 == 1,
            };
            i += 1;
        }
        all
    };

    fn index(self) -> usize {
        2 * usize::from(self.axis) + usize::from(self.upper)
    }

    /// The face as a flat box.
    #[must_use]
    pub fn of(self, bounds: &Aabb) -> Aabb {
        let (mut min, mut max) = (bounds.min.to_array(), bounds.max.to_array());
        let k = usize::from(self.axis);
        if self.upper {
            min[k] = max[k];
        } else {
            max[k] = min[k];
        }
        Aabb {
            min: Point::from(min),
            max: Point::from(max),
        }
    }
}

/// The ropes of all leaves of a tree.
#[derive(Clone, Debug)]
pub struct Ropes {
    /// Six a node, of inner nodes too: what lies beyond the faces of their boxes.
    beyond: Vec<[Option<KdBox>; 6]>,
}

impl Ropes {
    /// Ties the ropes of a tree; linear in its nodes, times its depth at worst.
    #[must_use]
    pub fn new(tree: &KdTree) -> Self {
        let mut beyond = vec![[None; 6]; tree.nodes().len()];
        let mut stack = vec![(tree.root(), [None; 6])];
        while let Some((here, mut ropes)) = stack.pop() {
            for face in BoxFace::ALL {
                let rope: &mut Option<KdBox> = &mut ropes[face.index()];
                *rope = rope.map(|node| tighten(tree, node, &here.bounds, face));
            }
            beyond[here.node as usize] = ropes;
            let KdNode::Inner { axis, .. } = tree.nodes()[here.node as usize] else {
                continue;
            };
            let Some([lower, upper]) = tree.children(&here) else {
                continue;
            };
            let (mut of_lower, mut of_upper) = (ropes, ropes);
            let face = |upper| BoxFace { axis, upper }.index();
            of_lower[face(true)] = Some(upper);
            of_upper[face(false)] = Some(lower);
            stack.extend([(lower, of_lower), (upper, of_upper)]);
        }
        Self { beyond }
    }

    /// The smallest node beyond a face of a node whose closed box holds the face; `None` on the
    /// border of the tree.
    ///
    /// # Panics
    /// If the tree has no such node.
    #[must_use]
    pub fn beyond(&self, node: u32, face: BoxFace) -> Option<KdBox> {
        self.beyond[node as usize][face.index()]
    }
}

/// Goes down from a node beyond a face as long as one child holds the whole face.
fn tighten(tree: &KdTree, mut node: KdBox, bounds: &Aabb, face: BoxFace) -> KdBox {
    let flat = face.of(bounds);
    while let KdNode::Inner { axis, at, .. } = tree.nodes()[node.node as usize] {
        let Some([lower, upper]) = tree.children(&node) else {
            break;
        };
        let (below, above) = cut(node.bounds, usize::from(axis), at);
        node = if axis == face.axis {
            // Beyond an upper face the lower child is the near one.
            if face.upper { lower } else { upper }
        } else {
            // A face without extent may lie in the cut, and meet both.
            match (below.contains(&flat), above.contains(&flat)) {
                (true, false) => lower,
                (false, true) => upper,
                _ => break,
            }
        };
    }
    node
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{Aabb, Point};
    use proptest::prelude::*;

    use super::super::{KdHeuristic, KdNode, KdTree};
    use super::{BoxFace, Ropes};

    fn boxes() -> impl Strategy<Value = Vec<Aabb>> {
        let one = (prop::array::uniform3(-40..40), prop::array::uniform3(0..12));
        let one = one.prop_map(|(p, size)| {
            let q = std::array::from_fn(|k| p[k] + size[k]);
            Aabb::new(Point::from(p), Point::from(q))
        });
        prop::collection::vec(one, 1..200)
    }

    /// The leaves of a tree with their boxes.
    fn leaves(tree: &KdTree) -> Vec<super::KdBox> {
        let (mut found, mut stack) = (Vec::new(), vec![tree.root()]);
        while let Some(here) = stack.pop() {
            match tree.children(&here) {
                Some(children) => stack.extend(children),
                None => found.push(here),
            }
        }
        found
    }

    proptest! {
        #[test]
        fn a_rope_leads_to_all_that_meets_the_face(list in boxes()) {
            let tree = KdTree::build(&list, |_| None, KdHeuristic::SurfaceArea);
            let ropes = Ropes::new(&tree);
            let leaves = leaves(&tree);
            for here in &leaves {
                for face in BoxFace::ALL {
                    let flat = face.of(&here.bounds);
                    let border = face.of(&tree.bounds());
                    let k = usize::from(face.axis);
                    let Some(rope) = ropes.beyond(here.node, face) else {
                        prop_assert_eq!(flat.min.to_array()[k], border.min.to_array()[k]);
                        continue;
                    };
                    prop_assert!(rope.bounds.contains(&flat));
                    // The whole node is on the other side of the face.
                    let beyond = if face.upper {
                        rope.bounds.min.to_array()[k]
                    } else {
                        rope.bounds.max.to_array()[k]
                    };
                    prop_assert_eq!(beyond, flat.min.to_array()[k]);
                    // And none of its children holds the face alone.
                    if let (Some(children), KdNode::Inner { axis, .. }) =
                        (tree.children(&rope), tree.nodes()[rope.node as usize])
                    {
                        prop_assert!(axis != face.axis);
                        let holding = children.iter().filter(|c| c.bounds.contains(&flat));
                        prop_assert!(holding.count() != 1);
                    }
                }
            }
        }
    }
}
