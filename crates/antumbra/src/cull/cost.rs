//! Which tests are worth making: what they cost, against the drawing that they save.
//!
//! After [Bittner02, 4.11.2] and [BHS98, 5.3]; the minimum cost is found from counts as [BHS98, 9]
//! proposes: by the speed of drawing, the speed of tests, and how often tests succeed.

use antumbra_scene::Scene;

use super::hierarchy::Hierarchy;
use super::options::MinimumCost;

/// What drawing objects and nodes costs, and what tests have cost so far.
pub(super) struct Costs {
    rule: MinimumCost,
    /// Of each object: its polygons, or visits.
    pub objects: Vec<f32>,
    /// Of each node of the hierarchy: all its objects, once each.
    pub nodes: Vec<f32>,
    /// Tests of nodes.
    pub of_nodes: Pay,
    /// Tests of the boxes and polygons of objects.
    pub of_items: Pay,
}

/// What one kind of test costs and brings.
#[derive(Clone, Copy)]
pub(super) struct Pay {
    /// Visited nodes of the occlusion tree a test, and the share of tests that hide.
    visits: f64,
    share: f64,
    /// Tests, visits and hidden ones of this frame.
    frame: [u64; 3],
}

impl Pay {
    /// As if tests were cheap and good, so that they are tried.
    const NEW: Self = Self {
        visits: 30.0,
        share: 0.5,
        frame: [0; 3],
    };

    pub(super) fn add(&mut self, visits: u64, hidden: bool) {
        self.frame[0] += 1;
        self.frame[1] += visits;
        self.frame[2] += u64::from(hidden);
    }

    /// Moves an eighth of the way to the means of a frame.
    fn learn(&mut self) {
        let [tests, visits, hidden] = std::mem::take(&mut self.frame).map(|n| n as f64);
        if tests > 0.0 {
            self.visits += (visits / tests - self.visits) / 8.0;
            self.share += (hidden / tests - self.share) / 8.0;
        }
    }

    /// A test pays if what it hides, on average, costs more than the test. Few tests find little: below
    /// a tenth the share would pull itself down.
    fn least(&self) -> f32 {
        (self.visits / self.share.max(0.1)) as f32
    }
}

impl Costs {
    /// Only what the rule needs.
    pub(super) fn new(rule: MinimumCost, scene: &Scene, hierarchy: &Hierarchy) -> Self {
        let (object, polygon, triangle) = match rule {
            MinimumCost::None => (0.0, 0.0, 0.0),
            MinimumCost::Polygons(_) => (0.0, 1.0, 0.0),
            MinimumCost::Automatic { object, triangle } => (object, 0.0, triangle),
        };
        let mut objects = vec![object as f32; scene.objects().len()];
        for p in scene.polygons() {
            objects[p.object.index()] += (polygon + triangle * (p.corners.len() - 2) as f64) as f32;
        }
        let nodes = match rule {
            MinimumCost::None => Vec::new(),
            _ => of_nodes(hierarchy, &objects),
        };
        Self {
            rule,
            objects,
            nodes,
            of_nodes: Pay::NEW,
            of_items: Pay::NEW,
        }
    }

    /// The least cost that is worth a test of a node, and of an object.
    pub(super) fn least(&self) -> [f32; 2] {
        match self.rule {
            MinimumCost::None => [f32::NEG_INFINITY; 2],
            MinimumCost::Polygons(n) => [n as f32; 2],
            MinimumCost::Automatic { .. } => [self.of_nodes.least(), self.of_items.least()],
        }
    }

    pub(super) fn of_node(&self, node: u32) -> f32 {
        self.nodes.get(node as usize).copied().unwrap_or(0.0)
    }

    /// Forgets what tests have cost.
    pub(super) fn start_anew(&mut self) {
        self.of_nodes = Pay::NEW;
        self.of_items = Pay::NEW;
    }

    /// After a frame.
    pub(super) fn learn(&mut self) {
        self.of_nodes.learn();
        self.of_items.learn();
    }
}

/// The sum over the objects in each node.
fn of_nodes(hierarchy: &Hierarchy, objects: &[f32]) -> Vec<f32> {
    let mut inside: Vec<Vec<u32>> = vec![Vec::new(); hierarchy.nodes.len()];
    let mut costs = vec![0.0; hierarchy.nodes.len()];
    // Children come after their parents.
    for (i, node) in hierarchy.nodes.iter().enumerate().rev() {
        let mut all: Vec<u32> = match node.children {
            Some(children) => children
                .iter()
                .flat_map(|&c| std::mem::take(&mut inside[c as usize]))
                .collect(),
            None => {
                let items = &hierarchy.items[node.items.0 as usize..node.items.1 as usize];
                items.iter().map(|item| item.object).collect()
            }
        };
        all.sort_unstable();
        all.dedup();
        costs[i] = all.iter().map(|&o| objects[o as usize]).sum();
        inside[i] = all;
    }
    costs
}
