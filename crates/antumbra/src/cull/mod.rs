//! Real-time culling: which objects a camera may see, every frame, on the processor, never wrong.
//!
//! After [Bittner02, ch. 4] and [BHS98, 4 to 6]: the kD-tree of the scene is swept from the eye; nodes, and the
//! boxes and polygons of objects, are tested against an occlusion tree of a few large occluders. Signs
//! are floats with a proved bound, and whatever is doubtful counts as *visible*, so an object that is
//! left out cannot be seen: it may be culled. See `docs/notes/cull.md`.
//!
//! ```
//! use antumbra::cull::{Camera, Culler};
//! use antumbra::scene::{SceneBuilder, synth};
//!
//! let input = synth::maze(&synth::MazeParams { rooms: 5, furniture: 4, seed: 1 });
//! let (scene, _) = SceneBuilder::new(input).build()?;
//! let mut culler = Culler::new(&scene);
//! // Each frame:
//! let camera = Camera::new([7.5, 7.5, 1.6], [1.0, 0.3, 0.0], [0.0, 0.0, 1.0], 60.0, 16.0 / 9.0)?;
//! let visible = culler.cull(&camera);
//! assert!(visible.objects().len() < scene.objects().len() / 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bound;
mod camera;
mod cells;
mod coherence;
mod cost;
mod faces;
mod fragment;
mod hierarchy;
mod options;
mod region;
mod select;
mod sweep;
mod tree;

use antumbra_kernel::Grid;
use antumbra_scene::{KdTree, ObjectId, Scene};

use coherence::{Chance, Memory, Propagation};
use cost::Costs;
use faces::{Faces, Lines};
use hierarchy::Hierarchy;
use region::Regions;
use select::Occluders;
use tree::Tree;

pub use camera::{Camera, CameraError};
pub use cells::{Cell, CellState};
pub use options::{
    Coherence, CullOptions, LeafTest, Method, MinimumCost, Order, Probability, Selection,
};

/// What a camera may see. Everything else is surely hidden or outside the frustum.
#[derive(Clone, Debug, Default)]
pub struct Visible {
    objects: Vec<ObjectId>,
    /// The frame in which each object was last visible.
    frames: Vec<u32>,
    frame: u32,
    work: CullWork,
}

impl Visible {
    /// The objects, by id.
    #[must_use]
    pub fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    /// Whether an object is among them.
    #[must_use]
    pub fn contains(&self, object: ObjectId) -> bool {
        self.frame > 0 && self.frames.get(object.index()) == Some(&self.frame)
    }

    /// What was done for it.
    #[must_use]
    pub fn work(&self) -> &CullWork {
        &self.work
    }
}

/// Counts of a frame; they do not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CullWork {
    /// Nodes of the hierarchy tested.
    pub node_tests: u64,
    /// Those of them that were found invisible.
    pub nodes_hidden: u64,
    /// Nodes taken as open because they were in the frame before.
    pub nodes_skipped: u64,
    /// Leaves that stayed visible untested.
    pub leaves_kept: u64,
    /// Nodes found invisible along their ropes.
    pub nodes_propagated: u64,
    /// Boxes of objects in leaves tested.
    pub item_tests: u64,
    /// Polygons tested.
    pub polygon_tests: u64,
    /// Occluders tried.
    pub occluders_tried: u64,
    /// Occluders in the tree.
    pub occluders: u64,
    /// Nodes of the occlusion tree.
    pub tree_nodes: u64,
    /// Nodes of the occlusion tree visited by tests.
    pub tree_steps: u64,
    /// Nodes of the occlusion tree visited by fragments of occluders.
    pub tree_visits: u64,
    /// Whether the tree of the frame before served again.
    pub tree_reused: bool,
}

/// Culls the frames of one view. Made once for a scene; keeps what it needs of it.
///
/// After it is made nothing is allocated any more. Results depend on the frames before (and on the seed,
/// if a probability is used), never on the machine.
pub struct Culler {
    options: CullOptions,
    grid: Grid,
    kd: KdTree,
    hierarchy: Hierarchy,
    polygons: Faces,
    occluders: Occluders,
    tree: Tree,
    visible: Visible,
    /// The look in which each face was last found hidden. Then it is, whatever is inserted after.
    hidden: Vec<u32>,
    /// The frame in which each occluder was last tried.
    tried: Vec<u32>,
    /// The occluders in the tree, by their number there.
    planted: Vec<u32>,
    /// Occluders chosen for a frame, with a key.
    chosen: Vec<(f64, u32)>,
    /// Occluders of a leaf, with their distance.
    near: Vec<(f64, u32)>,
    /// Objects that do not occlude now.
    open: Vec<bool>,
    memory: Vec<Memory>,
    /// The number of the first look at the last frame; none is `u32::MAX`.
    first_look: u32,
    /// The first look whose open nodes stay open.
    looked: u32,
    seen_leaves: Vec<u32>,
    stack: Vec<(u32, u32)>,
    propagation: Option<Propagation>,
    skip: Chance,
    propagate: Chance,
    random: u64,
    costs: Costs,
    regions: Regions,
    /// Visits before the sweep if occluders of a region are given: they are not weighed.
    given: u64,
    /// The eye of the tree; none if there is no tree to use again.
    eye: Option<[f64; 3]>,
    /// The camera of the last frame.
    rests: Option<Camera>,
}

