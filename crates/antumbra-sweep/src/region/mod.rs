//! The potentially visible set of one view cell, exactly.
//!
//! Stages after the design: witnesses by casting rays; then the hierarchy of objects, front to
//! back, whole boxes first; one occluder that covers all lines (stage A); and the search over
//! Plücker cones (stage C). Every object ends up *visible* with a witness, *touching*, or *hidden*
//! by claims that the checker verifies.

mod boxes;
mod explore;
mod live;
mod rays;
mod record;
mod source;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra_kernel::Aabb;
use antumbra_scene::{
    BoxContact, ObjectId, PolygonId, TargetKind, TargetTree, ViewCell, box_contact, polygons_touch,
};

use crate::caster::Caster;
use crate::cover::Behind;
use crate::gates::polygon_gate;
use crate::pair::{PairResult, Surface, Verdict};
use crate::proof::{CellProof, Claim, GateProof, Reason, Target};
use crate::random::Random;
use crate::search::{Answer, Question, Searcher, Undecided};
use crate::verdict::{Accuracy, CellResult, VisibleEntry, Witness};
use boxes::Boxed;
use live::{Beyond, Live, State};
use record::Record;
use source::Source;

/// Options of a bake.
#[derive(Clone, Debug)]
pub struct BakeOptions {
    /// Ignore sets of lines below this angle in radians; the result is then *aggressive*.
    pub ignore_below: Option<f64>,
    /// Seed of the sampling. Verdicts do not depend on it, witnesses and proofs do.
    pub seed: u64,
    /// Whether to keep the proofs of everything hidden.
    pub proofs: bool,
    /// Set to stop: what is undecided then is *unknown*.
    pub cancel: Option<Arc<AtomicBool>>,
    /// Upper bound on splits for one polygon; deterministic.
    pub max_splits: Option<u64>,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            ignore_below: None,
            seed: 1,
            proofs: true,
            cancel: None,
            max_splits: None,
        }
    }
}

/// A scene prepared for baking: shared by all cells and threads.
#[derive(Clone, Debug)]
pub struct Baker<'a> {
    caster: Caster<'a>,
    targets: TargetTree,
    /// Objects without polygons.
    empty: Vec<ObjectId>,
}

impl<'a> Baker<'a> {
    /// Prepares a scene; `n log n`.
    #[must_use]
    pub fn new(scene: &'a antumbra_scene::Scene) -> Self {
        let objects = scene.objects().iter().enumerate();
        Self {
            caster: Caster::new(scene),
            targets: TargetTree::new(scene),
            empty: objects
                .filter(|(_, o)| o.polygons.is_empty())
                .map(|(i, _)| ObjectId(i as u32))
                .collect(),
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a antumbra_scene::Scene {
        self.caster.scene()
    }

    /// The scene prepared for single lines and points.
    #[must_use]
    pub fn caster(&self) -> &Caster<'a> {
        &self.caster
    }

    /// The potentially visible set of one cell. Deterministic; one thread.
    #[must_use]
    pub fn bake_cell(&self, cell: &ViewCell, options: &BakeOptions) -> CellResult {
        let source = Source::of_cell(self.scene(), cell);
        let mut bake = CellBake::new(self, source, &cell.name, options);
        bake.find_touching();
        bake.cast_rays();
        if let Some(root) = self.targets.root() {
            bake.fresh.clear();
            bake.explore(root);
            bake.prove_group(root);
        }
        bake.finish()
    }
}

impl Baker<'_> {
    /// Decides one target from the polygons of a source.
    pub(crate) fn decide_pair(
        &self,
        from: Range<u32>,
        to: Surface,
        options: &BakeOptions,
    ) -> PairResult {
        let scene = self.scene();
        let object = match to {
            Surface::Object(id) => id,
            Surface::Polygon(id) => scene.polygon(id).object,
        };
        let source = Source::of_polygons(scene, from);
        let mut bake = CellBake::new(self, source, "pair", options);
        bake.live = Live::only(&self.targets, scene.objects().len(), object);
        bake.aim_at(to.polygons(scene), PAIR_RAYS);
        let root = match to {
            _ if !bake.undecided(object) => None,
            Surface::Polygon(id) => {
                let part = bake.prove_polygon(id);
                bake.settle(object, part);
                None
            }
            Surface::Object(id) => self.targets.object_root(id),
        };
        if let Some(root) = root {
            bake.prove_object(root, object);
        }
        let fully = bake.searcher.work.splits == 0 && bake.fully_visible(to);
        let state = bake.live.state(object);
        let result = bake.finish();
        let verdict = match (state, result.visible.first().and_then(|e| e.witness)) {
            (State::Visible, Some(witness)) => Verdict::Visible { witness, fully },
            (State::Hidden, _) => Verdict::Hidden(result.proof),
            // An object without polygons is seen by nothing and sees nothing.
            (State::Undecided, _) => Verdict::Hidden(result.proof),
            _ => Verdict::Unknown,
        };
        PairResult {
            verdict,
            work: result.work,
        }
    }
}

