//! The approximate occlusion sweep with hierarchical visibility tests, over any line space.
//!
//! After [Bittner02, 3.2 and 3.4]: nodes of the kD-tree nearest first, the box of each tested against
//! the occlusion tree before it is opened. The order within a leaf, and of polygons that straddle
//! leaves, is only nearly right; the tree merges late, closer occluders.

mod boxes;
mod parallel;
mod point;
mod twins;
mod view;

use std::collections::BinaryHeap;

use antumbra_kernel::Aabb;
use antumbra_lines::{Leaf, LineSpace, Occluder, OcclusionTree, Visibility};
use antumbra_scene::{KdBox, KdNode, PolygonId, Scene, SeenPolygons};

pub use parallel::ParallelView;
pub use point::PointView;
pub use twins::Twins;
pub use view::{Range, Region, Sides, View};

use crate::occlusion::view::PlaneOf;

/// In which order the nodes of the kD-tree are swept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SweepOrder {
    /// Depth first, the nearer child before the farther: strict for disjoint boxes.
    #[default]
    DepthFirst,
    /// By the distance of the box, from a priority queue; for hierarchies without an order of
    /// children.
    Priority,
}

/// How the box of a kD node is tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoxTest {
    /// Not at all: every polygon is inserted.
    Never,
    /// Without splitting [Bittner02, 4.10]: fast, sometimes too careful.
    #[default]
    Conservative,
    /// With splitting: exact for the box.
    Exact,
}

/// How to sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepOptions {
    /// The order of nodes.
    pub order: SweepOrder,
    /// The test of nodes.
    pub test: BoxTest,
}

/// What a sweep did: counts that do not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepWork {
    /// Nodes of the kD-tree that were tested.
    pub nodes_tested: u64,
    /// Nodes found invisible.
    pub nodes_culled: u64,
    /// Leaves of the kD-tree that were opened.
    pub leaves_opened: u64,
    /// Leaves of the kD-tree.
    pub leaves: u64,
    /// Polygons inserted.
    pub polygons: u64,
    /// Polygons that were seen when they were inserted.
    pub seen: u64,
}

/// A finished sweep: the occlusion tree of a view, and who its occluders are.
#[derive(Clone, Debug)]
pub struct Sweep<V: View> {
    /// The view, with its line space.
    pub view: V,
    /// The tree.
    pub tree: OcclusionTree<PlaneOf<V>>,
    /// Polygon of each occluder number.
    pub polygons: Vec<PolygonId>,
    /// What was done.
    pub work: SweepWork,
}

/// Sweeps a scene: afterwards each blocked leaf of the tree holds the polygon that comes first on
/// its lines; of coincident ones the one with the smallest id, as far as `twins` lists them.
///
/// The tree starts as the view frames it. Exact; expected cost grows with what is seen.
pub fn sweep<V: View>(
    scene: &Scene,
    twins: &Twins,
    mut view: V,
    options: &SweepOptions,
) -> Sweep<V> {
    let mut tree = OcclusionTree::new();
    view.frame(&mut tree);
    let leaves = scene.kd().nodes().iter();
    let leaves = leaves.filter(|n| matches!(n, KdNode::Leaf { .. })).count() as u64;
    let mut sweeper = Sweeper {
        scene,
        twins,
        view,
        tree,
        polygons: Vec::new(),
        seen: SeenPolygons::new(),
        options: *options,
        work: SweepWork {
            leaves,
            ..SweepWork::default()
        },
    };
    match options.order {
        SweepOrder::DepthFirst => sweeper.depth_first(),
        SweepOrder::Priority => sweeper.by_priority(),
    }
    Sweep {
        view: sweeper.view,
        tree: sweeper.tree,
        polygons: sweeper.polygons,
        work: sweeper.work,
    }
}

