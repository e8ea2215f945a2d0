//! Stage C: the witness-driven subtraction of blockers from the lines between two gates.
//!
//! Depth first over Plücker cones (`docs/notes/search.md`): sample real lines of the cone; if one
//! is free, the gates see each other; otherwise subtract the occluder that blocks most of them.
//! A cone wholly inside a blocker, or without real lines, is done. When the stack is empty, all
//! lines are blocked, and the tree of splits is the proof. After [MAM05] (split only real parts)
//! and [Nir02] (sampling for blockers); differs in being exact and in keeping a certificate.

mod choose;
mod segments;

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra_lines::{
    Cone, ConeError, Gate, PluckerSpace, RealLines, Split, real_lines, start_halfspaces,
};
use antumbra_scene::PolygonId;

use crate::bundle::{Bundle, LANES};
use crate::caster::Caster;
use crate::proof::{Node, RowName, Tree};
use crate::random::Random;
use crate::sample::Sampler;
use crate::size::size_below;
use crate::verdict::FinePoint;
use choose::{Blocking, Frame};
use segments::between_gates;

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
const SAMPLES: usize = LANES;

enum Slot {
    Open,
    Done(Node),
    Split {
        node: Node,
        inside: usize,
        outside: usize,
    },
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
        let mut sampler = Sampler::new(&self.space, &cone);
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
            let mut bundle = Bundle::new();
            for (d, m) in &lines {
                if let Some(segment) = between_gates(d, m, frame.question) {
                    bundle.push(segment);
                }
            }
            if bundle.is_empty() {
                break;
            }
            match self.choose(frame, &cone, &bundle) {
                Ok(blocker) => return self.subtract(cone, slot, slots, stack, blocker),
                Err(Answer::Undecided(Undecided::Thin)) => {}
                Err(answer) => return Err(answer),
            }
        }
        for _ in 0..PATIENCE / 10 {
            let bundle = self.thin_segments(frame.question, &cone, rng);
            match self.choose(frame, &cone, &bundle) {
                Ok(blocker) => return self.subtract(cone, slot, slots, stack, blocker),
                Err(Answer::Undecided(Undecided::Thin)) => {}
                Err(answer) => return Err(answer),
            }
        }
        Err(Answer::Undecided(Undecided::Thin))
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
                        let signs = inside.inherited_signs(
                            &mut self.space,
                            other.halfspace,
                            &other.signs,
                            &cut.signs,
                        );
                        let whole = std::mem::replace(&mut other.signs, signs);
                        self.space.discard(whole);
                    }
                    self.space.discard(cut.signs);
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
