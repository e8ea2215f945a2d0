//! The spatial hierarchy of culling: the kD-tree of the scene with tight boxes, pruned to leaves that
//! are worth a test, and what stands in each leaf.
//!
//! A leaf lists *items*: the box of what one object has in the leaf. An object is visible if one of
//! its items is; the union of the items of an object covers it.

use antumbra_kernel::Aabb;
use antumbra_scene::{KdBox, KdNode, KdTree, PolygonId, Scene};

use super::bound::{dot, sub};
use super::faces::Faces;
use super::fragment::Block;

/// A closed box in grid steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Bounds {
    const EMPTY: Self = Self {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    pub(super) fn of(b: &Aabb) -> Self {
        Self {
            low: b.min.to_f64(),
            high: b.max.to_f64(),
        }
    }

    pub(super) fn around(points: &[[f64; 3]]) -> Self {
        points.iter().fold(Self::EMPTY, |b, p| Self {
            low: std::array::from_fn(|k| b.low[k].min(p[k])),
            high: std::array::from_fn(|k| b.high[k].max(p[k])),
        })
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// This box relative to an eye.
    #[inline]
    pub(super) fn seen_from(&self, eye: [f64; 3]) -> Block {
        Block {
            center: std::array::from_fn(|k| (self.low[k] + self.high[k]) * 0.5 - eye[k]),
            half: std::array::from_fn(|k| (self.high[k] - self.low[k]) * 0.5),
        }
    }

    /// The squared distance of a point; zero inside.
    pub(super) fn squared_distance(&self, p: [f64; 3]) -> f64 {
        let d: [f64; 3] =
            std::array::from_fn(|k| (self.low[k] - p[k]).max(p[k] - self.high[k]).max(0.0));
        dot(d, d)
    }

    fn holds(&self, points: &[[f64; 3]]) -> bool {
        let inside = |p: &[f64; 3]| (0..3).all(|k| self.low[k] <= p[k] && p[k] <= self.high[k]);
        points.iter().all(inside)
    }

    fn meet(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].max(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].min(other.high[k])),
        }
    }

    /// The same in half the memory: grid coordinates fit.
    fn compact(&self) -> CompactBounds {
        CompactBounds {
            low: self.low.map(|c| c as f32),
            high: self.high.map(|c| c as f32),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        (0..3).any(|k| self.low[k] > self.high[k])
    }
}

/// [`Bounds`] of whole grid steps, which are below 2^24 and so exact.
#[derive(Clone, Copy, Debug)]
pub(super) struct CompactBounds {
    low: [f32; 3],
    high: [f32; 3],
}

impl CompactBounds {
    #[inline]
    pub(super) fn wide(&self) -> Bounds {
        Bounds {
            low: self.low.map(f64::from),
            high: self.high.map(f64::from),
        }
    }
}

/// An occluder of a leaf, and what its area-angle depends on, nearly.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafOccluder {
    pub number: u32,
    pub area: f32,
    middle: [f32; 3],
    normal: [f32; 3],
}

impl LeafOccluder {
    fn new(number: u32, occluders: &Faces) -> Self {
        Self {
            number,
            area: occluders.area(number) as f32,
            middle: occluders.middle(number).map(|c| c as f32),
            normal: occluders.normal(number).map(|c| c as f32),
        }
    }

    /// In steradians, nearly [Bittner02, 4.5].
    #[inline]
    pub(super) fn area_angle(&self, eye: [f64; 3]) -> f64 {
        let d = sub(self.middle.map(f64::from), eye);
        let squared = dot(d, d);
        let facing = dot(self.normal.map(f64::from), d).abs();
        f64::from(self.area) * facing / (squared * squared.sqrt())
    }
}

/// What one object has in a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub object: u32,
    pub bounds: Bounds,
    /// Its polygons, in [`Hierarchy::polygons`].
    pub first: u32,
    pub count: u32,
}

/// A face that an item has in a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafFace {
    pub face: u32,
    /// Whether all of it is in the leaf.
    pub whole: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct HierarchyNode {
    /// Around all that is in the node.
    pub bounds: CompactBounds,
    /// Whether nothing is.
    pub empty: bool,
    /// The plane between the children.
    pub axis: u8,
    pub at: f32,
    /// The node above; the root's own number for the root.
    pub parent: u32,
    /// Lower and upper child; none for a leaf.
    pub children: Option<[u32; 2]>,
    /// Items of a leaf.
    pub items: (u32, u32),
    /// Occluders of a leaf, the largest first, in [`Hierarchy::occluders`].
    pub occluders: (u32, u32),
    /// The objects in the node, in [`Hierarchy::objects`]; none if they are many.
    pub objects: Option<(u32, u32)>,
}