/// An object that was not named as a door when the culler was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "object {} is not a door: list it in `CullOptions::doors`, so that its polygons are kept apart",
    .0.0
)]
pub struct NotADoor(pub ObjectId);

impl Culler {
    /// A culler with default options.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        Self::with_options(scene, CullOptions::default())
    }

    /// A culler. Expected time proportional to the polygons, times a logarithm; with
    /// [`Selection::Region`] also some 8,000 frames.
    #[must_use]
    pub fn with_options(scene: &Scene, options: CullOptions) -> Self {
        let mut lines = Lines::default();
        let mut polygons = Faces::new();
        let of_polygon: Vec<(u32, u32)> = scene
            .polygons()
            .map(|p| {
                let first = polygons.len() as u32;
                polygons.push(&mut lines, p.corners, p.plane.normal);
                (first, polygons.len() as u32)
            })
            .collect();
        let occluders = Occluders::new(scene, &mut lines, &options);
        let leaf_polygons = options.leaf_polygons;
        let hierarchy = Hierarchy::new(
            scene,
            &polygons,
            &of_polygon,
            &occluders.faces,
            leaf_polygons,
        );
        let count = occluders.faces.len();
        let objects = scene.objects().len();
        let in_leaf = |node: &hierarchy::HierarchyNode| node.occluders.1 - node.occluders.0;
        let most_in_a_leaf = hierarchy.nodes.iter().map(in_leaf).max().unwrap_or(0) as usize;
        let regional = match options.selection {
            Selection::Region { occluders, .. } => Some(occluders),
            _ => None,
        };
        let most = match regional {
            Some(_) => options.max_occluders.max(region::TRIED),
            None => options.max_occluders,
        };
        let most = most.min(count);
        let coherence = options.coherence;
        let mut culler = Self {
            grid: *scene.grid(),
            kd: scene.kd().clone(),
            hidden: vec![0; polygons.len()],
            polygons,
            // A fragment of an occluder brings few nodes.
            tree: Tree::new((32 * most).clamp(1024, 1 << 18), most),
            visible: Visible {
                objects: Vec::with_capacity(objects),
                frames: vec![0; objects],
                ..Visible::default()
            },
            tried: vec![0; count],
            planted: Vec::with_capacity(most),
            chosen: Vec::with_capacity(count),
            near: Vec::with_capacity(most_in_a_leaf),
            open: vec![false; objects],
            memory: vec![Memory::NEW; hierarchy.nodes.len()],
            first_look: u32::MAX,
            looked: u32::MAX,
            seen_leaves: Vec::with_capacity(hierarchy.nodes.len()),
            stack: Vec::with_capacity(2 * scene.kd().depth() + 8),
            propagation: coherence.propagation.map(|_| Propagation::new(scene.kd())),
            skip: Chance::new(coherence.skip),
            propagate: Chance::new(coherence.propagation),
            random: options.seed | 1,
            costs: Costs::new(options.minimum_cost, scene, &hierarchy),
            regions: Regions::default(),
            given: 0,
            eye: None,
            rests: None,
            hierarchy,
            occluders,
            options,
        };
        if let Some(occluders) = regional {
            culler.look_around(occluders);
        }
        culler
    }

    /// What the culler was made with.
    #[must_use]
    pub fn options(&self) -> &CullOptions {
        &self.options
    }

    /// How many potential occluders there are.
    #[must_use]
    pub fn potential_occluders(&self) -> usize {
        self.occluders.faces.len()
    }

    /// How many nodes the hierarchy has.
    #[must_use]
    pub fn hierarchy_nodes(&self) -> usize {
        self.hierarchy.nodes.len()
    }

    /// Opens a door, which then hides nothing, or closes it again; from the next frame on.
    ///
    /// # Errors
    /// If the object was not named as a door.
    pub fn set_open(&mut self, door: ObjectId, open: bool) -> Result<(), NotADoor> {
        if !self.options.doors.contains(&door) || door.index() >= self.open.len() {
            return Err(NotADoor(door));
        }
        if self.open[door.index()] != open {
            self.open[door.index()] = open;
            // The tree that there is knows the door as it was.
            self.eye = None;
        }
        Ok(())
    }

    /// The answer of the last frame; nothing before the first.
    #[must_use]
    pub fn visible(&self) -> &Visible {
        &self.visible
    }
}
