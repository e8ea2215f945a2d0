//! What can be chosen, in the terms of [Bittner02, ch. 4] and [BHS98, 4 to 6].

use antumbra_scene::ObjectId;

/// How a node of the hierarchy is tested. The frustum (F) always is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// F: the frustum alone.
    Frustum,
    /// FSE: the plain occlusion tree (OBSP), where a fragment brings all its edges; the faces of the
    /// box are split on their way down.
    Standard,
    /// FME and FMC: edges that a plane on the way has made are marked and left out (MOBSP); the box is
    /// not split.
    Modified(LeafTest),
    /// As FME, with the intersection in the inner nodes, too [BHS98, 6.2]: the outline of the box is
    /// split.
    Inner,
}

/// What happens where a box crosses the plane of the occluder in a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeafTest {
    /// C: it is visible.
    Conservative,
    /// E: it is visible if it meets the pyramid of eye and occluder.
    Exact,
}

/// Where the occluders of a frame come from. All of them are *potential occluders*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Selection {
    /// The ones that hid something in the frame before, then those of each leaf that is reached, as
    /// far as their area-angle is large enough: the approximate occlusion sweep.
    Sweep,
    /// The `max_occluders` largest area-angles in leaves that were visible in the frame before, with
    /// their middle within a distance in scene units [Bittner02, 4.5].
    Previous {
        /// The distance; infinite for all visible leaves.
        distance: f64,
    },
    /// The ones that hid most from sample points of the region where the eye is, found when the culler
    /// was made; outside the scene as the others.
    Region {
        /// The most occluders of a region.
        occluders: usize,
        /// Whether the sweep adds occluders of the leaves that it reaches, as far as they are large
        /// enough. If not, what is called visible is more, in less time.
        sweep: bool,
    },
}

/// In which order chosen occluders are inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// By the distance of their boxes.
    Distance,
    /// By the squared distance of their boxes over the square root of their area-angle: the tree stays
    /// small, at the price of more late takeovers.
    Prominence,
    /// By an autopartition BSP of the chosen ones; those that a plane splits go to its near side.
    Autopartition,
}

/// A probability of the coherence methods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Probability {
    /// Always the same.
    Fixed(f64),
    /// Follows what was seen to change [Bittner02, 9.2.2].
    SelfTuned,
}

/// The smallest node that is worth a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MinimumCost {
    /// Every node is tested.
    None,
    /// Nodes whose objects have fewer polygons count as visible, and objects with fewer, too [BHS98, 5.3].
    Polygons(u32),
    /// A test is made if what it hides on average costs more to draw: from the measured cost of tests
    /// (visited nodes of the tree, some 3 ns each) and how often they hide something [BHS98, 9].
    Automatic {
        /// How many visits take as long as a draw call; 0 if all is drawn at once.
        object: f64,
        /// How many visits take as long as drawing a triangle.
        triangle: f64,
    },
}

/// What is kept from frame to frame [Bittner02, 4.11 and 9.2.2].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coherence {
    /// Hierarchy updating: inner nodes that were open are not tested.
    pub updating: bool,
    /// Conservative hierarchy updating: the probability that a visible leaf, and the objects seen in
    /// it, stay visible untested.
    pub skip: Option<Probability>,
    /// Visibility propagation along the ropes: the probability to try where it failed before.
    pub propagation: Option<Probability>,
    /// The occlusion tree is kept as long as the eye rests and no door moves, wherever the head turns;
    /// its occluders are whole, not cut by the frustum. If the head rests, too, the answer is kept.
    pub reuse_tree: bool,
}

impl Coherence {
    /// Nothing is kept but the occluders: method A of the thesis.
    pub const NONE: Self = Self {
        updating: false,
        skip: None,
        propagation: None,
        reuse_tree: false,
    };
}

/// How to cull. [`CullOptions::default`] is the fast one, [`CullOptions::tight`] the exact one.
#[derive(Clone, Debug, PartialEq)]
pub struct CullOptions {
    /// How nodes are tested.
    pub method: Method,
    /// Whether the polygons of an object whose box is seen are tested, too.
    pub polygons: bool,
    /// Where occluders come from.
    pub selection: Selection,
    /// In which order they are inserted.
    pub order: Order,
    /// The most occluders that are tried in a frame.
    pub max_occluders: usize,
    /// The smallest area-angle of an occluder, in steradians, as long as a frame is calm.
    pub min_angle: f64,
    /// A frame is calm for so many fragments that insertion visits, and as many again for every four
    /// visible objects found on the way. Beyond, the smallest area-angle grows with the fifth power, so
    /// that a frame with much to see takes more than one that only looks for it.
    pub calm_visits: u64,
    /// The most potential occluders: the largest ones.
    pub potential: usize,
    /// The share of all occluding area that potential occluders have together, at most.
    pub potential_share: f64,
    /// The least area of a potential occluder, as a share of the largest face of the box of the smallest
    /// object at its corners: what is small on its own object hides little else.
    pub potential_part: f64,
    /// Fragments that insertion may visit before it stops; a frame that needs more hides less.
    pub max_visits: u64,
    /// Leaves of the hierarchy have about so many polygons.
    pub leaf_polygons: u32,
    /// The smallest node that is worth a test.
    pub minimum_cost: MinimumCost,
    /// What is kept from frame to frame.
    pub coherence: Coherence,
    /// Whether leaves are entered for their occluders although all their objects are known to be
    /// visible.
    pub thorough: bool,
    /// Whether what was found visible is tested once more, with the occluders that were found on the
    /// way, the largest area-angle first. Visible is what both passes call visible.
    pub twice: bool,
    /// Objects that can be switched off as occluders, see [`super::Culler::set_open`].
    pub doors: Vec<ObjectId>,
    /// What the probabilities depend on.
    pub seed: u64,
}

impl Default for CullOptions {
    fn default() -> Self {
        Self {
            method: Method::Modified(LeafTest::Exact),
            polygons: true,
            selection: Selection::Sweep,
            order: Order::Prominence,
            max_occluders: 1024,
            min_angle: 1e-5,
            calm_visits: 150,
            potential: usize::MAX,
            potential_share: 1.0,
            potential_part: 0.005,
            max_visits: 10_000,
            leaf_polygons: 24,
            minimum_cost: MinimumCost::None,
            coherence: Coherence {
                updating: true,
                ..Coherence::NONE
            },
            thorough: false,
            twice: false,
            doors: Vec::new(),
            seed: 1,
        }
    }
}

impl CullOptions {
    /// Every polygon may occlude, however small: what is called visible is nearly what can be seen.
    #[must_use]
    pub fn tight() -> Self {
        Self {
            max_occluders: 4000,
            order: Order::Distance,
            min_angle: 1e-7,
            calm_visits: 1500,
            potential_part: 0.0,
            max_visits: u64::MAX,
            thorough: true,
            twice: true,
            ..Self::default()
        }
    }

    /// As in the papers: one of their methods with a number of occluders chosen from the frame before,
    /// and no test of polygons.
    #[must_use]
    pub fn paper(method: Method, occluders: usize) -> Self {
        Self {
            method,
            polygons: false,
            selection: Selection::Previous {
                distance: f64::INFINITY,
            },
            max_occluders: occluders,
            order: Order::Distance,
            min_angle: 0.0,
            calm_visits: u64::MAX,
            potential: 3600,
            potential_share: 0.99,
            potential_part: 0.0,
            max_visits: u64::MAX,
            coherence: Coherence::NONE,
            ..Self::default()
        }
    }
}
