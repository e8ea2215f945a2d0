//! Stage 1: witnesses by casting rays, each verified exactly.

use antumbra_scene::PolygonId;

use super::CellBake;
use super::live::State;
use super::source::{area, random_ray};
use crate::caster::Segment;
use crate::line::{Between, FineLine, Meeting, obstacle};
use crate::verdict::FinePoint;
use crate::verdict::{VisibleEntry, Witness};

impl CellBake<'_> {
    /// Stage 1: random rays through the source gates, as long as they find something.
    pub(super) fn cast_rays(&mut self) {
        const BATCH: usize = 192;
        const IDLE: usize = 3;
        if self.source.gates.is_empty() {
            return;
        }
        let areas: Vec<f64> = self.source.gates.iter().map(|s| area(&s.gate)).collect();
        let total: f64 = areas.iter().sum();
        let mut idle = 0;
        while idle < IDLE && !self.cancelled() {
            let mut found = false;
            for _ in 0..BATCH {
                let mut pick = self.rng.unit() * total;
                let i = areas
                    .iter()
                    .position(|a| {
                        pick -= a;
                        pick < 0.0
                    })
                    .unwrap_or(areas.len() - 1);
                let (p, d) = random_ray(&self.source.gates[i].gate, &mut self.rng);
                found |= self.follow(i, p, d);
            }
            idle = if found { 0 } else { idle + 1 };
        }
    }

    /// Follows a ray from a source gate and records every undecided object it sees. Whether any.
    pub(super) fn follow(&mut self, source: usize, p: [f64; 3], d: [f64; 3]) -> bool {
        let scene = self.baker.scene();
        let reach =
            4.0 * f64::from(antumbra_kernel::LIMIT) / d.iter().map(|c| c.abs()).fold(0.0, f64::max);
        let segment = Segment::new(p, std::array::from_fn(|k| p[k] + d[k] * reach));
        let caster = &self.baker.caster;
        let absent = self.source.absent.clone();
        let first = caster.first_hit(&segment, (0.0, 1.0), |id| {
            caster.occludes(id) && !absent.contains(&id.0)
        });
        let mut seen = false;
        if let Some((t, id)) = first {
            let object = scene.polygon(id).object;
            if self.undecided(object) && self.confirm(source, p, segment.at(t), id) {
                seen = true;
            }
        }
        if !caster.has_transparent() {
            return seen;
        }
        // What does not occlude may stand in front.
        let end = first.map_or(1.0, |(t, _)| t);
        let glass = caster.first_hit(&segment, (0.0, end), |id| {
            !caster.occludes(id)
                && !absent.contains(&id.0)
                && self.undecided(scene.polygon(id).object)
        });
        if let Some((t, id)) = glass
            && self.confirm(source, p, segment.at(t), id)
        {
            seen = true;
        }
        seen
    }

    /// Verifies a line from a source gate to a polygon exactly; records the object if it is free.
    pub(super) fn confirm(
        &mut self,
        source: usize,
        from: [f64; 3],
        to: [f64; 3],
        id: PolygonId,
    ) -> bool {
        let (u, v) = (FinePoint::round(from), FinePoint::round(to));
        if !self.sees(source, u, v, id) {
            return false;
        }
        self.record(source, u, v, id);
        true
    }

    pub(super) fn record(&mut self, source: usize, u: FinePoint, v: FinePoint, id: PolygonId) {
        let object = self.baker.scene().polygon(id).object;
        let number = self.source.gates[source].number;
        let witness = Witness {
            from: u,
            through: v,
            polygon: id,
            source: number,
        };
        self.live.set(object, State::Visible);
        self.fresh.push(witness);
        self.entries.insert(
            object,
            VisibleEntry {
                object,
                touching: false,
                witness: Some(witness),
            },
        );
    }

    pub(super) fn sees(&self, source: usize, u: FinePoint, v: FinePoint, id: PolygonId) -> bool {
        let gate = &self.source.gates[source].gate;
        let polygon = self.baker.scene().polygon(id);
        let Some(line) = FineLine::new(u, v) else {
            return false;
        };
        if !matches!(line.meeting(&gate.corners, &gate.plane), Meeting::Cross(s) if s.is_positive())
        {
            return false;
        }
        if !matches!(
            line.meeting(polygon.corners, polygon.plane),
            Meeting::Cross(_)
        ) {
            return false;
        }
        let (Some(start), Some(end)) = (line.position(&gate.plane), line.position(polygon.plane))
        else {
            return false;
        };
        if end.compare(&start) != std::cmp::Ordering::Greater {
            return false;
        }
        let between = Between {
            source: &gate.plane,
            source_plane_blocks: self.source.plane_blocks,
            target: polygon.plane,
            absent: &self.source.absent,
        };
        obstacle(&self.baker.caster, &line, &between).is_none()
    }
}
