//! The node hierarchy: which nodes are in the scene, and where each of them stands.

use super::document::{Document, Node};
use crate::error::{Damage, Place};

/// A map p -> linear * p + offset; `linear` row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    linear: [[f64; 3]; 3],
    offset: [f64; 3],
}

impl Transform {
    const IDENTITY: Self = Self {
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        offset: [0.0; 3],
    };

    pub(super) fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        let moved = |k: usize| dot(self.linear[k], p) + self.offset[k];
        [moved(0), moved(1), moved(2)]
    }

    /// This map after `first`.
    fn after(&self, first: &Self) -> Self {
        let column = |j: usize| [first.linear[0][j], first.linear[1][j], first.linear[2][j]];
        let linear =
            std::array::from_fn(|i| std::array::from_fn(|j| dot(self.linear[i], column(j))));
        Self {
            linear,
            offset: self.apply(first.offset),
        }
    }

    fn of(node: &Node) -> Self {
        if let Some(m) = &node.matrix {
            let linear = std::array::from_fn(|i| std::array::from_fn(|j| m[4 * j + i]));
            return Self {
                linear,
                offset: [m[12], m[13], m[14]],
            };
        }
        let rotation = node.rotation.map_or(Self::IDENTITY.linear, rotation);
        let scale = node.scale.unwrap_or([1.0; 3]);
        let linear = rotation.map(|row| std::array::from_fn(|j| row[j] * scale[j]));
        Self {
            linear,
            offset: node.translation.unwrap_or_default(),
        }
    }

    fn is_finite(&self) -> bool {
        self.linear
            .iter()
            .flatten()
            .chain(&self.offset)
            .all(|c| c.is_finite())
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The rotation by a quaternion of any length but zero. Dividing by the squared length, instead
/// of trusting it to be one, keeps quarter turns exact.
fn rotation([x, y, z, w]: [f64; 4]) -> [[f64; 3]; 3] {
    let length = x * x + y * y + z * z + w * w;
    let s = if length > 0.0 { 2.0 / length } else { 0.0 };
    [
        [
            1.0 - s * (y * y + z * z),
            s * (x * y - z * w),
            s * (x * z + y * w),
        ],
        [
            s * (x * y + z * w),
            1.0 - s * (x * x + z * z),
            s * (y * z - x * w),
        ],
        [
            s * (x * z - y * w),
            s * (y * z + x * w),
            1.0 - s * (x * x + y * y),
        ],
    ]
}

/// For each node its place in the scene, or `None` if it is not in the scene.
///
/// The scene is the one the file names, else the first, else all nodes without parents.
pub(super) fn placements(document: &Document) -> Result<Vec<Option<Transform>>, Damage> {
    let nodes = &document.nodes;
    let mut placed: Vec<Option<Transform>> = vec![None; nodes.len()];
    let mut open: Vec<(usize, Transform)> = Vec::new();
    for root in roots(document)? {
        open.push((root, Transform::IDENTITY));
        while let Some((index, above)) = open.pop() {
            let place = Place::Item {
                list: "node",
                index: index as u64,
            };
            if placed[index].is_some() {
                let found = "it is reached twice; a node has one parent at most and is not its own ancestor";
                return Err(Damage::broken(place, found));
            }
            let here = above.after(&Transform::of(&nodes[index]));
            if !here.is_finite() {
                return Err(Damage::broken(place, "its transform is not finite"));
            }
            placed[index] = Some(here);
            for child in &nodes[index].children {
                check(*child, nodes.len(), &place)?;
                open.push((*child, here));
            }
        }
    }
    Ok(placed)
}

fn roots(document: &Document) -> Result<Vec<usize>, Damage> {
    let count = document.nodes.len();
    let index = document.scene.unwrap_or(0);
    match document.scenes.get(index) {
        Some(scene) => {
            let place = Place::Item {
                list: "scene",
                index: index as u64,
            };
            scene
                .nodes
                .iter()
                .try_for_each(|node| check(*node, count, &place))?;
            Ok(scene.nodes.clone())
        }
        None if document.scene.is_some() => {
            let found = format!(
                "scene {index} does not exist, there are {}",
                document.scenes.len()
            );
            Err(Damage::broken(Place::Whole, found))
        }
        None => {
            let mut is_root = vec![true; count];
            for child in document.nodes.iter().flat_map(|node| &node.children) {
                if let Some(entry) = is_root.get_mut(*child) {
                    *entry = false;
                }
            }
            Ok((0..count).filter(|i| is_root[*i]).collect())
        }
    }
}

fn check(node: usize, count: usize, place: &Place) -> Result<(), Damage> {
    if node < count {
        return Ok(());
    }
    Err(Damage::broken(
        place.clone(),
        format!("node {node} does not exist, there are {count}"),
    ))
}

#[cfg(test)]
mod tests {
    use super::{Transform, rotation};

    #[test]
    fn quarter_turns_are_exact() {
        let h = 0.707_106_77;
        assert_eq!(
            rotation([0.0, 0.0, h, h]),
            [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        );
    }

    #[test]
    fn maps_compose() {
        let turn = Transform {
            linear: rotation([0.0, 0.0, 1.0, 1.0]),
            offset: [0.0, 0.0, 5.0],
        };
        let shift = Transform {
            offset: [1.0, 0.0, 0.0],
            ..Transform::IDENTITY
        };
        assert_eq!(turn.after(&shift).apply([1.0, 0.0, 0.0]), [0.0, 2.0, 5.0]);
        assert_eq!(shift.after(&turn).apply([1.0, 0.0, 0.0]), [1.0, 1.0, 5.0]);
    }
}