/// See the module.
#[derive(Default)]
pub(super) struct Hierarchy {
    /// Parents before children; the first is the root. Empty for a scene without polygons.
    pub nodes: Vec<HierarchyNode>,
    /// The node of the kD-tree that each was made of.
    pub cells: Vec<KdBox>,
    pub items: Vec<Item>,
    pub polygons: Vec<LeafFace>,
    pub occluders: Vec<LeafOccluder>,
    pub objects: Vec<u32>,
    /// The node made of a kD node; for one that was pruned, the leaf above it.
    pub of_kd: Vec<u32>,
}

/// A node with at most so many objects lists them.
const FEW: usize = 12;

impl Hierarchy {
    /// Prunes the kD-tree of a scene to leaves of about `leaf_cost` polygons.
    pub(super) fn new(
        scene: &Scene,
        polygons: &Faces,
        of_polygon: &[(u32, u32)],
        occluders: &Faces,
        leaf_cost: u32,
    ) -> Self {
        let kd = scene.kd();
        let mut hierarchy = Self {
            of_kd: vec![u32::MAX; kd.nodes().len()],
            ..Self::default()
        };
        if scene.polygon_count() == 0 {
            return hierarchy;
        }
        let mut builder = Builder {
            scene,
            polygons,
            of_polygon,
            leaf_cost,
            costs: costs(kd),
            out: &mut hierarchy,
        };
        builder.node(kd.root(), 0);
        hierarchy.hang(occluders);
        hierarchy
    }

    /// The leaf whose cell holds a point; none outside.
    pub(super) fn leaf_at(&self, p: [f64; 3]) -> Option<u32> {
        let cell = Bounds::of(&self.cells.first()?.bounds);
        if (0..3).any(|k| p[k] < cell.low[k] || p[k] > cell.high[k]) {
            return None;
        }
        let mut node = 0;
        while let Some([lower, upper]) = self.nodes[node as usize].children {
            let n = &self.nodes[node as usize];
            node = if p[n.axis as usize] < f64::from(n.at) {
                lower
            } else {
                upper
            };
        }
        Some(node)
    }

    /// Lists each occluder in the leaves whose box its own box meets.
    fn hang(&mut self, occluders: &Faces) {
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); self.nodes.len()];
        for face in 0..occluders.len() as u32 {
            let bounds = Bounds::around(occluders.get(face).corners);
            let mut stack = vec![0_u32];
            while let Some(node) = stack.pop() {
                let n = &self.nodes[node as usize];
                if Bounds::of(&self.cells[node as usize].bounds)
                    .meet(&bounds)
                    .is_empty()
                {
                    continue;
                }
                match n.children {
                    Some(children) => stack.extend(children),
                    None => lists[node as usize].push(face),
                }
            }
        }
        for (node, mut list) in lists.into_iter().enumerate() {
            list.sort_by(|&a, &b| {
                occluders
                    .area(b)
                    .total_cmp(&occluders.area(a))
                    .then(a.cmp(&b))
            });
            let first = self.occluders.len() as u32;
            self.nodes[node].occluders = (first, first + list.len() as u32);
            let of_leaf = |number| LeafOccluder::new(number, occluders);
            self.occluders.extend(list.into_iter().map(of_leaf));
        }
    }
}

struct Builder<'a> {
    scene: &'a Scene,
    polygons: &'a Faces,
    /// The faces of each polygon of the scene.
    of_polygon: &'a [(u32, u32)],
    leaf_cost: u32,
    costs: Vec<u32>,
    out: &'a mut Hierarchy,
}

