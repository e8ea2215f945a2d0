//! Is a whole box hidden? Stages A and C for the nodes of the target hierarchy.

use antumbra_kernel::{Aabb, Point};
use antumbra_lines::Gate;
use antumbra_scene::PolygonId;

use super::CellBake;
use super::source::random_ray;
use crate::caster::Segment;
use crate::cover::{Behind, covers};
use crate::gates::{outward_face, part_in_front};
use crate::line::lies_in;
use crate::proof::{GateProof, Reason};
use crate::search::{Answer, Question};

/// Rays at a box before a proof is tried.
const PROBES: usize = 24;
/// Splits that a box may cost before its children are asked instead.
const BOX_BUDGET: u64 = 6000;

pub(super) enum Boxed {
    Hidden(Reason),
    /// A free line into the box showed an undecided object.
    Seen,
    /// Not shown to be hidden.
    Open,
}

impl CellBake<'_> {
    /// Stages A and C for a box.
    pub(super) fn hide_box(&mut self, bounds: &Aabb) -> Boxed {
        if self.source.bounds.touches(bounds) {
            return Boxed::Open;
        }
        if let Some(reason) = self.covered(&bounds.corners(), Behind::Strictly) {
            return Boxed::Hidden(reason);
        }
        if let Some(answer) = self.probe_box(bounds, PROBES) {
            return answer;
        }
        let mut gates = Vec::new();
        for source in 0..self.source.gates.len() {
            for face in 0..6 {
                let Some((from, to)) = self.gates_to_box(source, bounds, face) else {
                    continue;
                };
                let question = Question {
                    caster: &self.baker.caster,
                    from: &from,
                    to: &to,
                    source_plane_blocks: self.source.plane_blocks,
                    absent: &self.source.absent,
                    ignore_below: self.options.ignore_below,
                    cancel: self.options.cancel.as_deref(),
                    exact_witness: false,
                };
                match self.searcher.decide(&question, &mut self.rng, BOX_BUDGET) {
                    Answer::NoLines => {}
                    Answer::Hidden(tree) => {
                        gates.push(GateProof {
                            source: self.source.gates[source].number,
                            target: face,
                            tree,
                        });
                    }
                    Answer::Open(u, v) => {
                        let (p, q) = (u.to_f64(), v.to_f64());
                        let d = std::array::from_fn(|k| q[k] - p[k]);
                        return if self.follow(source, p, d) {
                            Boxed::Seen
                        } else {
                            Boxed::Open
                        };
                    }
                    Answer::Undecided(_) => return Boxed::Open,
                }
            }
        }
        Boxed::Hidden(Reason::Gates(gates))
    }

    /// A few rays at a box: most boxes that cannot be hidden show it at once, and a ray costs a
    /// hundredth of a split.
    pub(super) fn probe_box(&mut self, bounds: &Aabb, probes: usize) -> Option<Boxed> {
        let caster = &self.baker.caster;
        let absent = self.source.absent.clone();
        let (lo, hi) = (bounds.min.to_f64(), bounds.max.to_f64());
        let n = self.source.gates.len();
        if n == 0 {
            return None;
        }
        for i in 0..probes.max(2 * n) {
            let source = i % n;
            let (p, _) = random_ray(&self.source.gates[source].gate, &mut self.rng);
            let q: [f64; 3] = std::array::from_fn(|k| lo[k] + self.rng.unit() * (hi[k] - lo[k]));
            let d = std::array::from_fn(|k| q[k] - p[k]);
            let n = self.source.gates[source]
                .gate
                .plane
                .normal
                .map(|c| c as f64);
            if crate::caster::dot(n, d) <= 0.0 {
                continue;
            }
            let segment = Segment::new(p, q);
            let enter = (0..3)
                .filter(|&k| d[k] != 0.0)
                .map(|k| ((lo[k] - p[k]) / d[k]).min((hi[k] - p[k]) / d[k]))
                .fold(0.0, f64::max);
            // What lies in the box's own front does not stand before it.
            let hit = caster.first_hit(&segment, (0.0, enter * (1.0 - 1e-9)), |id| {
                caster.occludes(id) && !absent.contains(&id.0)
            });
            if hit.is_none() {
                return Some(if self.follow(source, p, d) {
                    Boxed::Seen
                } else {
                    Boxed::Open
                });
            }
        }
        None
    }

    /// The parts of a source gate and of a box face that lines can join.
    fn gates_to_box(&self, source: usize, bounds: &Aabb, face: u32) -> Option<(Gate, Gate)> {
        let source = &self.source.gates[source];
        let outward = outward_face(bounds, face)?;
        match &source.face {
            Some(face_box) => {
                // Lines enter the box: the source must lie outside of the face.
                let seen_from = part_in_front(face_box, &outward.plane)?;
                let reached = part_in_front(
                    &Aabb::around(outward.corners.iter().copied())?,
                    &source.gate.plane,
                )?;
                let from = outward_face(&seen_from, source.number)?;
                let to = outward_face(&reached, face)?.flipped();
                Some((from, to))
            }
            None => Some((source.gate.clone(), outward.flipped())),
        }
    }

    /// Stage A over the occluders that blocked lately and those between the centres.
    pub(super) fn covered(&mut self, targets: &[Point], behind: Behind) -> Option<Reason> {
        let scene = self.baker.scene();
        let caster = &self.baker.caster;
        let center = |points: &[Point]| -> [f64; 3] {
            let n = points.len() as f64;
            std::array::from_fn(|k| {
                points
                    .iter()
                    .map(|p| f64::from(p.to_array()[k]))
                    .sum::<f64>()
                    / n
            })
        };
        let mut candidates: Vec<PolygonId> = self.searcher.recent().to_vec();
        let segment = Segment::new(center(&self.source.hull), center(targets));
        caster.visit(
            &segment,
            (0.0, 1.0),
            crate::caster::SAMPLING_SLACK,
            |items, _, _| {
                for &id in items {
                    if caster.occludes(id)
                        && !self.source.absent.contains(&id.0)
                        && caster
                            .crossing(id, &segment)
                            .is_some_and(|t| (0.0..=1.0).contains(&t))
                        && !candidates.contains(&id)
                    {
                        candidates.push(id);
                    }
                }
                std::ops::ControlFlow::Continue(())
            },
        );
        candidates
            .into_iter()
            .find(|&id| {
                let polygon = scene.polygon(id);
                covers(&polygon, &self.source.hull, targets, behind)
                    && (self.source.plane_blocks || !self.hull_in_plane(id))
            })
            .map(|polygon| Reason::Covered { polygon })
    }

    fn hull_in_plane(&self, id: PolygonId) -> bool {
        let polygon = self.baker.scene().polygon(id);
        self.source
            .gates
            .iter()
            .any(|s| lies_in(&polygon, &s.gate.plane))
    }
}
