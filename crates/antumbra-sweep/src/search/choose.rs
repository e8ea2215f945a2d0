//! Which occluder to subtract from a cone: the one that blocks most of some sampled lines.

use std::collections::HashMap;

use antumbra_lines::{Cone, Halfspace, RaySigns};
use antumbra_scene::PolygonId;

use super::{Answer, Question, Searcher, Undecided};
use crate::blocker::{BlockerCone, blocker_cones};
use crate::caster::{SAMPLING_SLACK, Segment};
use crate::line::{Between, FineLine, Meeting, obstacle};
use crate::proof::RowName;
use crate::verdict::FinePoint;

/// A row of a blocker cone, with its signs on the cone that it will cut.
pub(super) struct Cut {
    pub halfspace: Halfspace,
    pub name: RowName,
    pub signs: RaySigns,
}

/// An occluder that blocks a part of a cone.
pub(super) struct Blocking {
    pub polygon: PolygonId,
    pub negative: bool,
    pub cuts: Vec<Cut>,
}

/// A question and the blocker cones found for it so far.
pub(super) struct Frame<'q> {
    pub question: &'q Question<'q>,
    pub cones: HashMap<PolygonId, Vec<BlockerCone>>,
}

impl Searcher {
    /// The occluder that blocks most sampled lines of those whose blocker cones meet the cone; or a
    /// free line as an answer.
    pub(super) fn choose(
        &mut self,
        frame: &mut Frame<'_>,
        cone: &Cone,
        segments: &[Segment],
    ) -> Result<Blocking, Answer> {
        // Doubles see a line blocked that only touches an occluder, at the rim of the cone or in
        // the target's plane. Such an occluder must not keep others from being asked.
        let mut refused: Vec<(PolygonId, bool)> = Vec::new();
        loop {
            let tally = self.votes(frame.question, segments, &refused)?;
            let before = refused.len();
            while let Some((id, negative)) = tally.best(&refused) {
                if let Some(cuts) = self.cuts(frame, cone, id, negative) {
                    return Ok(Blocking {
                        polygon: id,
                        negative,
                        cuts,
                    });
                }
                refused.push((id, negative));
            }
            if refused.len() == before {
                return Err(Answer::Undecided(Undecided::Thin));
            }
        }
    }

    /// Which occluders block how many of the sampled lines, those refused apart; or a free line as
    /// an answer.
    fn votes(
        &self,
        question: &Question<'_>,
        segments: &[Segment],
        refused: &[(PolygonId, bool)],
    ) -> Result<Tally, Answer> {
        let blocked = |id: PolygonId, s: &Segment| {
            blocks(question, id, s).filter(|&negative| !refused.contains(&(id, negative)))
        };
        // Known blockers first: the scene is asked only about lines that none of them blocks.
        let mut tally = Tally::default();
        let mut candidates: Vec<(PolygonId, usize)> =
            self.recent.iter().map(|&id| (id, segments.len())).collect();
        for (i, s) in segments.iter().enumerate() {
            let mut any = false;
            for (id, _) in &candidates {
                if let Some(negative) = blocked(*id, s) {
                    tally.add(*id, negative);
                    any = true;
                }
            }
            if any {
                continue;
            }
            question
                .caster
                .visit(s, (-1e-9, 1.0 + 1e-9), SAMPLING_SLACK, |items, _, _| {
                    for &id in items {
                        if candidates.iter().all(|c| c.0 != id)
                            && let Some(negative) = blocked(id, s)
                        {
                            any = true;
                            tally.add(id, negative);
                            candidates.push((id, i));
                        }
                    }
                    std::ops::ControlFlow::Continue(())
                });
            if any {
                continue;
            }
            let (u, v) = (FinePoint::round(s.from), FinePoint::round(s.at(1.0)));
            if !question.exact_witness {
                return Err(Answer::Open(u, v));
            }
            match verify(question, u, v) {
                Ok(()) => return Err(Answer::Open(u, v)),
                Err(Some((id, negative))) => tally.add(id, negative),
                Err(None) => {}
            }
        }
        // Late candidates have not seen the earlier lines yet.
        for &(id, found) in &candidates {
            if found < segments.len() {
                for s in &segments[..found] {
                    if let Some(negative) = blocked(id, s) {
                        tally.add(id, negative);
                    }
                }
            }
        }
        Ok(tally)
    }

