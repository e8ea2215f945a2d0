//! Stage C: the witness-driven subtraction of blockers from the lines between two gates.
//!
//! Depth first over Plücker cones (`docs/notes/search.md`): sample real lines of the cone; if one
//! is free, the gates see each other; otherwise subtract the occluder that blocks most of them.
//! A cone wholly inside a blocker, or without real lines, is done. When the stack is empty, all
//! lines are blocked, and the tree of splits is the proof. After [MAM05] (split only real parts)
//! and [Nir02] (sampling for blockers); differs in being exact and in keeping a certificate.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra_kernel::Plane;
use antumbra_lines::{
    Cone, ConeError, Gate, Halfspace, PluckerSpace, RaySigns, RealLines, Split, nearly_real,
    real_lines, start_halfspaces,
};
use antumbra_scene::PolygonId;
use dashu_int::IBig;

use crate::blocker::{BlockerCone, blocker_cones};
use crate::caster::{Caster, SAMPLING_SLACK, Segment};
use crate::line::{Between, FineLine, Meeting, obstacle};
use crate::proof::{Node, RowName, Tree};
use crate::random::Random;
use crate::sample::Sampler;
use crate::size::size_below;
use crate::verdict::FinePoint;

/// One question: is a line free from one gate to another?
pub(crate) struct Question<'a> {
    pub caster: &'a Caster<'a>,
    pub from: &'a Gate,
    pub to: &'a Gate,
    /// Whether occluders in the source's plane block.
    pub source_plane_blocks: bool,
    /// Polygons that take no part.
    pub absent: &'a Range<u32>,
    /// Ignore sets of lines below this angle in radians.
    pub ignore_below: Option<f64>,
    /// Set to stop.
    pub cancel: Option<&'a AtomicBool>,
    /// Whether an answer *open* must carry an exactly verified line.
    pub exact_witness: bool,
}

/// The answer of the search.
#[derive(Clone, Debug)]
pub(crate) enum Answer {
    /// No line: the gates do not face each other.
    NoLines,
    /// All lines are blocked.
    Hidden(Tree),
    /// A free line; verified exactly if that was asked for.
    Open(FinePoint, FinePoint),
    /// Not decided; the reason is counted.
    Undecided(Undecided),
}

/// Why a search ended without an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Undecided {
    /// The budget of splits is used up.
    Budget,
    /// Real lines exist but none was found in doubles, or cones grew too complex.
    Thin,
}

/// Work counters, the same on every run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Searches started.
    pub searches: u64,
    /// Splits of Plücker cones.
    pub splits: u64,
    /// Leaves of finished proofs.
    pub leaves: u64,
    /// Sampled lines.
    pub samples: u64,
    /// Signs that doubles could not decide.
    pub exact_signs: u64,
    /// Full decisions about real lines.
    pub real_decisions: u64,
    /// Questions left undecided by a budget.
    pub over_budget: u64,
    /// Questions left undecided because a cone was too thin or too complex.
    pub thin: u64,
}

/// Memory and memory of success that is kept from question to question.
pub(crate) struct Searcher {
    space: PluckerSpace,
    /// Occluders that blocked something lately, most recent first.
    recent: Vec<PolygonId>,
    pub work: Work,
}

/// How many recent blockers are tried before the scene is asked.
const RECENT: usize = 12;
/// Draws of lines from a cone before it is given up as too thin for doubles.
const PATIENCE: usize = 50;
/// Lines sampled in a cone.
const SAMPLES: usize = 12;

enum Slot {
    Open,
    Done(Node),
    Split {
        node: Node,
        inside: usize,
        outside: usize,
    },
}

/// A row of a blocker cone, with its signs on the cone that it will cut.
struct Cut {
    halfspace: Halfspace,
    name: RowName,
    signs: RaySigns,
}

/// An occluder that blocks a part of a cone.
struct Blocking {
    polygon: PolygonId,
    negative: bool,
    cuts: Vec<Cut>,
}

struct Frame<'q> {
    question: &'q Question<'q>,
    cones: HashMap<PolygonId, Vec<BlockerCone>>,
}

impl Searcher {
    pub(crate) fn new() -> Self {
        Self {
            space: PluckerSpace::new(),
            recent: Vec::new(),
            work: Work::default(),
        }
    }

    /// Decides a question with at most `budget` splits.
    pub(crate) fn decide(
        &mut self,
        question: &Question<'_>,
        rng: &mut Random,
        budget: u64,
    ) -> Answer {
        self.work.searches += 1;
        self.space.clear();
        let exact_before = self.space.exact_signs();
        let answer = self.run(question, rng, budget);
        self.work.exact_signs += self.space.exact_signs() - exact_before;
        answer
    }

