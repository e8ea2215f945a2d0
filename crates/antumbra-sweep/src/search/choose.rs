//! Which occluder to subtract from a cone: the one that blocks most of some sampled lines.

use std::collections::HashMap;

use antumbra_lines::{Cone, Halfspace, RaySigns};
use antumbra_scene::PolygonId;

use super::{Answer, Question, RECENT, Searcher, Undecided};
use crate::blocker::{BlockerCone, blocker_cones};
use crate::bundle::Bundle;
use crate::caster::{SAMPLING_SLACK, Segment, dot};
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

/// Why an occluder is not subtracted.
enum Passed {
    /// Its blocker cone does not meet the cone inside.
    Apart,
    /// Another one leaves less.
    Worse,
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
        bundle: &Bundle,
    ) -> Result<Blocking, Answer> {
        // Doubles see a line blocked that only touches an occluder, at the rim of the cone or in
        // the target's plane. Such an occluder must not keep others from being asked.
        let mut refused: Vec<(PolygonId, bool)> = Vec::new();
        loop {
            let tally = self.votes(frame.question, bundle, &refused)?;
            let before = refused.len();
            if let Some(blocking) = self.pick(frame, cone, &tally, &mut refused) {
                return Ok(blocking);
            }
            if refused.len() == before {
                return Err(Answer::Undecided(Undecided::Thin));
            }
        }
    }

    /// Of the occluders with most votes the one that leaves least: every row that cuts the cone
    /// leaves a part outside, the larger the more rays are there. Votes alone, of a few lines,
    /// know too little of the parts; a look at the signs costs a tenth of a split. Those looked at
    /// are refused from now on.
    fn pick(
        &mut self,
        frame: &mut Frame<'_>,
        cone: &Cone,
        tally: &Tally,
        refused: &mut Vec<(PolygonId, bool)>,
    ) -> Option<Blocking> {
        /// Occluders looked at.
        const RIVALS: usize = 3;
        /// What the vote of a line weighs against a part left outside.
        const VOTE: f64 = 0.3;
        let mut best: Option<(f64, Blocking)> = None;
        let (mut rivals, mut most) = (0, 0);
        while let Some((polygon, negative, votes)) = tally.best(refused) {
            if rivals == RIVALS || 4 * votes < 3 * most {
                break;
            }
            refused.push((polygon, negative));
            let vote = VOTE * f64::from(votes);
            let limit = best.as_ref().map_or(f64::INFINITY, |b| b.0 + vote);
            let (left, cuts) = match self.cuts(frame, cone, (polygon, negative), limit) {
                Ok(better) => better,
                Err(Passed::Apart) => continue,
                Err(Passed::Worse) => {
                    rivals += 1;
                    continue;
                }
            };
            (rivals, most) = (rivals + 1, most.max(votes));
            let blocking = Blocking {
                polygon,
                negative,
                cuts,
            };
            if let Some((_, loser)) = best.replace((left - vote, blocking)) {
                self.discard(loser.cuts);
            }
            if left == 0.0 {
                break;
            }
        }
        best.map(|b| b.1)
    }

    fn discard(&mut self, cuts: Vec<Cut>) {
        for cut in cuts {
            self.space.discard(cut.signs);
        }
    }

    /// Which occluders block how many of the sampled lines, those refused apart; or a free line as
    /// an answer.
    fn votes(
        &self,
        question: &Question<'_>,
        bundle: &Bundle,
        refused: &[(PolygonId, bool)],
    ) -> Result<Tally, Answer> {
        // Known blockers first: the scene is asked only about lines that none of them blocks.
        let mut tally = Tally {
            asked: Vec::with_capacity(2 * RECENT),
            votes: Vec::with_capacity(2 * RECENT),
            blocked: 0,
        };
        for &id in &self.recent {
            tally.add(blocked(question, id, bundle, refused));
        }
        for (i, s) in bundle.segments().iter().enumerate() {
            if tally.blocked >> i & 1 == 1 {
                continue;
            }
            question
                .caster
                .visit(s, (-1e-9, 1.0 + 1e-9), SAMPLING_SLACK, |items, _, _| {
                    for &id in items {
                        if !tally.asked.contains(&id) && blocks(question, id, s) {
                            tally.add(blocked(question, id, bundle, refused));
                        }
                    }
                    std::ops::ControlFlow::Continue(())
                });
            if tally.blocked >> i & 1 == 1 {
                continue;
            }
            let (u, v) = (FinePoint::round(s.from), FinePoint::round(s.at(1.0)));
            if !question.exact_witness {
                return Err(Answer::Open(u, v));
            }
            match verify(question, u, v) {
                Ok(()) => return Err(Answer::Open(u, v)),
                Err(Some((id, negative))) => tally.vote(id, negative, 1),
                Err(None) => {}
            }
        }
        Ok(tally)
    }

    /// What an occluder's blocker cone leaves of a cone (the parts outside its rows, and the share
    /// of the rays there), and its rows with their signs; if the two meet inside and less than a
    /// limit is left.
    fn cuts(
        &mut self,
        frame: &mut Frame<'_>,
        cone: &Cone,
        (id, negative): (PolygonId, bool),
        limit: f64,
    ) -> Result<(f64, Vec<Cut>), Passed> {
        let rows = self.rows(frame, id, negative).ok_or(Passed::Apart)?;
        let mut cuts = Vec::with_capacity(rows.len());
        let mut left = 0.0;
        for &(halfspace, name) in rows {
            let signs = cone.signs(&mut self.space, halfspace);
            let misses = signs.inside() == 0;
            if signs.outside() > 0 {
                left += 1.0 + signs.outside() as f64 / cone.ray_count() as f64;
            }
            cuts.push(Cut {
                halfspace,
                name,
                signs,
            });
            if misses || left >= limit {
                self.discard(cuts);
                return Err(if misses { Passed::Apart } else { Passed::Worse });
            }
        }
        Ok((left, cuts))
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

/// Which of the sampled lines an occluder blocks, along its normal and against it.
struct Blocked {
    polygon: PolygonId,
    along: u16,
    against: u16,
}

/// Votes of sampled lines for occluders.
struct Tally {
    asked: Vec<PolygonId>,
    votes: Vec<(PolygonId, bool, u32)>,
    /// The lines that some occluder blocks.
    blocked: u16,
}

impl Tally {
    fn add(&mut self, blocked: Blocked) {
        self.asked.push(blocked.polygon);
        for (negative, lines) in [(false, blocked.along), (true, blocked.against)] {
            if lines != 0 {
                self.vote(blocked.polygon, negative, lines.count_ones());
                self.blocked |= lines;
            }
        }
    }

    fn vote(&mut self, id: PolygonId, negative: bool, lines: u32) {
        match self.votes.iter_mut().find(|v| v.0 == id && v.1 == negative) {
            Some(v) => v.2 += lines,
            None => self.votes.push((id, negative, lines)),
        }
    }

    fn best(&self, refused: &[(PolygonId, bool)]) -> Option<(PolygonId, bool, u32)> {
        self.votes
            .iter()
            .filter(|v| !refused.contains(&(v.0, v.1)))
            .max_by_key(|v| (v.2, std::cmp::Reverse(v.0)))
            .copied()
    }
}

/// Which segments between the gates an occluder blocks, in doubles; what was refused never.
fn blocked(
    question: &Question<'_>,
    id: PolygonId,
    bundle: &Bundle,
    refused: &[(PolygonId, bool)],
) -> Blocked {
    let mut lines = [0_u16; 2];
    if may_block(question, id) {
        let normal = question.caster.normal(id);
        bundle.for_each_crossing(question.caster, id, |lane, t| {
            if lies_between(question, id, t) {
                let against = dot(normal, bundle.segments()[lane].step) < 0.0;
                lines[usize::from(against)] |= 1 << lane;
            }
        });
        for (lines, negative) in lines.iter_mut().zip([false, true]) {
            if refused.contains(&(id, negative)) {
                *lines = 0;
            }
        }
    }
    Blocked {
        polygon: id,
        along: lines[0],
        against: lines[1],
    }
}

/// Whether an occluder blocks a segment between the gates, in doubles.
fn blocks(question: &Question<'_>, id: PolygonId, s: &Segment) -> bool {
    may_block(question, id)
        && question
            .caster
            .crossing(id, s)
            .is_some_and(|t| lies_between(question, id, t))
}

fn may_block(question: &Question<'_>, id: PolygonId) -> bool {
    question.caster.occludes(id) && !question.absent.contains(&id.0)
}

/// Whether an occluder that a segment crosses at some parameter stands between the gates.
fn lies_between(question: &Question<'_>, id: PolygonId, t: f64) -> bool {
    const END: f64 = 1e-9;
    if (END..=1.0 - END).contains(&t) {
        return true;
    }
    if !(-END..=1.0 + END).contains(&t) {
        return false;
    }
    let polygon = question.caster.scene().polygon(id);
    let gate = if t < END {
        if question.source_plane_blocks {
            return true;
        }
        question.from
    } else {
        question.to
    };
    !crate::line::lies_in(&polygon, &gate.plane)
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
