//! The polygons of a scene as the oracles want them, and exact decisions about single segments.

use antumbra::region::{VisibleEntry, Witness};
use antumbra::scene::{CellKind, ObjectId, PolygonId, Scene, ViewCell};
use antumbra_kernel::Point;
use antumbra_sweep::{FINE_BITS, FinePoint};
use antumbra_testkit::determinant::sign;
use antumbra_testkit::rational::RationalPoint;
use antumbra_testkit::sampler::{Segment, check};
use antumbra_testkit::scene::{Polygon, Source, View, meets_box};
use antumbra_testkit::segment::{Contact, contact, height};
use dashu_int::IBig;

/// A scene in plain numbers.
pub(crate) struct Judge {
    polygons: Vec<Polygon>,
    owners: Vec<u32>,
    boxes: Vec<[[f64; 3]; 2]>,
}

/// Where a segment starts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Start {
    /// In the open box of a cell.
    Box([i64; 3], [i64; 3]),
    /// On a polygon of an object that takes no other part.
    On(usize, ObjectId),
}

impl Judge {
    pub(crate) fn new(scene: &Scene) -> Self {
        let grid = |c: &[Point]| -> Vec<[i64; 3]> { c.iter().map(|p| p.to_i64()).collect() };
        let polygons: Vec<Polygon> = scene
            .polygons()
            .map(|p| Polygon {
                object: String::new(),
                corners: grid(p.corners),
                occludes: p.occludes,
            })
            .collect();
        let bound = |p: &Polygon| {
            let of = |k: usize, f: fn(i64, i64) -> i64| {
                p.corners.iter().map(|c| c[k]).reduce(f).unwrap_or(0) as f64
            };
            [
                [0, 1, 2].map(|k| of(k, i64::min)),
                [0, 1, 2].map(|k| of(k, i64::max)),
            ]
        };
        Self {
            boxes: polygons.iter().map(bound).collect(),
            owners: scene.polygons().map(|p| p.object.0).collect(),
            polygons,
        }
    }

    pub(crate) fn polygons(&self) -> &[Polygon] {
        &self.polygons
    }

    /// How many objects there are, those without polygons at the end left out.
    pub(crate) fn objects(&self) -> usize {
        self.owners
            .iter()
            .map(|&o| o as usize + 1)
            .max()
            .unwrap_or(0)
    }

    pub(crate) fn owner(&self, polygon: usize) -> ObjectId {
        ObjectId(self.owners[polygon])
    }

    pub(crate) fn polygons_of(&self, object: ObjectId) -> impl Iterator<Item = usize> + '_ {
        (0..self.polygons.len()).filter(move |&i| self.owners[i] == object.0)
    }

    /// Whether a segment, both ends included, proves the target visible; if not, why.
    pub(crate) fn proves(
        &self,
        start: Start,
        segment: &Segment,
        target: usize,
    ) -> Result<(), String> {
        let ends = [segment[0].to_f64(), segment[1].to_f64()];
        let absent = match start {
            Start::Box(..) => None,
            Start::On(_, object) => Some(object.0),
        };
        let mut near = vec![self.polygons[target].clone()];
        let source = match start {
            Start::Box(min, max) => Source::Cell { min, max },
            Start::On(polygon, _) => {
                near.push(self.polygons[polygon].clone());
                Source::Polygon(1)
            }
        };
        let others = (0..self.polygons.len())
            .filter(|&i| i != target && Some(self.owners[i]) != absent)
            .filter(|&i| may_meet(ends, &self.boxes[i]));
        near.extend(others.map(|i| self.polygons[i].clone()));
        let view = View {
            polygons: &near,
            source: &source,
            target: 0,
        };
        check(&view, segment).map_err(|refusal| format!("{refusal:?}"))
    }

    /// The segment of a witness, from inside the source to the target's plane.
    pub(crate) fn sight(
        &self,
        scene: &Scene,
        cell: &ViewCell,
        witness: &Witness,
    ) -> Result<(Start, Segment), String> {
        let (from, through) = (rational(witness.from), rational(witness.through));
        if from == through {
            return Err("its points coincide".to_owned());
        }
        let target = &self.polygons[witness.polygon.index()].corners;
        match cell.kind {
            CellKind::Box => {
                let (min, max) = (cell.bounds.min.to_i64(), cell.bounds.max.to_i64());
                let inside = (0..60).find_map(|k| {
                    let weights = [(IBig::ONE << k) + IBig::ONE, -IBig::ONE];
                    let p = RationalPoint::mean(&[&from, &through], &weights);
                    antumbra_testkit::scene::inside_box(&p, min, max).then_some(p)
                });
                let start = inside.ok_or("it does not come from inside the cell")?;
                let to = ahead(&start, &through, target).ok_or("it does not meet the target")?;
                Ok((Start::Box(min, max), [start, to]))
            }
            CellKind::Object(object) => {
                let first = scene.object(object).polygons.start;
                self.sight_from(object, first + witness.source / 2, witness)
            }
        }
    }

    /// The segment of a witness from a polygon.
    pub(crate) fn sight_from(
        &self,
        object: ObjectId,
        source: u32,
        witness: &Witness,
    ) -> Result<(Start, Segment), String> {
        let (from, through) = (rational(witness.from), rational(witness.through));
        let source = source as usize;
        let at = |polygon: usize| {
            meet(&from, &through, &self.polygons[polygon].corners)
                .ok_or("its line runs along a plane")
        };
        let segment = [at(source)?, at(witness.polygon.index())?];
        Ok((Start::On(source, object), segment))
    }

    /// Whether a witness proves its polygon visible.
    pub(crate) fn believe(
        &self,
        scene: &Scene,
        cell: &ViewCell,
        witness: &Witness,
    ) -> Result<(), String> {
        let (start, segment) = self.sight(scene, cell, witness)?;
        self.proves(start, &segment, witness.polygon.index())
    }

    /// Whether an object meets the closed cell.
    pub(crate) fn touches(&self, scene: &Scene, cell: &ViewCell, object: ObjectId) -> bool {
        let (min, max) = (cell.bounds.min.to_i64(), cell.bounds.max.to_i64());
        let polygons = scene.object(object).polygons.clone();
        polygons.map(|i| i as usize).any(|i| {
            let corners = &self.polygons[i].corners;
            match cell.kind {
                CellKind::Box => meets_box(corners, min, max, false),
                CellKind::Object(source) => {
                    let own = scene.object(source).polygons.clone();
                    own.map(|k| &self.polygons[k as usize].corners)
                        .any(|other| meet_each_other(corners, other))
                }
            }
        })
    }

    /// Whether an occluder meets the open interior of a box.
    pub(crate) fn entered(&self, cell: &ViewCell) -> bool {
        let (min, max) = (cell.bounds.min.to_i64(), cell.bounds.max.to_i64());
        let enters = |p: &Polygon| p.occludes && meets_box(&p.corners, min, max, true);
        self.polygons.iter().any(enters)
    }

    /// Checks all entries of a result: witnesses that prove, and *touching* exactly where it is so.
    pub(crate) fn check_entries(
        &self,
        scene: &Scene,
        cell: &ViewCell,
        visible: &[VisibleEntry],
    ) -> Result<usize, String> {
        let mut followed = 0;
        for entry in visible {
            let fail = |why: &str| {
                let name = &scene.object(entry.object).name;
                format!(
                    "cell {}, object {} {name:?}: {why}",
                    cell.name, entry.object.0
                )
            };
            if entry.touching != self.touches(scene, cell, entry.object) {
                return Err(fail(&format!("touching is said to be {}", entry.touching)));
            }
            match &entry.witness {
                None if entry.touching => {}
                None => return Err(fail("no witness")),
                Some(witness) => {
                    if scene.polygon(witness.polygon).object != entry.object {
                        return Err(fail("the witness sees another object"));
                    }
                    self.believe(scene, cell, witness)
                        .map_err(|why| fail(&why))?;
                    followed += 1;
                }
            }
        }
        // What touches and is not listed is an error, too.
        for i in 0..scene.objects().len() as u32 {
            let object = ObjectId(i);
            let absent = matches!(cell.kind, CellKind::Object(source) if source == object);
            let listed = visible.binary_search_by_key(&object, |e| e.object).is_ok();
            if !absent && !listed && self.touches(scene, cell, object) {
                return Err(format!(
                    "cell {}: object {i} touches and is not listed",
                    cell.name
                ));
            }
        }
        Ok(followed)
    }
}

