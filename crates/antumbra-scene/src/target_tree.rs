//! A hierarchy of what may be seen: objects, then the polygons of each object.
//!
//! Verdicts are about objects, so a tree whose upper nodes are sets of whole objects lets one
//! proof hide many of them; below a single object the tree goes on over its polygons. The
//! kD-tree, whose leaves cut objects apart, serves for casting and for gathering occluders.

use antumbra_kernel::Aabb;

use crate::{ObjectId, PolygonId, Scene};

/// A node of a [`TargetTree`].
#[derive(Clone, Copy, Debug)]
pub struct TargetNode {
    /// The box around everything below.
    pub bounds: Aabb,
    /// The object that everything below belongs to, if it is one.
    pub object: Option<ObjectId>,
    /// What is below.
    pub kind: TargetKind,
    /// The places, in the order of the tree, of the objects below (see [`TargetTree::place`]).
    pub first: u32,
    /// How many objects are below.
    pub count: u32,
    /// The node above; the root is its own.
    pub parent: u32,
}

impl TargetNode {
    fn new(bounds: Aabb, object: Option<ObjectId>, kind: TargetKind) -> Self {
        Self {
            bounds,
            object,
            kind,
            first: 0,
            count: 0,
            parent: 0,
        }
    }

    /// The places of the objects below.
    #[must_use]
    pub fn places(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// What is below a [`TargetNode`].
#[derive(Clone, Copy, Debug)]
pub enum TargetKind {
    /// Two nodes.
    Inner(u32, u32),
    /// One polygon.
    Polygon(PolygonId),
}

/// A binary bounding-volume hierarchy over the objects of a scene and their polygons.
#[derive(Clone, Debug)]
pub struct TargetTree {
    nodes: Vec<TargetNode>,
    root: Option<u32>,
    roots: Vec<Option<u32>>,
    /// Objects in the order of the tree, and the place of each in that order.
    order: Vec<ObjectId>,
    places: Vec<u32>,
}

struct Item {
    bounds: Aabb,
    node: u32,
}

impl TargetTree {
    /// Builds the hierarchy by binned surface-area splits; `n log n`.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let mut nodes = Vec::with_capacity(2 * scene.polygon_count());
        let mut roots = Vec::with_capacity(scene.objects().len());
        let mut objects = Vec::new();
        for (i, object) in scene.objects().iter().enumerate() {
            let id = ObjectId(i as u32);
            let mut items: Vec<Item> = object
                .polygons
                .clone()
                .map(|p| {
                    let polygon = PolygonId(p);
                    let bounds = scene.polygon(polygon).bounds();
                    let kind = TargetKind::Polygon(polygon);
                    nodes.push(TargetNode::new(bounds, Some(id), kind));
                    Item {
                        bounds,
                        node: nodes.len() as u32 - 1,
                    }
                })
                .collect();
            let root = build(&mut nodes, &mut items, Some(id));
            if let Some(root) = root {
                objects.push(Item {
                    bounds: nodes[root as usize].bounds,
                    node: root,
                });
            }
            roots.push(root);
        }
        let root = build(&mut nodes, &mut objects, None);
        let mut tree = Self {
            nodes,
            root,
            roots,
            order: Vec::with_capacity(objects.len()),
            places: vec![u32::MAX; scene.objects().len()],
        };
        if let Some(root) = root {
            tree.number(root, root);
        }
        // Objects without polygons come last.
        for i in 0..tree.places.len() {
            if tree.places[i] == u32::MAX {
                tree.places[i] = tree.order.len() as u32;
                tree.order.push(ObjectId(i as u32));
            }
        }
        tree
    }

    /// Gives the objects below a node their places.
    fn number(&mut self, index: u32, parent: u32) {
        let node = self.nodes[index as usize];
        let mut first = self.order.len() as u32;
        match node.object {
            Some(object) if self.places[object.index()] == u32::MAX => {
                self.places[object.index()] = first;
                self.order.push(object);
            }
            Some(object) => first = self.places[object.index()],
            None => {}
        }
        if let TargetKind::Inner(a, b) = node.kind {
            self.number(a, index);
            self.number(b, index);
        }
        let end = self.order.len() as u32;
        let node = &mut self.nodes[index as usize];
        (node.first, node.count, node.parent) = (first, end - first, parent);
    }

    /// The place of an object in the order of the tree, in which every node covers a range.
    #[must_use]
    pub fn place(&self, id: ObjectId) -> usize {
        self.places[id.index()] as usize
    }

    /// The object at a place.
    #[must_use]
    pub fn object_at(&self, place: usize) -> ObjectId {
        self.order[place]
    }

    /// How many nodes there are.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// The node over all objects; `None` for an empty scene.
    #[must_use]
    pub fn root(&self) -> Option<u32> {
        self.root
    }

    /// The node over one object; `None` if it has no polygons.
    #[must_use]
    pub fn object_root(&self, id: ObjectId) -> Option<u32> {
        self.roots[id.index()]
    }

    /// A node.
    #[must_use]
    pub fn node(&self, index: u32) -> &TargetNode {
        &self.nodes[index as usize]
    }
}

fn build(nodes: &mut Vec<TargetNode>, items: &mut [Item], object: Option<ObjectId>) -> Option<u32> {
    match items {
        [] => None,
        [one] => Some(one.node),
        _ => {
            let at = partition(items);
            let (a, b) = items.split_at_mut(at);
            let (left, right) = (build(nodes, a, object)?, build(nodes, b, object)?);
            let bounds = nodes[left as usize]
                .bounds
                .union(nodes[right as usize].bounds);
            nodes.push(TargetNode::new(
                bounds,
                object,
                TargetKind::Inner(left, right),
            ));
            Some(nodes.len() as u32 - 1)
        }
    }
}

const BINS: usize = 16;

/// Orders the items so that a cheap split lies at the returned place, never at an end.
fn partition(items: &mut [Item]) -> usize {
    let mut lo = [i64::MAX; 3];
    let mut hi = [i64::MIN; 3];
    for item in items.iter() {
        let c = item.bounds.center_doubled();
        for k in 0..3 {
            lo[k] = lo[k].min(c[k]);
            hi[k] = hi[k].max(c[k]);
        }
    }
    let axis = (0..3).max_by_key(|&k| hi[k] - lo[k]).unwrap_or(0);
    let width = hi[axis] - lo[axis];
    if width == 0 {
        return items.len() / 2;
    }
    let bin =
        |b: &Aabb| ((b.center_doubled()[axis] - lo[axis]) * BINS as i64 / (width + 1)) as usize;
    let mut boxes: [Option<Aabb>; BINS] = [None; BINS];
    let mut counts = [0_usize; BINS];
    for item in items.iter() {
        let b = bin(&item.bounds);
        counts[b] += 1;
        boxes[b] = Some(boxes[b].map_or(item.bounds, |x| x.union(item.bounds)));
    }
    let (below, above) = (running(&boxes, &counts), {
        let (mut boxes, mut counts) = (boxes, counts);
        boxes.reverse();
        counts.reverse();
        running(&boxes, &counts)
    });
    let best = (1..BINS)
        .filter(|&s| below[s].count > 0 && above[BINS - s].count > 0)
        .map(|s| (s, below[s].cost() + above[BINS - s].cost()))
        .min_by(|(_, a), (_, b)| a.total_cmp(b))
        .map(|(s, _)| s);
    let Some(best) = best else {
        return items.len() / 2;
    };
    items.sort_by_key(|i| bin(&i.bounds) >= best);
    below[best].count
}

/// The first so many bins together.
#[derive(Clone, Copy, Default)]
struct Part {
    bounds: Option<Aabb>,
    count: usize,
}

impl Part {
    fn cost(&self) -> f64 {
        self.bounds.map_or(0.0, |b| {
            let e = b.extent().map(|c| c as f64);
            self.count as f64 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0])
        })
    }
}

/// For each number of bins, those before it together.
fn running(boxes: &[Option<Aabb>; BINS], counts: &[usize; BINS]) -> [Part; BINS] {
    let mut parts = [Part::default(); BINS];
    for i in 1..BINS {
        let before = parts[i - 1];
        let bounds = match (before.bounds, boxes[i - 1]) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        parts[i] = Part {
            bounds,
            count: before.count + counts[i - 1],
        };
    }
    parts
}
