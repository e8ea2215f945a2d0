//! Does A see B? Polygons, objects and points, in any combination.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use antumbra_kernel::{Point, SnapError};
use antumbra_scene::{ObjectId, PolygonId, Scene};
use antumbra_sweep::{
    BakeOptions, Baker, Caster, FineLine, PointVerdict, Surface, Verdict, Witness, Work,
};

/// One end of a question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PairEnd {
    /// An object: sees, or is seen, if one of its polygons is.
    Object(ObjectId),
    /// A polygon.
    Polygon(PolygonId),
    /// A point in scene units; snapped to the nearest grid point.
    Point([f64; 3]),
}

/// Options of a question.
#[derive(Clone, Debug, Default)]
pub struct PairOptions {
    /// Seed of the sampling; the verdict does not depend on it.
    pub seed: u64,
    /// Upper bound on splits; deterministic.
    pub max_splits: Option<u64>,
    /// Set to stop.
    pub cancel: Option<Arc<AtomicBool>>,
}

/// The verdict. Only `Hidden` may be culled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairVerdict {
    /// An open set of segments between the two is free (for two points: the segment is).
    Visible,
    /// There is none.
    Hidden,
    /// A budget or a cancellation came first.
    Unknown,
}

/// The answer to a question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairAnswer {
    /// The verdict.
    pub verdict: PairVerdict,
    /// A free segment in scene units, verified before it was rounded.
    pub witness: Option<[[f64; 3]; 2]>,
    /// Leaves of the proof of *hidden*.
    pub leaves: u64,
    /// Splits of cones.
    pub splits: u64,
}

/// A scene prepared for questions about pairs.
#[derive(Clone, Debug)]
pub struct Pairs<'a> {
    baker: Baker<'a>,
}

impl<'a> Pairs<'a> {
    /// Prepares a scene; `n log n`.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            baker: Baker::new(scene),
        }
    }

    /// Decides whether `from` sees `to`. Exact for the snapped scene.
    ///
    /// # Errors
    /// If a point is not finite or off the scene's grid.
    pub fn decide(
        &self,
        from: &PairEnd,
        to: &PairEnd,
        options: &PairOptions,
    ) -> Result<PairAnswer, SnapError> {
        match (*from, *to) {
            (PairEnd::Point(a), PairEnd::Point(b)) => self.points(a, b),
            (PairEnd::Point(p), surface) => self.point(p, surface, false),
            (surface, PairEnd::Point(p)) => self.point(p, surface, true),
            (a, b) => Ok(self.surfaces(a, b, options)),
        }
    }

    fn scene(&self) -> &'a Scene {
        self.baker.scene()
    }

    fn surfaces(&self, from: PairEnd, to: PairEnd, options: &PairOptions) -> PairAnswer {
        let options = BakeOptions {
            seed: options.seed,
            max_splits: options.max_splits,
            cancel: options.cancel.clone(),
            ..BakeOptions::default()
        };
        let (Some(a), Some(b)) = (surface(from), surface(to)) else {
            return answer(PairVerdict::Hidden, None, Work::default());
        };
        let result = self.baker.pair(a, b, &options);
        match result.verdict {
            Verdict::Visible { witness, .. } => {
                let ends = self.ends(&witness, a);
                answer(PairVerdict::Visible, ends, result.work)
            }
            Verdict::Hidden(_) => answer(PairVerdict::Hidden, None, result.work),
            Verdict::Unknown => answer(PairVerdict::Unknown, None, result.work),
        }
    }

    /// The witness from source polygon to target polygon, in scene units.
    fn ends(&self, witness: &Witness, from: Surface) -> Option<[[f64; 3]; 2]> {
        let scene = self.scene();
        let line = FineLine::new(witness.from, witness.through)?;
        let source = PolygonId(from.polygons(scene).start + witness.source / 2);
        let at = |id: PolygonId| {
            let p = line.at_plane(scene.polygon(id).plane)?;
            Some(scene.grid().to_scene_f64(p))
        };
        Some([at(source)?, at(witness.polygon)?])
    }

    fn point(&self, p: [f64; 3], to: PairEnd, reversed: bool) -> Result<PairAnswer, SnapError> {
        let eye = self.scene().grid().snap(p)?;
        let caster = self.baker.caster();
        let (mut splits, mut leaves) = (0, 0);
        let polygons = surface(to).map_or(0..0, |s| s.polygons(self.scene()));
        for id in polygons.map(PolygonId) {
            match caster.point_sees(eye, id) {
                PointVerdict::Visible { at, splits: s } => {
                    let grid = self.scene().grid();
                    let mut witness = [grid.to_scene(eye), grid.to_scene_f64(at)];
                    if reversed {
                        witness.reverse();
                    }
                    let witness = Some(witness);
                    let verdict = PairVerdict::Visible;
                    return Ok(PairAnswer {
                        verdict,
                        witness,
                        leaves: 0,
                        splits: splits + s,
                    });
                }
                PointVerdict::Hidden {
                    splits: s,
                    leaves: l,
                } => {
                    splits += s;
                    leaves += l;
                }
            }
        }
        Ok(PairAnswer {
            verdict: PairVerdict::Hidden,
            witness: None,
            leaves,
            splits,
        })
    }

    fn points(&self, a: [f64; 3], b: [f64; 3]) -> Result<PairAnswer, SnapError> {
        let grid = self.scene().grid();
        let (u, v): (Point, Point) = (grid.snap(a)?, grid.snap(b)?);
        let caster: &Caster<'_> = self.baker.caster();
        let free = caster.trace(u, v).is_none_or(|t| t.hits.is_empty());
        let witness = free.then(|| [grid.to_scene(u), grid.to_scene(v)]);
        let verdict = if free {
            PairVerdict::Visible
        } else {
            PairVerdict::Hidden
        };
        Ok(PairAnswer {
            verdict,
            witness,
            leaves: u64::from(!free),
            splits: 0,
        })
    }
}

fn surface(end: PairEnd) -> Option<Surface> {
    match end {
        PairEnd::Object(id) => Some(Surface::Object(id)),
        PairEnd::Polygon(id) => Some(Surface::Polygon(id)),
        PairEnd::Point(_) => None,
    }
}

fn answer(verdict: PairVerdict, witness: Option<[[f64; 3]; 2]>, work: Work) -> PairAnswer {
    PairAnswer {
        verdict,
        witness,
        leaves: work.leaves,
        splits: work.splits,
    }
}