impl Builder<'_> {
    /// Makes a node; returns its number and the objects below, sorted.
    fn node(&mut self, here: KdBox, parent: u32) -> (u32, Vec<u32>) {
        let number = self.out.nodes.len() as u32;
        self.out.of_kd[here.node as usize] = number;
        let cost = self.costs[here.node as usize];
        self.out.cells.push(here);
        self.out.nodes.push(HierarchyNode {
            bounds: Bounds::EMPTY.compact(),
            empty: true,
            axis: 0,
            at: 0.0,
            parent,
            children: None,
            items: (0, 0),
            occluders: (0, 0),
            objects: None,
        });
        let kd = self.scene.kd();
        let inner = kd.children(&here).filter(|_| cost > self.leaf_cost);
        let objects = match (inner, kd.nodes()[here.node as usize]) {
            (Some([below, above]), KdNode::Inner { axis, at, .. }) => {
                let (lower, mut objects) = self.node(below, number);
                let (upper, more) = self.node(above, number);
                objects.extend(more);
                objects.sort_unstable();
                objects.dedup();
                let [below, above] =
                    [lower, upper].map(|n| self.out.nodes[n as usize].bounds.wide());
                let bounds = below.union(&above);
                let node = &mut self.out.nodes[number as usize];
                node.bounds = bounds.compact();
                node.empty = bounds.is_empty();
                node.axis = axis;
                node.at = at as f32;
                node.children = Some([lower, upper]);
                objects
            }
            _ => self.leaf(number, here),
        };
        if objects.len() <= FEW {
            let first = self.out.objects.len() as u32;
            self.out.objects.extend(&objects);
            let end = self.out.objects.len() as u32;
            self.out.nodes[number as usize].objects = Some((first, end));
        }
        (number, objects)
    }

    /// Fills a leaf with the items of all kD leaves below.
    fn leaf(&mut self, number: u32, here: KdBox) -> Vec<u32> {
        let kd = self.scene.kd();
        // Object, face, bounds.
        let mut parts: Vec<(u32, u32, Bounds)> = Vec::new();
        let mut stack = vec![here];
        while let Some(node) = stack.pop() {
            self.out.of_kd[node.node as usize] = number;
            if let Some(children) = kd.children(&node) {
                stack.extend(children);
                continue;
            }
            let cell = Bounds::of(&node.bounds);
            for &id in kd.items(node.node) {
                let object = self.scene.polygon(id).object.0;
                for face in self.faces(id) {
                    if let Some(bounds) = clipped(self.polygons.get(face).corners, &cell) {
                        parts.push((object, face, bounds));
                    }
                }
            }
        }
        parts.sort_by_key(|&(object, face, _)| (object, face));
        let first_item = self.out.items.len() as u32;
        let mut around = Bounds::EMPTY;
        let mut objects = Vec::new();
        for group in parts.chunk_by(|a, b| a.0 == b.0) {
            let bounds = group.iter().fold(Bounds::EMPTY, |b, part| b.union(&part.2));
            around = around.union(&bounds);
            let first = self.out.polygons.len() as u32;
            let mut faces: Vec<u32> = group.iter().map(|part| part.1).collect();
            faces.dedup();
            // The largest first: the one most likely to be seen.
            faces.sort_by(|&a, &b| {
                self.polygons
                    .area(b)
                    .total_cmp(&self.polygons.area(a))
                    .then(a.cmp(&b))
            });
            let count = faces.len() as u32;
            let all = Bounds::of(&here.bounds);
            self.out
                .polygons
                .extend(faces.into_iter().map(|face| LeafFace {
                    face,
                    whole: all.holds(self.polygons.get(face).corners),
                }));
            self.out.items.push(Item {
                object: group[0].0,
                bounds,
                first,
                count,
            });
            objects.push(group[0].0);
        }
        let node = &mut self.out.nodes[number as usize];
        node.items = (first_item, self.out.items.len() as u32);
        node.bounds = around.compact();
        node.empty = around.is_empty();
        objects
    }

    fn faces(&self, id: PolygonId) -> std::ops::Range<u32> {
        let (first, end) = self.of_polygon[id.index()];
        first..end
    }
}

/// How many polygons the leaves below each kD node list.
fn costs(kd: &KdTree) -> Vec<u32> {
    let mut costs = vec![0_u32; kd.nodes().len()];
    // Children come after their parents.
    for i in (0..costs.len()).rev() {
        costs[i] = match kd.nodes()[i] {
            KdNode::Leaf { count, .. } => count,
            KdNode::Inner { lower, upper, .. } => {
                costs[lower as usize].saturating_add(costs[upper as usize])
            }
        };
    }
    costs
}

/// The box of the part of a polygon in a cell, grown by a grid step, which is more than rounding.
/// None if there is no such part, even with the growth.
fn clipped(corners: &[[f64; 3]], cell: &Bounds) -> Option<Bounds> {
    let mut polygon = corners.to_vec();
    for k in 0..3 {
        for (sign, limit) in [(1.0, cell.high[k] + 1.0), (-1.0, -(cell.low[k] - 1.0))] {
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, a) in polygon.iter().enumerate() {
                let b = &polygon[(i + 1) % polygon.len()];
                let (f, g) = (limit - sign * a[k], limit - sign * b[k]);
                if f >= 0.0 {
                    kept.push(*a);
                }
                if (f >= 0.0) != (g >= 0.0) {
                    let t = f / (f - g);
                    kept.push(std::array::from_fn(|j| a[j] + t * (b[j] - a[j])));
                }
            }
            polygon = kept;
        }
    }
    if polygon.is_empty() {
        return None;
    }
    let grown = Bounds::around(&polygon);
    let whole = Bounds::around(corners);
    let grown = Bounds {
        low: grown.low.map(|c| c.floor() - 1.0),
        high: grown.high.map(|c| c.ceil() + 1.0),
    };
    // What is whole keeps its exact box.
    Some(grown.meet(&whole)).filter(|b| !b.is_empty())
}