/// As [`sweep`], for some polygons in a given order, without kD-tree and box tests.
pub fn sweep_in_order<V: View>(scene: &Scene, mut view: V, order: &[PolygonId]) -> Sweep<V> {
    let mut tree = OcclusionTree::new();
    view.frame(&mut tree);
    let twins = Twins::default();
    let mut sweeper = Sweeper {
        scene,
        twins: &twins,
        view,
        tree,
        polygons: Vec::new(),
        seen: SeenPolygons::new(),
        options: SweepOptions::default(),
        work: SweepWork::default(),
    };
    order.iter().for_each(|&id| sweeper.insert(id));
    Sweep {
        view: sweeper.view,
        tree: sweeper.tree,
        polygons: sweeper.polygons,
        work: sweeper.work,
    }
}

/// All occluders in the order in which a depth-first sweep without tests comes to them: approximately
/// front to back.
pub fn front_to_back<V: View>(scene: &Scene, view: &V) -> Vec<PolygonId> {
    let kd = scene.kd();
    let (mut order, mut seen) = (Vec::new(), SeenPolygons::new());
    let mut stack = vec![kd.root()];
    while let Some(here) = stack.pop() {
        let node = kd.nodes()[here.node as usize];
        let (Some([below, above]), KdNode::Inner { axis, at, .. }) = (kd.children(&here), node)
        else {
            let items = kd.items(here.node).iter().copied();
            order.extend(items.filter(|&id| scene.polygon(id).occludes && seen.insert(id)));
            continue;
        };
        if view.lower_first(usize::from(axis), at) {
            stack.extend([above, below]);
        } else {
            stack.extend([below, above]);
        }
    }
    order
}

struct Sweeper<'s, V: View> {
    scene: &'s Scene,
    twins: &'s Twins,
    view: V,
    tree: OcclusionTree<PlaneOf<V>>,
    polygons: Vec<PolygonId>,
    seen: SeenPolygons,
    options: SweepOptions,
    work: SweepWork,
}

