//! The potentially visible set of one view cell, exactly.
//!
//! Stages after the design: witnesses by casting rays; then the hierarchy of objects, front to
//! back, whole boxes first; one occluder that covers all lines (stage A); and the search over
//! Plücker cones (stage C). Every object ends up *visible* with a witness, *touching*, or *hidden*
//! by claims that the checker verifies.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use antumbra_kernel::{Aabb, Point};
use antumbra_lines::Gate;
use antumbra_scene::{
    BoxContact, CellKind, ObjectId, PolygonId, TargetKind, TargetTree, ViewCell, box_contact,
    polygons_touch,
};

use crate::caster::{Caster, Segment};
use crate::cover::{Behind, covers};
use crate::gates::{outward_face, part_in_front, polygon_gate};
use crate::line::{Between, FineLine, FinePoint, Meeting, lies_in, obstacle};
use crate::proof::{CellProof, Claim, GateProof, Reason, Target};
use crate::random::Random;
use crate::search::{Answer, Question, Searcher, Undecided};
use crate::verdict::{Accuracy, CellResult, VisibleEntry, Witness};

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
}

impl<'a> Baker<'a> {
    /// Prepares a scene; `n log n`.
    #[must_use]
    pub fn new(scene: &'a antumbra_scene::Scene) -> Self {
        Self {
            caster: Caster::new(scene),
            targets: TargetTree::new(scene),
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a antumbra_scene::Scene {
        self.caster.scene()
    }

    /// The potentially visible set of one cell. Deterministic; one thread.
    #[must_use]
    pub fn bake_cell(&self, cell: &ViewCell, options: &BakeOptions) -> CellResult {
        let mut bake = CellBake::new(self, cell, options);
        bake.find_touching();
        bake.cast_rays();
        if let Some(root) = self.targets.root() {
            bake.prove_group(root);
        }
        bake.finish()
    }
}

/// What is known of an object so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Undecided,
    Visible,
    Hidden,
    Unknown,
    /// The source itself, or an object without polygons.
    Absent,
}

/// A gate that lines leave the source through.
struct Source {
    number: u32,
    gate: Gate,
    /// The face as a flat box, for box cells.
    face: Option<Aabb>,
}

struct CellBake<'a> {
    baker: &'a Baker<'a>,
    cell: &'a ViewCell,
    options: &'a BakeOptions,
    sources: Vec<Source>,
    /// The corners whose hull is the source.
    hull: Vec<Point>,
    absent: Range<u32>,
    plane_blocks: bool,
    states: Vec<State>,
    entries: BTreeMap<ObjectId, VisibleEntry>,
    accuracy: Accuracy,
    proof: CellProof,
    searcher: Searcher,
    rng: Random,
}

/// Splits that a box may cost before its children are asked instead.
const BOX_BUDGET: u64 = 1500;
/// Free lines into a box that may be followed before its children are asked.
const BOX_TRIES: usize = 6;

