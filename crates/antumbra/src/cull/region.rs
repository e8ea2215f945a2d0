//! Occluders of regions, found beforehand.
//!
//! [BHS98, 9] proposes to compute the occluders of a region by samples of what an occluder is worth. Here
//! the culler itself looks around from several points of a region, and an occluder is worth as many
//! tests as it was the one to hide something in.

use antumbra_kernel::Point;

use super::coherence::Chance;
use super::options::{Coherence, Selection};
use super::{Camera, Culler};

/// So many regions: the cells of the kD-tree that come out if the largest is parted again and again.
const REGIONS: usize = 256;
/// Occluders tried in a look around.
pub(super) const TRIED: usize = 2048;

/// The lists of all regions.
#[derive(Default)]
pub(super) struct Regions {
    /// For each node of the hierarchy the number of its list.
    of_node: Vec<Option<u32>>,
    lists: Vec<Vec<u32>>,
}

impl Regions {
    /// The best occluders, the most valued first, of the region that a leaf is in.
    pub(super) fn of(&self, leaf: u32, parent: impl Fn(u32) -> u32) -> &[u32] {
        let mut node = leaf;
        loop {
            match self.of_node.get(node as usize) {
                Some(Some(list)) => return &self.lists[*list as usize],
                Some(None) if parent(node) != node => node = parent(node),
                _ => return &[],
            }
        }
    }
}

impl Culler {
    /// Finds the occluders of all regions, with all doors closed: as long as 30 frames a region.
    pub(super) fn look_around(&mut self, count: usize) {
        let before = self.options.clone();
        self.options.selection = Selection::Sweep;
        self.options.max_occluders = TRIED;
        self.options.twice = false;
        self.options.coherence = Coherence {
            updating: true,
            ..Coherence::NONE
        };
        let chances = (self.skip, self.propagate, self.random);
        self.skip = Chance::new(None);
        let nodes = self.parted();
        let mut regions = Regions {
            of_node: vec![None; self.hierarchy.nodes.len()],
            lists: Vec::with_capacity(nodes.len()),
        };
        let mut worth = vec![0_u64; self.occluders.faces.len()];
        for node in nodes {
            worth.fill(0);
            for eye in self.samples(node) {
                self.look_from(eye, &mut worth);
            }
            let mut list: Vec<u32> = (0..worth.len() as u32)
                .filter(|&o| worth[o as usize] > 0)
                .collect();
            list.sort_by_key(|&o| (std::cmp::Reverse(worth[o as usize]), o));
            list.truncate(count);
            regions.of_node[node as usize] = Some(regions.lists.len() as u32);
            regions.lists.push(list);
        }
        self.regions = regions;
        self.options = before;
        (self.skip, self.propagate, self.random) = chances;
        self.costs.start_anew();
        self.start_anew();
    }

    /// The cells of the regions.
    fn parted(&self) -> Vec<u32> {
        let volume = |n: &u32| {
            let cell = self.hierarchy.cells[*n as usize].bounds;
            let (low, high) = (cell.min.to_f64(), cell.max.to_f64());
            (0..3).map(|k| high[k] - low[k]).product::<f64>()
        };
        let mut parts: Vec<u32> = Vec::new();
        let mut open: Vec<u32> = if self.hierarchy.nodes.is_empty() {
            Vec::new()
        } else {
            vec![0]
        };
        while parts.len() + open.len() < REGIONS {
            let largest =
                (0..open.len()).max_by(|&a, &b| volume(&open[a]).total_cmp(&volume(&open[b])));
            let Some(i) = largest else { break };
            let node = open.swap_remove(i);
            match self.hierarchy.nodes[node as usize].children {
                Some(children) => open.extend(children),
                None => parts.push(node),
            }
        }
        parts.extend(open);
        parts
    }

    /// The middle of a cell, and four points between it and corners that share no edge.
    fn samples(&self, node: u32) -> [[f64; 3]; 5] {
        let cell = self.hierarchy.cells[node as usize].bounds;
        let (low, high) = (cell.min.to_f64(), cell.max.to_f64());
        [
            [0.5, 0.5, 0.5],
            [0.2, 0.2, 0.2],
            [0.8, 0.8, 0.2],
            [0.8, 0.2, 0.8],
            [0.2, 0.8, 0.8],
        ]
        .map(|t| {
            let at = std::array::from_fn(|k| (low[k] + t[k] * (high[k] - low[k])).round());
            let [x, y, z] = at.map(|c: f64| c as i32);
            self.grid.to_scene(Point::new(x, y, z))
        })
    }

    /// Looks in all six directions and counts what hides something.
    fn look_from(&mut self, eye: [f64; 3], worth: &mut [u64]) {
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let (mut ahead, mut up) = ([0.0; 3], [0.0; 3]);
                ahead[axis] = sign;
                up[(axis + 1) % 3] = 1.0;
                let Ok(camera) = Camera::new(eye, ahead, up, 90.0, 1.0) else {
                    continue;
                };
                self.cull(&camera);
                for (&occluder, &hits) in self.planted.iter().zip(&self.tree.hits) {
                    worth[occluder as usize] += u64::from(hits);
                }
            }
        }
    }
}
