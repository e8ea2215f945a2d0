//! The kD-tree over the polygons of a scene.

use antumbra_kernel::Aabb;

use crate::PolygonId;

/// A kD-tree whose leaves list polygons; a polygon that straddles a split is listed on both sides.
#[derive(Clone, Debug)]
pub struct KdTree {
    pub(crate) bounds: Aabb,
    pub(crate) nodes: Vec<KdNode>,
    pub(crate) items: Vec<PolygonId>,
}

/// A node of a [`KdTree`]; node 0 is the root.
#[derive(Clone, Copy, Debug)]
pub enum KdNode {
    /// A plane `coordinate[axis] = at`; the lower child holds what meets `<= at`.
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

impl KdTree {
    /// The box of the root.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// All nodes; index 0 is the root.
    #[must_use]
    pub fn nodes(&self) -> &[KdNode] {
        &self.nodes
    }

    /// The polygons of a leaf.
    #[must_use]
    pub fn leaf_items(&self, first: u32, count: u32) -> &[PolygonId] {
        &self.items[first as usize..(first + count) as usize]
    }
}