    /// The rows of an occluder's blocker cone with their signs on a cone, if the two meet inside.
    fn cuts(
        &mut self,
        frame: &mut Frame<'_>,
        cone: &Cone,
        id: PolygonId,
        negative: bool,
    ) -> Option<Vec<Cut>> {
        let rows = self.rows(frame, id, negative)?;
        let mut cuts = Vec::with_capacity(rows.len());
        for &(halfspace, name) in rows {
            let signs = cone.signs(&mut self.space, halfspace);
            if signs.inside() == 0 {
                return None;
            }
            cuts.push(Cut {
                halfspace,
                name,
                signs,
            });
        }
        Some(cuts)
    }

    fn rows<'f>(
        &mut self,
        frame: &'f mut Frame<'_>,
        id: PolygonId,
        negative: bool,
    ) -> Option<&'f [(Halfspace, RowName)]> {
        let question = frame.question;
        let cones = frame.cones.entry(id).or_insert_with(|| {
            let polygon = question.caster.scene().polygon(id);
            blocker_cones(
                &mut self.space,
                &polygon,
                question.from,
                question.source_plane_blocks,
                question.to,
            )
        });
        cones
            .iter()
            .find(|c| c.negative == negative)
            .map(|c| c.rows.as_slice())
    }
}

/// Votes of sampled lines for occluders.
#[derive(Default)]
struct Tally {
    votes: Vec<(PolygonId, bool, u32)>,
}

impl Tally {
    fn add(&mut self, id: PolygonId, negative: bool) {
        match self.votes.iter_mut().find(|v| v.0 == id && v.1 == negative) {
            Some(v) => v.2 += 1,
            None => self.votes.push((id, negative, 1)),
        }
    }

    fn best(&self, refused: &[(PolygonId, bool)]) -> Option<(PolygonId, bool)> {
        self.votes
            .iter()
            .filter(|v| !refused.contains(&(v.0, v.1)))
            .max_by_key(|v| (v.2, std::cmp::Reverse(v.0)))
            .map(|v| (v.0, v.1))
    }
}

/// Whether an occluder blocks a segment between the gates, in doubles, and whether it is crossed
/// against its normal.
fn blocks(question: &Question<'_>, id: PolygonId, s: &Segment) -> Option<bool> {
    let caster = question.caster;
    if !caster.occludes(id) || question.absent.contains(&id.0) {
        return None;
    }
    let t = caster.crossing(id, s)?;
    const END: f64 = 1e-9;
    if !(-END..=1.0 + END).contains(&t) {
        return None;
    }
    if !(END..=1.0 - END).contains(&t) {
        let polygon = caster.scene().polygon(id);
        if t < END {
            let inside = crate::line::lies_in(&polygon, &question.from.plane);
            if inside && !question.source_plane_blocks {
                return None;
            }
        }
        if t > 1.0 - END && crate::line::lies_in(&polygon, &question.to.plane) {
            return None;
        }
    }
    Some(crate::caster::dot(caster.normal(id), s.step) < 0.0)
}

/// Exactly: the line crosses both gates inside and nothing in between. On failure the obstacle.
fn verify(
    question: &Question<'_>,
    u: FinePoint,
    v: FinePoint,
) -> Result<(), Option<(PolygonId, bool)>> {
    let line = FineLine::new(u, v).ok_or(None)?;
    for gate in [question.from, question.to] {
        match line.meeting(&gate.corners, &gate.plane) {
            Meeting::Cross(s) if s.is_positive() => {}
            _ => return Err(None),
        }
    }
    let between = Between {
        source: &question.from.plane,
        source_plane_blocks: question.source_plane_blocks,
        target: &question.to.plane,
        absent: question.absent,
    };
    match obstacle(question.caster, &line, &between) {
        None => Ok(()),
        Some(id) => {
            let negative =
                crate::caster::dot(question.caster.normal(id), line.segment().step) < 0.0;
            Err(Some((id, negative)))
        }
    }
}