/// A fine point, exactly.
pub(crate) fn rational(p: FinePoint) -> RationalPoint {
    RationalPoint::new(p.0.map(IBig::from), IBig::ONE << FINE_BITS as usize)
}

/// Where the line through two points meets a polygon's plane.
fn meet(a: &RationalPoint, b: &RationalPoint, polygon: &[[i64; 3]]) -> Option<RationalPoint> {
    let (ha, hb) = (height(polygon, a), height(polygon, b));
    let bottom = &ha * b.denominator() - &hb * a.denominator();
    if sign(&bottom) == 0 {
        return None;
    }
    let at = |k: usize| &ha * &b.numerators()[k] - &hb * &a.numerators()[k];
    Some(RationalPoint::new([at(0), at(1), at(2)], bottom))
}

/// The same, if it lies ahead.
pub(crate) fn ahead(
    from: &RationalPoint,
    through: &RationalPoint,
    polygon: &[[i64; 3]],
) -> Option<RationalPoint> {
    let (start, then) = (height(polygon, from), height(polygon, through));
    let toward = &start * through.denominator() - &then * from.denominator();
    let is_ahead = sign(&start) != 0 && sign(&toward) == sign(&start);
    is_ahead.then(|| meet(from, through, polygon)).flatten()
}

/// Whether two closed convex polygons share a point: then an edge of one meets the other.
pub(crate) fn meet_each_other(a: &[[i64; 3]], b: &[[i64; 3]]) -> bool {
    let edge_meets = |p: &[[i64; 3]], q: &[[i64; 3]]| {
        (0..p.len()).any(|i| {
            let ends = [p[i], p[(i + 1) % p.len()]].map(RationalPoint::from_grid);
            contact(&ends[0], &ends[1], q) != Contact::Miss
        })
    };
    edge_meets(a, b) || edge_meets(b, a)
}

/// Whether a segment may meet a box, with a step to spare. Floats: it only saves work.
fn may_meet([a, b]: [[f64; 3]; 2], [low, high]: &[[f64; 3]; 2]) -> bool {
    let (mut enter, mut leave) = (-1e-3_f64, 1.0 + 1e-3_f64);
    for k in 0..3 {
        let (d, lo, hi) = (b[k] - a[k], low[k] - 1.0 - a[k], high[k] + 1.0 - a[k]);
        if d.abs() < 1e-6 {
            if lo > 1e-3 || hi < -1e-3 {
                return false;
            }
        } else {
            let (s, t) = (lo / d, hi / d);
            enter = enter.max(s.min(t) - 1e-6);
            leave = leave.min(s.max(t) + 1e-6);
        }
    }
    enter <= leave
}

/// The identifier of a polygon by its index.
pub(crate) fn id(polygon: usize) -> PolygonId {
    PolygonId(polygon as u32)
}