    fn run(&mut self, question: &Question<'_>, rng: &mut Random, budget: u64) -> Answer {
        let start = match start_halfspaces(&mut self.space, question.from, question.to) {
            Ok(start) => start,
            Err(ConeError::Flat) => return Answer::NoLines,
            Err(_) => return Answer::Undecided(Undecided::Thin),
        };
        let mut frame = Frame {
            question,
            cones: HashMap::new(),
        };
        let mut slots = vec![Slot::Open];
        let mut stack = Vec::new();
        match start.chord {
            None => match Cone::new(&mut self.space, &start.halfspaces) {
                Ok(cone) => stack.push((cone, 0_usize)),
                Err(ConeError::Flat) => return Answer::NoLines,
                Err(_) => return Answer::Undecided(Undecided::Thin),
            },
            Some(chord) => {
                let row = RowName::Chord {
                    from: chord.from,
                    to: chord.to,
                };
                let node = Node::Split {
                    row,
                    negative: false,
                };
                slots[0] = Slot::Split {
                    node,
                    inside: 1,
                    outside: 2,
                };
                for (slot, h) in [(1, chord.halfspace), (2, chord.halfspace.opposite())] {
                    let mut halfspaces = start.halfspaces.clone();
                    halfspaces.push(h);
                    match Cone::new(&mut self.space, &halfspaces) {
                        Ok(cone) => {
                            slots.push(Slot::Open);
                            stack.push((cone, slot));
                        }
                        Err(ConeError::Flat) => slots.push(Slot::Done(Node::Imaginary)),
                        Err(_) => return Answer::Undecided(Undecided::Thin),
                    }
                }
            }
        }
        let limit = self.work.splits.saturating_add(budget);
        // A part too thin for doubles decides nothing; another one may still hold a free line.
        let mut thin = false;
        while let Some((cone, slot)) = stack.pop() {
            match self.treat(&mut frame, cone, slot, &mut slots, &mut stack, rng) {
                Ok(()) => {}
                Err(Answer::Undecided(Undecided::Thin)) => thin = true,
                Err(answer) => return answer,
            }
            let stopped = question.cancel.is_some_and(|c| c.load(Ordering::Relaxed));
            if self.work.splits > limit || stopped {
                return Answer::Undecided(Undecided::Budget);
            }
        }
        if thin {
            return Answer::Undecided(Undecided::Thin);
        }
        let tree = preorder(&slots);
        self.work.leaves += tree
            .nodes
            .iter()
            .filter(|n| !matches!(n, Node::Split { .. }))
            .count() as u64;
        Answer::Hidden(tree)
    }

    /// Treats one cone: fills its slot, or finds a free line.
    fn treat(
        &mut self,
        frame: &mut Frame<'_>,
        cone: Cone,
        slot: usize,
        slots: &mut Vec<Slot>,
        stack: &mut Vec<(Cone, usize)>,
        rng: &mut Random,
    ) -> Result<(), Answer> {
        // Most parts outside of a blocker hold no real line, and the signs of a few hundred pairs
        // of vertices tell: cheaper than to sample in vain.
        self.work.real_decisions += 1;
        if real_lines(&mut self.space, &cone) == RealLines::None {
            slots[slot] = Slot::Done(Node::Imaginary);
            return Ok(());
        }
        let sampler = Sampler::new(&self.space, &cone);
        if let Some(angle) = frame.question.ignore_below
            && size_below(&self.space, &cone, &sampler, frame.question.from, angle)
        {
            slots[slot] = Slot::Done(Node::Ignored);
            return Ok(());
        }
        // Nearly always the first draw decides. In thin cones lines may lose their place when they
        // are rounded to fine points; others keep it.
        let mut lines = Vec::with_capacity(SAMPLES);
        for _ in 0..PATIENCE {
            lines.clear();
            sampler.lines(rng, SAMPLES, &mut lines);
            if lines.len() < SAMPLES / 2 {
                sampler.persist(rng, SAMPLES / 2, &mut lines);
            }
            self.work.samples += lines.len() as u64;
            let segments: Vec<Segment> = lines
                .iter()
                .filter_map(|(d, m)| between_gates(d, m, frame.question))
                .collect();
            if segments.is_empty() {
                break;
            }
            match self.choose(frame, &cone, &segments) {
                Ok(blocker) => return self.subtract(cone, slot, slots, stack, blocker),
                Err(Answer::Undecided(Undecided::Thin)) => {}
                Err(answer) => return Err(answer),
            }
        }
        for _ in 0..PATIENCE / 10 {
            let segments = self.thin_segments(frame.question, &cone, rng);
            match self.choose(frame, &cone, &segments) {
                Ok(blocker) => return self.subtract(cone, slot, slots, stack, blocker),
                Err(Answer::Undecided(Undecided::Thin)) => {}
                Err(answer) => return Err(answer),
            }
        }
        Err(Answer::Undecided(Undecided::Thin))
    }

    /// A few real lines of a thin cone, found by big integers.
    fn thin_segments(
        &mut self,
        question: &Question<'_>,
        cone: &Cone,
        rng: &mut Random,
    ) -> Vec<Segment> {
        const LINES: usize = 4;
        const BITS: usize = 160;
        (0..LINES)
            .filter_map(|_| {
                let weight = || 1 + (rng.bits() >> 48) as u32;
                let line = nearly_real(&mut self.space, cone, BITS, weight)?;
                let from = meet_plane_exactly(&line, &question.from.plane)?;
                let to = meet_plane_exactly(&line, &question.to.plane)?;
                Some(Segment::new(from, to))
            })
            .collect()
    }