impl<'a> CellBake<'a> {
    fn new(baker: &'a Baker<'a>, cell: &'a ViewCell, options: &'a BakeOptions) -> Self {
        let scene = baker.scene();
        let mut states: Vec<State> = scene
            .objects()
            .iter()
            .map(|o| {
                if o.polygons.is_empty() {
                    State::Absent
                } else {
                    State::Undecided
                }
            })
            .collect();
        let mut sources = Vec::new();
        let (absent, plane_blocks, hull) = match cell.kind {
            CellKind::Box => {
                for face in 0..6 {
                    if let Some(gate) = outward_face(&cell.bounds, face) {
                        let face_box = Aabb::around(gate.corners.iter().copied());
                        sources.push(Source {
                            number: face,
                            gate,
                            face: face_box,
                        });
                    }
                }
                (0..0, true, cell.bounds.corners().to_vec())
            }
            CellKind::Object(id) => {
                let range = scene.object(id).polygons.clone();
                let mut hull = Vec::new();
                for (k, p) in range.clone().enumerate() {
                    let polygon = scene.polygon(PolygonId(p));
                    hull.extend_from_slice(polygon.corners);
                    for against in [false, true] {
                        let number = 2 * k as u32 + u32::from(against);
                        sources.push(Source {
                            number,
                            gate: polygon_gate(&polygon, against),
                            face: None,
                        });
                    }
                }
                states[id.index()] = State::Absent;
                (range, false, hull)
            }
        };
        let name_seed = cell.name.bytes().fold(0_u64, |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3)
        });
        Self {
            baker,
            cell,
            options,
            sources,
            hull,
            absent,
            plane_blocks,
            states,
            entries: BTreeMap::new(),
            accuracy: options
                .ignore_below
                .map_or(Accuracy::Exact, Accuracy::AggressiveBelow),
            proof: CellProof::default(),
            searcher: Searcher::new(),
            rng: Random::new(options.seed ^ name_seed),
        }
    }

    fn undecided(&self, id: ObjectId) -> bool {
        self.states[id.index()] == State::Undecided
    }

    fn cancelled(&self) -> bool {
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
        scene.kd().for_each_in_box(&self.cell.bounds, |id| {
            let polygon = scene.polygon(id);
            if self.absent.contains(&id.0) {
                return;
            }
            match self.cell.kind {
                CellKind::Box => match box_contact(&polygon, &self.cell.bounds) {
                    BoxContact::Apart => {}
                    BoxContact::Touches => touching.push(polygon.object),
                    BoxContact::Enters => {
                        touching.push(polygon.object);
                        entered |= polygon.occludes;
                    }
                },
                CellKind::Object(_) => {
                    let meets = self
                        .absent
                        .clone()
                        .any(|s| polygons_touch(&scene.polygon(PolygonId(s)), &polygon));
                    if meets {
                        touching.push(polygon.object);
                    }
                }
            }
        });
        for object in touching {
            self.states[object.index()] = State::Visible;
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

    /// Stage 1: random rays through the source gates, as long as they find something.
    fn cast_rays(&mut self) {
        const BATCH: usize = 192;
        const IDLE: usize = 3;
        if self.sources.is_empty() {
            return;
        }
        let areas: Vec<f64> = self.sources.iter().map(|s| area(&s.gate)).collect();
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
                let (p, d) = random_ray(&self.sources[i].gate, &mut self.rng);
                found |= self.follow(i, p, d);
            }
            idle = if found { 0 } else { idle + 1 };
        }
    }

    /// Follows a ray from a source gate and records every undecided object it sees. Whether any.
    fn follow(&mut self, source: usize, p: [f64; 3], d: [f64; 3]) -> bool {
        let scene = self.baker.scene();
        let reach =
            4.0 * f64::from(antumbra_kernel::LIMIT) / d.iter().map(|c| c.abs()).fold(0.0, f64::max);
        let segment = Segment::new(p, std::array::from_fn(|k| p[k] + d[k] * reach));
        let caster = &self.baker.caster;
        let absent = self.absent.clone();
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
    fn confirm(&mut self, source: usize, from: [f64; 3], to: [f64; 3], id: PolygonId) -> bool {
        let (u, v) = (FinePoint::round(from), FinePoint::round(to));
        if !self.sees(source, u, v, id) {
            return false;
        }
        self.record(source, u, v, id);
        true
    }

    fn record(&mut self, source: usize, u: FinePoint, v: FinePoint, id: PolygonId) {
        let object = self.baker.scene().polygon(id).object;
        let number = self.sources[source].number;
        let witness = Witness {
            from: u,
            through: v,
            polygon: id,
            source: number,
        };
        self.states[object.index()] = State::Visible;
        self.entries.insert(
            object,
            VisibleEntry {
                object,
                touching: false,
                witness: Some(witness),
            },
        );
    }

    fn sees(&self, source: usize, u: FinePoint, v: FinePoint, id: PolygonId) -> bool {
        let gate = &self.sources[source].gate;
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
            source_plane_blocks: self.plane_blocks,
            target: polygon.plane,
            absent: &self.absent,
        };
        obstacle(&self.baker.caster, &line, &between).is_none()
    }

    /// Stage 2 for a node over several objects.
    fn prove_group(&mut self, index: u32) {
        let node = *self.baker.targets.node(index);
        if let Some(object) = node.object {
            self.prove_object(index, object);
            return;
        }
        for _ in 0..BOX_TRIES {
            if self.cancelled() {
                return;
            }
            let Some(bounds) = self.live_bounds(index) else {
                return;
            };
            match self.hide_box(&bounds) {
                Boxed::Hidden(reason) => {
                    self.claim(Target::Box(bounds), reason);
                    self.hide_all(index);
                    return;
                }
                Boxed::Seen => {}
                Boxed::Open => break,
            }
        }
        if let TargetKind::Inner(a, b) = node.kind {
            let (a, b) = if self.distance(a) <= self.distance(b) {
                (a, b)
            } else {
                (b, a)
            };
            self.prove_group(a);
            self.prove_group(b);
        }
    }

    fn claim(&mut self, target: Target, reason: Reason) {
        if self.options.proofs {
            self.proof.claims.push(Claim { target, reason });
        }
    }

    /// The box around everything undecided below a node.
    fn live_bounds(&self, index: u32) -> Option<Aabb> {
        let node = self.baker.targets.node(index);
        match (node.object, node.kind) {
            (Some(object), _) => self.undecided(object).then_some(node.bounds),
            (None, TargetKind::Inner(a, b)) => match (self.live_bounds(a), self.live_bounds(b)) {
                (Some(a), Some(b)) => Some(a.union(b)),
                (a, b) => a.or(b),
            },
            (None, TargetKind::Polygon(_)) => None,
        }
    }

    fn hide_all(&mut self, index: u32) {
        let node = *self.baker.targets.node(index);
        match (node.object, node.kind) {
            (Some(object), _) => {
                if self.undecided(object) {
                    self.states[object.index()] = State::Hidden;
                }
            }
            (None, TargetKind::Inner(a, b)) => {
                self.hide_all(a);
                self.hide_all(b);
            }
            (None, TargetKind::Polygon(_)) => {}
        }
    }

    fn distance(&self, index: u32) -> i64 {
        let (a, b) = (&self.cell.bounds, &self.baker.targets.node(index).bounds);
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
        match self.prove_part(index, object) {
            Part::Hidden => self.states[object.index()] = State::Hidden,
            Part::Visible => self.proof.claims.truncate(claims),
            Part::Unknown => {
                self.proof.claims.truncate(claims);
                self.states[object.index()] = State::Unknown;
            }
        }
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
                let (a, b) = if self.distance(a) <= self.distance(b) {
                    (a, b)
                } else {
                    (b, a)
                };
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

    /// Stages A and C for a box.
    fn hide_box(&mut self, bounds: &Aabb) -> Boxed {
        if self.cell.bounds.touches(bounds) {
            return Boxed::Open;
        }
        if let Some(reason) = self.covered(&bounds.corners(), Behind::Strictly) {
            return Boxed::Hidden(reason);
        }
        let mut gates = Vec::new();
        for source in 0..self.sources.len() {
            for face in 0..6 {
                let Some((from, to)) = self.gates_to_box(source, bounds, face) else {
                    continue;
                };
                let question = Question {
                    caster: &self.baker.caster,
                    from: &from,
                    to: &to,
                    source_plane_blocks: self.plane_blocks,
                    absent: &self.absent,
                    exact_witness: false,
                };
                match self.searcher.decide(&question, &mut self.rng, BOX_BUDGET) {
                    Answer::NoLines => {}
                    Answer::Hidden(tree) => {
                        gates.push(GateProof {
                            source: self.sources[source].number,
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

    /// The parts of a source gate and of a box face that lines can join.
    fn gates_to_box(&self, source: usize, bounds: &Aabb, face: u32) -> Option<(Gate, Gate)> {
        let source = &self.sources[source];
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
    fn covered(&mut self, targets: &[Point], behind: Behind) -> Option<Reason> {
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
        let segment = Segment::new(center(&self.hull), center(targets));
        caster.visit(
            &segment,
            (0.0, 1.0),
            crate::caster::SAMPLING_SLACK,
            |items, _, _| {
                for &id in items {
                    if caster.occludes(id)
                        && !self.absent.contains(&id.0)
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
                covers(&polygon, &self.hull, targets, behind)
                    && !(!self.plane_blocks && self.hull_in_plane(id))
            })
            .map(|polygon| Reason::Covered { polygon })
    }

    fn hull_in_plane(&self, id: PolygonId) -> bool {
        let polygon = self.baker.scene().polygon(id);
        self.sources
            .iter()
            .any(|s| lies_in(&polygon, &s.gate.plane))
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
        for source in 0..self.sources.len() {
            for against in [false, true] {
                let to = polygon_gate(&polygon, against);
                let question = Question {
                    caster: &self.baker.caster,
                    from: &self.sources[source].gate,
                    to: &to,
                    source_plane_blocks: self.plane_blocks,
                    absent: &self.absent,
                    exact_witness: true,
                };
                match self.searcher.decide(&question, &mut self.rng, budget) {
                    Answer::NoLines => {}
                    Answer::Hidden(tree) => {
                        let number = self.sources[source].number;
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
                        return Part::Unknown;
                    }
                    Answer::Undecided(why) => {
                        self.count(why);
                        return Part::Unknown;
                    }
                }
            }
        }
        self.claim(Target::Polygon(id), Reason::Gates(gates));
        Part::Hidden
    }

    fn count(&mut self, why: Undecided) {
        match why {
            Undecided::Budget => self.searcher.work.over_budget += 1,
            Undecided::Thin => self.searcher.work.thin += 1,
        }
    }

    fn finish(self) -> CellResult {
        let mut unknown = Vec::new();
        for (i, state) in self.states.iter().enumerate() {
            if matches!(state, State::Undecided | State::Unknown) {
                unknown.push(ObjectId(i as u32));
            }
        }
        CellResult {
            visible: self.entries.into_values().collect(),
            unknown,
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

enum Boxed {
    Hidden(Reason),
    /// A free line into the box showed an undecided object.
    Seen,
    /// Not shown to be hidden.
    Open,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Hidden,
    Visible,
    Unknown,
}

fn area(gate: &Gate) -> f64 {
    let c: Vec<[f64; 3]> = gate.corners.iter().map(|p| p.to_f64()).collect();
    let mut sum = [0.0; 3];
    for i in 1..c.len() - 1 {
        let u: [f64; 3] = std::array::from_fn(|k| c[i][k] - c[0][k]);
        let v: [f64; 3] = std::array::from_fn(|k| c[i + 1][k] - c[0][k]);
        let n = crate::caster::cross(u, v);
        for k in 0..3 {
            sum[k] += n[k];
        }
    }
    crate::caster::dot(sum, sum).sqrt() / 2.0
}

/// A point of a gate, uniform in a random triangle of its fan, and a cosine-weighted direction.
fn random_ray(gate: &Gate, rng: &mut Random) -> ([f64; 3], [f64; 3]) {
    let c = &gate.corners;
    let i = 1 + (rng.bits() % (c.len() as u64 - 2)) as usize;
    let (mut a, mut b) = (rng.unit(), rng.unit());
    if a + b > 1.0 {
        (a, b) = (1.0 - a, 1.0 - b);
    }
    let (o, u, v) = (c[0].to_f64(), c[i].to_f64(), c[i + 1].to_f64());
    let p = std::array::from_fn(|k| o[k] + a * (u[k] - o[k]) + b * (v[k] - o[k]));
    let n = gate.plane.normal.map(|x| x as f64);
    let len = crate::caster::dot(n, n).sqrt();
    let n = n.map(|x| x / len);
    // A unit vector uniform on the sphere, added to the normal, is cosine-weighted.
    let z = 2.0 * rng.unit() - 1.0;
    let phi = 2.0 * std::f64::consts::PI * rng.unit();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let s = [r * phi.cos(), r * phi.sin(), z];
    (p, std::array::from_fn(|k| n[k] * 1.0001 + s[k]))
}