impl<V: View> Sweeper<'_, V> {
    fn depth_first(&mut self) {
        let kd = self.scene.kd();
        let mut stack = vec![kd.root()];
        while let Some(here) = stack.pop() {
            if !self.opens(&here) {
                continue;
            }
            let (Some([below, above]), KdNode::Inner { axis, at, .. }) =
                (kd.children(&here), kd.nodes()[here.node as usize])
            else {
                self.leaf(here.node);
                continue;
            };
            if self.view.lower_first(usize::from(axis), at) {
                stack.extend([above, below]);
            } else {
                stack.extend([below, above]);
            }
        }
    }

    fn by_priority(&mut self) {
        let kd = self.scene.kd();
        let mut queue = BinaryHeap::new();
        queue.push(Queued::new(&self.view, kd.root()));
        while let Some(Queued { here, .. }) = queue.pop() {
            if !self.opens(&here) {
                continue;
            }
            match kd.children(&here) {
                Some(children) => {
                    queue.extend(children.map(|child| Queued::new(&self.view, child)));
                }
                None => self.leaf(here.node),
            }
        }
    }

    /// Whether anything in a node's closed box may be seen.
    fn opens(&mut self, here: &KdBox) -> bool {
        if self.options.test == BoxTest::Never {
            return true;
        }
        let leaf = matches!(
            self.scene.kd().nodes()[here.node as usize],
            KdNode::Leaf { .. }
        );
        let mut bounds = here.bounds;
        if leaf {
            let items = self.scene.kd().items(here.node);
            let Some(content) = self.content(items, &bounds) else {
                // Nothing new in it, seen or not: it counts as opened, unless it is empty.
                self.work.leaves_opened += u64::from(!items.is_empty());
                return false;
            };
            bounds = content;
        }
        self.work.nodes_tested += 1;
        let mark = self.view.mark();
        let state = match self.view.region(&bounds) {
            Region::Touching => Visibility::Partial,
            Region::Nowhere => Visibility::Invisible,
            Region::Piece(piece) => self.test(&bounds, leaf, piece),
        };
        self.view.rewind(mark);
        let opens = state != Visibility::Invisible;
        self.work.nodes_culled += u64::from(!opens);
        opens
    }

    /// The smallest box around what a leaf holds of polygons that are not in the tree yet; `None` if there are none.
    fn content(&self, items: &[PolygonId], leaf: &Aabb) -> Option<Aabb> {
        let new = items.iter().filter(|&&id| !self.seen.contains(id));
        let polygons = new.map(|&id| self.scene.polygon(id));
        let boxes = polygons.filter(|p| p.occludes).map(|p| p.bounds());
        let around = boxes.reduce(Aabb::union)?;
        Some(around.intersection(leaf).unwrap_or(*leaf))
    }

    fn test(
        &mut self,
        bounds: &Aabb,
        leaf: bool,
        piece: <V::Space as LineSpace>::Piece,
    ) -> Visibility {
        let (polygons, scene) = (&self.polygons, self.scene);
        let sides = self.view.sides();
        let hidden = |old: Occluder| {
            let polygon = scene.polygon(polygons[old.0 as usize]);
            sides.behind(bounds, polygon.plane)
        };
        // Most boxes are seen, and most of those in their middle: one way down the tree.
        let middle = bounds.center_doubled().map(|c| c.div_euclid(2) as i32);
        let ray = self.view.line_through(middle.into());
        let near = self.view.near(bounds);
        let space = self.view.space();
        let seen = match self.tree.leaf_at(space, &ray) {
            Leaf::Open => true,
            Leaf::Outside => false,
            Leaf::Blocked(old) => !hidden(old),
        };
        if seen {
            LineSpace::discard(space, piece);
            return Visibility::Partial;
        }
        if self.options.test == BoxTest::Conservative {
            let state = self
                .tree
                .test_without_splitting_at(space, &piece, near, hidden);
            // An exact test of a leaf costs less than to insert what it holds.
            if state == Visibility::Invisible || !leaf {
                LineSpace::discard(space, piece);
                return state;
            }
        }
        self.tree.test_region_at(space, piece, near, |_, _, old| {
            if hidden(old) {
                Visibility::Invisible
            } else {
                Visibility::Partial
            }
        })
    }

    fn leaf(&mut self, node: u32) {
        self.work.leaves_opened += 1;
        let scene = self.scene;
        for &id in scene.kd().items(node) {
            self.insert(id);
        }
    }

    /// Inserts a polygon that was not inserted before; one that is seen brings those coincident
    /// with it, which a box test may have called hidden, and those in turn.
    fn insert(&mut self, id: PolygonId) {
        if !self.insert_one(id) {
            return;
        }
        let twins = self.twins;
        let mut seen = vec![id];
        while let Some(id) = seen.pop() {
            seen.extend(twins.of(id).iter().filter(|&&twin| self.insert_one(twin)));
        }
    }

    fn insert_one(&mut self, id: PolygonId) -> bool {
        let polygon = self.scene.polygon(id);
        if !polygon.occludes || !self.seen.insert(id) {
            return false;
        }
        let mark = self.view.mark();
        let Some((piece, occluder)) = self.view.occluder(&polygon) else {
            return false;
        };
        self.work.polygons += 1;
        let range = self.view.range(&polygon);
        let far = |space: &V::Space, piece: &_| V::far(space, piece, occluder).min(range.far);
        let space = self.view.space();
        let seen = self.tree.insert_at(space, piece, occluder, range.near, far);
        if seen {
            self.work.seen += 1;
            self.polygons.push(id);
        } else {
            self.view.rewind(mark);
        }
        seen
    }
}

/// A node in the queue: the nearest box first, then the smallest number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Queued {
    distance: u128,
    here: KdBox,
}

impl Queued {
    fn new<V: View>(view: &V, here: KdBox) -> Self {
        let distance = view.distance(&here.bounds);
        Self { distance, here }
    }
}

impl Ord for Queued {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        // The queue gives its largest element.
        (other.distance, other.here.node).cmp(&(self.distance, self.here.node))
    }
}

impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