    /// The occluder that blocks most sampled lines of those whose blocker cones meet the cone; or a
    /// free line as an answer.
    fn choose(
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

    /// Cuts a blocker out of a cone: the parts outside go to the stack, the part inside is done.
    fn subtract(
        &mut self,
        mut cone: Cone,
        mut slot: usize,
        slots: &mut Vec<Slot>,
        stack: &mut Vec<(Cone, usize)>,
        blocking: Blocking,
    ) -> Result<(), Answer> {
        let Blocking {
            polygon,
            negative,
            mut cuts,
        } = blocking;
        self.remember(polygon);
        cuts.retain(|c| c.signs.outside() > 0);
        // Small parts outside first: what is left inside then meets fewer rows. From the end.
        cuts.sort_by_key(|c| std::cmp::Reverse(c.signs.outside()));
        while let Some(cut) = cuts.pop() {
            self.work.splits += 1;
            match cone.split_by(&mut self.space, cut.halfspace, &cut.signs) {
                Ok(Split::Inside) => {}
                Ok(Split::Both(inside, outside)) => {
                    for other in &mut cuts {
                        other.signs = inside.inherited_signs(
                            &mut self.space,
                            other.halfspace,
                            &other.signs,
                            &cut.signs,
                        );
                    }
                    let (a, b) = (slots.len(), slots.len() + 1);
                    slots.push(Slot::Open);
                    slots.push(Slot::Open);
                    let node = Node::Split {
                        row: cut.name,
                        negative,
                    };
                    slots[slot] = Slot::Split {
                        node,
                        inside: a,
                        outside: b,
                    };
                    stack.push((outside, b));
                    cone = inside;
                    slot = a;
                }
                Ok(Split::Outside) => {
                    // Nothing is left inside: the earlier cuts served no purpose but are sound.
                    stack.push((cone, slot));
                    return Ok(());
                }
                Err(_) => return Err(Answer::Undecided(Undecided::Thin)),
            }
        }
        slots[slot] = Slot::Done(Node::Blocked { polygon, negative });
        Ok(())
    }

    fn remember(&mut self, id: PolygonId) {
        if let Some(i) = self.recent.iter().position(|&r| r == id) {
            self.recent.remove(i);
        }
        self.recent.insert(0, id);
        self.recent.truncate(RECENT);
    }

    /// The occluders that blocked something lately, most recent first.
    pub(crate) fn recent(&self) -> &[PolygonId] {
        &self.recent
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

/// The part of a sampled line between the two gates' planes, in doubles.
fn between_gates(d: &[f64; 3], m: &[f64; 3], question: &Question<'_>) -> Option<Segment> {
    let p = meet_plane(d, m, question.from)?;
    let q = meet_plane(d, m, question.to)?;
    let ok = p
        .iter()
        .chain(&q)
        .all(|c| c.is_finite() && c.abs() < f64::from(antumbra_kernel::LIMIT));
    ok.then(|| Segment::new(p, q))
}

/// Where a line by big integers crosses a plane, rounded once.
fn meet_plane_exactly(line: &[IBig; 6], plane: &Plane) -> Option<[f64; 3]> {
    let n = plane.normal.map(IBig::from);
    let [d0, d1, d2, m0, m1, m2] = line;
    let (d, m) = ([d0, d1, d2], [m0, m1, m2]);
    let along: IBig = (0..3).map(|k| &n[k] * d[k]).sum();
    if along == IBig::ZERO {
        return None;
    }
    let c = IBig::from(plane.offset);
    const FRACTION: usize = 48;
    Some(std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let numerator: IBig = &c * d[k] + &n[i] * m[j] - &n[j] * m[i];
        ((numerator << FRACTION) / &along).to_f64().value() / (1_u64 << FRACTION) as f64
    }))
}

fn meet_plane(d: &[f64; 3], m: &[f64; 3], gate: &Gate) -> Option<[f64; 3]> {
    let n = gate.plane.normal.map(|c| c as f64);
    let along = crate::caster::dot(n, *d);
    if along == 0.0 {
        return None;
    }
    let c = gate.plane.offset as f64;
    let nxm = crate::caster::cross(n, *m);
    let mut p: [f64; 3] = std::array::from_fn(|k| (c * d[k] + nxm[k]) / along);
    // On an axis-parallel plane the coordinate is known exactly.
    for k in 0..3 {
        if n[(k + 1) % 3] == 0.0 && n[(k + 2) % 3] == 0.0 {
            p[k] = f64::from(gate.corners[0].to_array()[k]);
        }
    }
    Some(p)
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

fn preorder(slots: &[Slot]) -> Tree {
    let mut nodes = Vec::with_capacity(slots.len());
    let mut stack = vec![0_usize];
    while let Some(i) = stack.pop() {
        match &slots[i] {
            Slot::Open => {}
            Slot::Done(node) => nodes.push(*node),
            Slot::Split {
                node,
                inside,
                outside,
            } => {
                nodes.push(*node);
                stack.push(*outside);
                stack.push(*inside);
            }
        }
    }
    Tree { nodes }
}