pub(crate) struct CellBake<'a> {
    baker: &'a Baker<'a>,
    options: &'a BakeOptions,
    source: Source,
    live: Live<'a>,
    entries: BTreeMap<ObjectId, VisibleEntry>,
    accuracy: Accuracy,
    proof: CellProof,
    searcher: Searcher,
    rng: Random,
    /// Witnesses whose surroundings have not been looked at.
    fresh: Vec<Witness>,
    /// Whether it pays to prove boxes, and what lies beyond everything visible.
    boxes: Record,
    beyonds: Record,
}

/// Rays at the target of a pair before a proof is tried; a ray costs a hundredth of one.
const PAIR_RAYS: usize = 96;
/// Free lines into a box that may be followed before its children are asked.
pub(super) const BOX_TRIES: usize = 6;

impl<'a> CellBake<'a> {
    fn new(baker: &'a Baker<'a>, source: Source, name: &str, options: &'a BakeOptions) -> Self {
        let objects = baker.scene().objects();
        let empty = baker.empty.iter().copied();
        let own = source.absent.clone().next().and_then(|p| {
            let id = baker.scene().polygon(PolygonId(p)).object;
            (objects[id.index()].polygons == source.absent).then_some(id)
        });
        let live = Live::new(&baker.targets, objects.len(), empty.chain(own));
        // The name is part of the seed, so that a cell's result does not depend on its neighbors.
        let name_seed = name.bytes().fold(0_u64, |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3)
        });
        Self {
            baker,
            options,
            source,
            live,
            entries: BTreeMap::new(),
            accuracy: options
                .ignore_below
                .map_or(Accuracy::Exact, Accuracy::AggressiveBelow),
            proof: CellProof::default(),
            searcher: Searcher::new(),
            rng: Random::new(options.seed ^ name_seed),
            fresh: Vec::new(),
            boxes: Record::default(),
            beyonds: Record::default(),
        }
    }

    pub(super) fn undecided(&self, id: ObjectId) -> bool {
        self.live.undecided(id)
    }

    pub(super) fn cancelled(&self) -> bool {
        self.options
            .cancel
            .as_ref()
            .is_some_and(|c| c.load(Ordering::Relaxed))
    }

    /// Objects that meet the closed cell are visible without a witness.
    fn find_touching(&mut self) {
        let scene = self.baker.scene();
        let mut touching = Vec::new();
        let mut entered = false;
        scene.kd().for_each_in_box(&self.source.bounds, |id| {
            let polygon = scene.polygon(id);
            if self.source.absent.contains(&id.0) {
                return;
            }
            if self.source.plane_blocks {
                match box_contact(&polygon, &self.source.bounds) {
                    BoxContact::Apart => {}
                    BoxContact::Touches => touching.push(polygon.object),
                    BoxContact::Enters => {
                        touching.push(polygon.object);
                        entered |= polygon.occludes;
                    }
                }
            } else {
                let mut sources = self.source.absent.clone();
                if sources.any(|s| polygons_touch(&scene.polygon(PolygonId(s)), &polygon)) {
                    touching.push(polygon.object);
                }
            }
        });
        for object in touching {
            self.live.set(object, State::Visible);
            self.entries.insert(
                object,
                VisibleEntry {
                    object,
                    touching: true,
                    witness: None,
                },
            );
        }
        if entered && self.accuracy == Accuracy::Exact {
            self.accuracy = Accuracy::Conservative;
        }
    }
    /// Stage 2 for a node over several objects.
    fn prove_group(&mut self, index: u32) {
        let node = *self.baker.targets.node(index);
        if let Some(object) = node.object {
            self.prove_object(index, object);
            return;
        }
        if self.live.left(index) > 1 {
            let class = self.live.left(index).ilog2() as usize;
            if self.boxes.pay(class) && self.prove_box(index, class) {
                return;
            }
            if self.beyonds.pay(class) {
                self.prove_beyond(index, class);
            }
        }
        if self.live.left(index) == 0 || self.cancelled() {
            return;
        }
        if let TargetKind::Inner(a, b) = node.kind {
            let (a, b) = self.nearer_first(a, b);
            self.prove_group(a);
            self.prove_group(b);
        }
    }

    /// Tries to hide everything undecided below a node; whether that worked.
    fn prove_box(&mut self, index: u32, class: usize) -> bool {
        for _ in 0..BOX_TRIES {
            let Some(bounds) = self.live.bounds(index).filter(|_| !self.cancelled()) else {
                return true;
            };
            match self.hide_box(&bounds) {
                Boxed::Hidden(reason) => {
                    self.claim(Target::Box(bounds), reason);
                    self.live.hide(index);
                    self.boxes.note(class, true);
                    return true;
                }
                Boxed::Seen => self.look_around(),
                Boxed::Open => break,
            }
        }
        self.boxes.note(class, false);
        false
    }

    /// Tries to hide at once what lies farther from the source, along an axis, than everything
    /// visible below a node: a hierarchy cut by areas alone holds the near and the far together.
    fn prove_beyond(&mut self, index: u32, class: usize) {
        for (axis, positive) in (0..6).map(|i| (i / 2, i % 2 == 0)) {
            for _ in 0..BOX_TRIES {
                let Some((bounds, beyond)) = self.beyond(index, axis, positive) else {
                    break;
                };
                match self.hide_box(&bounds) {
                    Boxed::Hidden(reason) => {
                        self.claim(Target::Box(bounds), reason);
                        self.live.hide_beyond(index, &beyond);
                        self.beyonds.note(class, true);
                        break;
                    }
                    Boxed::Seen => self.look_around(),
                    Boxed::Open => {
                        self.beyonds.note(class, false);
                        break;
                    }
                }
            }
        }
    }

    /// The box around what is undecided below a node and lies beyond the source and everything
    /// visible below the node; `None` if that is little.
    fn beyond(&self, index: u32, axis: usize, positive: bool) -> Option<(Aabb, Beyond)> {
        const FEW: u32 = 3;
        let mut beyond = Beyond {
            axis,
            positive,
            bound: 0,
        };
        beyond.bound = beyond.span(&self.source.bounds).1;
        let left = self.live.left(index);
        if left < 2 * FEW || beyond.span(&self.live.bounds(index)?).0 <= beyond.bound {
            return None;
        }
        let places = self.baker.targets.node(index).places();
        for &object in self.entries.keys() {
            if places.contains(&self.baker.targets.place(object))
                && let Some(root) = self.baker.targets.object_root(object)
            {
                let near = beyond.span(&self.baker.targets.node(root).bounds).0;
                beyond.bound = beyond.bound.max(near);
            }
        }
        let (bounds, count) = self.live.bounds_beyond(index, &beyond);
        (count >= FEW.max(left / 8) && count < left)
            .then_some(bounds)
            .flatten()
            .map(|b| (b, beyond))
    }

    fn claim(&mut self, target: Target, reason: Reason) {
        if self.options.proofs {
            self.proof.claims.push(Claim { target, reason });
        }
    }

    /// Two nodes, the one nearer to the source first.
    fn nearer_first(&self, a: u32, b: u32) -> (u32, u32) {
        if self.distance(a) <= self.distance(b) {
            (a, b)
        } else {
            (b, a)
        }
    }

    fn distance(&self, index: u32) -> i64 {
        let (a, b) = (&self.source.bounds, &self.baker.targets.node(index).bounds);
        let (alo, ahi, blo, bhi) = (
            a.min.to_i64(),
            a.max.to_i64(),
            b.min.to_i64(),
            b.max.to_i64(),
        );
        (0..3)
            .map(|k| (alo[k] - bhi[k]).max(blo[k] - ahi[k]).max(0))
            .max()
            .unwrap_or(0)
    }

    /// Decides one object: hidden if all its polygons are.
    fn prove_object(&mut self, index: u32, object: ObjectId) {
        if !self.undecided(object) {
            return;
        }
        let claims = self.proof.claims.len();
        let part = self.prove_part(index, object);
        if part != Part::Hidden {
            self.proof.claims.truncate(claims);
        }
        self.settle(object, part);
    }

    fn settle(&mut self, object: ObjectId, part: Part) {
        let state = match part {
            Part::Hidden => State::Hidden,
            Part::Visible => State::Visible,
            Part::Unknown => State::Unknown,
        };
        self.live.set(object, state);
    }

    /// Whether no occluder stands between the source and a target at all: by boxes, so that *no*
    /// may also mean *not known*.
    fn fully_visible(&self, to: Surface) -> bool {
        let scene = self.baker.scene();
        let range = to.polygons(scene);
        let bounds = range.clone().map(|p| scene.polygon(PolygonId(p)).bounds());
        let Some(between) = bounds
            .reduce(Aabb::union)
            .map(|b| b.union(self.source.bounds))
        else {
            return false;
        };
        let mut free = true;
        scene.kd().for_each_in_box(&between, |id| {
            let polygon = scene.polygon(id);
            let apart = self.source.absent.contains(&id.0) || range.contains(&id.0);
            free &= apart || !polygon.occludes || !polygon.bounds().touches(&between);
        });
        free
    }

    fn prove_part(&mut self, index: u32, object: ObjectId) -> Part {
        let node = *self.baker.targets.node(index);
        if self.cancelled() {
            return Part::Unknown;
        }
        match node.kind {
            TargetKind::Polygon(id) => self.prove_polygon(id),
            TargetKind::Inner(a, b) => {
                for _ in 0..2 {
                    match self.hide_box(&node.bounds) {
                        Boxed::Hidden(reason) => {
                            self.claim(Target::Box(node.bounds), reason);
                            return Part::Hidden;
                        }
                        Boxed::Seen => {
                            if !self.undecided(object) {
                                return Part::Visible;
                            }
                        }
                        Boxed::Open => break,
                    }
                }
                let (a, b) = self.nearer_first(a, b);
                match self.prove_part(a, object) {
                    Part::Visible => Part::Visible,
                    first => match self.prove_part(b, object) {
                        Part::Hidden => first,
                        other => other,
                    },
                }
            }
        }
    }
    /// Decides one polygon completely.
    fn prove_polygon(&mut self, id: PolygonId) -> Part {
        let scene = self.baker.scene();
        let polygon = scene.polygon(id);
        if let Some(reason) = self.covered(polygon.corners, Behind::Weakly) {
            self.claim(Target::Polygon(id), reason);
            return Part::Hidden;
        }
        let budget = self.options.max_splits.unwrap_or(u64::MAX);
        let mut gates = Vec::new();
        // Lines too thin for one pair of gates do not keep another from holding a free one.
        let mut thin = false;
        for source in 0..self.source.gates.len() {
            for against in [false, true] {
                let to = polygon_gate(&polygon, against);
                let question = Question {
                    caster: &self.baker.caster,
                    from: &self.source.gates[source].gate,
                    to: &to,
                    source_plane_blocks: self.source.plane_blocks,
                    absent: &self.source.absent,
                    ignore_below: self.options.ignore_below,
                    cancel: self.options.cancel.as_deref(),
                    exact_witness: true,
                };
                match self.searcher.decide(&question, &mut self.rng, budget) {
                    Answer::NoLines => {}
                    Answer::Hidden(tree) => {
                        let number = self.source.gates[source].number;
                        gates.push(GateProof {
                            source: number,
                            target: u32::from(against),
                            tree,
                        });
                    }
                    Answer::Open(u, v) => {
                        if self.sees(source, u, v, id) {
                            self.record(source, u, v, id);
                            return Part::Visible;
                        }
                        thin = true;
                    }
                    Answer::Undecided(Undecided::Budget) => {
                        self.searcher.work.over_budget += 1;
                        return Part::Unknown;
                    }
                    Answer::Undecided(Undecided::Thin) => {
                        self.searcher.work.thin += 1;
                        thin = true;
                    }
                }
            }
        }
        if thin {
            return Part::Unknown;
        }
        self.claim(Target::Polygon(id), Reason::Gates(gates));
        Part::Hidden
    }

    fn finish(self) -> CellResult {
        CellResult {
            visible: self.entries.into_values().collect(),
            unknown: self.live.open(),
            accuracy: self.accuracy,
            proof: if self.options.proofs {
                self.proof.to_bytes()
            } else {
                Vec::new()
            },
            work: self.searcher.work,
        }
    }
}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Hidden,
    Visible,
    Unknown,
}
