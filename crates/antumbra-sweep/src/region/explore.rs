//! Aimed rays: what is visible is found before anything is proved hidden.
//!
//! A proof pays most where it hides everything left at once, and it can only be tried on boxes
//! that hold nothing visible. So the hierarchy is first walked with rays alone: into boxes that
//! some ray reaches, and at the objects in them.

use std::ops::Range;

use antumbra_scene::{PolygonId, TargetKind};

use super::boxes::Boxed;
use super::source::random_ray;
use super::{BOX_TRIES, CellBake};
use crate::caster::Segment;

/// Rays at the box around an object, and at most at one around many.
const PROBES: usize = 64;
const MOST_PROBES: usize = 600;
/// Rays at each object that a ray may reach.
const AIMED: usize = 128;

impl CellBake<'_> {
    /// Casts rays at what is undecided below a node; records what they see.
    pub(super) fn explore(&mut self, index: u32) {
        let node = *self.baker.targets.node(index);
        if let Some(object) = node.object {
            let polygons = self.baker.scene().object(object).polygons.clone();
            self.aim_at(polygons, AIMED);
            return;
        }
        for _ in 0..BOX_TRIES {
            if self.cancelled() {
                return;
            }
            let Some(bounds) = self.live.bounds(index) else {
                return;
            };
            if self.source.bounds.touches(&bounds) {
                break;
            }
            let probes = PROBES + 16 * self.live.left(index) as usize;
            match self.probe_box(&bounds, probes.min(MOST_PROBES)) {
                None => return,
                Some(Boxed::Seen) => self.look_around(),
                Some(_) => break,
            }
        }
        if let TargetKind::Inner(a, b) = node.kind {
            let (a, b) = self.nearer_first(a, b);
            self.explore(a);
            self.explore(b);
        }
    }

    /// Casts rays at random points of an object's polygons until one is seen.
    pub(super) fn aim_at(&mut self, polygons: Range<u32>, rays: usize) {
        let scene = self.baker.scene();
        let n = self.source.gates.len();
        if n == 0 || polygons.is_empty() {
            return;
        }
        let object = scene.polygon(PolygonId(polygons.start)).object;
        for _ in 0..rays {
            if !self.undecided(object) {
                return;
            }
            let source = (self.rng.bits() % n as u64) as usize;
            let polygon = polygons.start + (self.rng.bits() % polygons.len() as u64) as u32;
            let q = self.random_point(PolygonId(polygon));
            let gate = &self.source.gates[source].gate;
            let (p, _) = random_ray(gate, &mut self.rng);
            let d: [f64; 3] = std::array::from_fn(|k| q[k] - p[k]);
            if crate::caster::dot(gate.plane.normal.map(|c| c as f64), d) <= 0.0 {
                continue;
            }
            let caster = &self.baker.caster;
            let absent = &self.source.absent;
            let segment = Segment::new(p, q);
            let hit = caster.first_hit(&segment, (0.0, 1.0 - 1e-9), |id| {
                caster.occludes(id) && !absent.contains(&id.0)
            });
            if hit.is_none() {
                self.confirm(source, p, q, PolygonId(polygon));
            }
        }
    }

    /// Casts rays beside those that were hard to find: what is seen through a small gap is seldom
    /// alone there. After the mutation of rays in [Wonka06].
    pub(super) fn look_around(&mut self) {
        const BESIDE: usize = 24;
        while let Some(witness) = self.fresh.pop() {
            let source = self
                .source
                .gates
                .iter()
                .position(|g| g.number == witness.source);
            let Some(source) = source else { continue };
            let bounds = self.baker.scene().polygon(witness.polygon).bounds();
            let (lo, hi) = (bounds.min.to_f64(), bounds.max.to_f64());
            let from = witness.from.to_f64();
            for _ in 0..BESIDE {
                let (other, _) = random_ray(&self.source.gates[source].gate, &mut self.rng);
                let r = 0.25 * self.rng.unit();
                let p: [f64; 3] = std::array::from_fn(|k| from[k] + r * (other[k] - from[k]));
                let q: [f64; 3] = std::array::from_fn(|k| {
                    let t = 2.0 * self.rng.unit() - 0.5;
                    lo[k] + t * (hi[k] - lo[k])
                });
                self.follow(source, p, std::array::from_fn(|k| q[k] - p[k]));
            }
        }
    }

    /// A point inside a polygon: a random positive combination of its corners.
    fn random_point(&mut self, id: PolygonId) -> [f64; 3] {
        let polygon = self.baker.scene().polygon(id);
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for corner in polygon.corners {
            let w = self.rng.unit() + 1e-3;
            total += w;
            let c = corner.to_f64();
            for k in 0..3 {
                sum[k] += w * c[k];
            }
        }
        sum.map(|c| c / total)
    }
}
