//! Placeholder until pairs are there.
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use antumbra_scene::{ObjectId, PolygonId, Scene};

/// One end of a question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PairEnd {
    /// An object.
    Object(ObjectId),
    /// A polygon.
    Polygon(PolygonId),
    /// A point in scene units.
    Point([f64; 3]),
}

/// Options.
#[derive(Clone, Debug, Default)]
pub struct PairOptions {
    /// Seed of the sampling.
    pub seed: u64,
    /// Budget.
    pub max_splits: Option<u64>,
    /// Set to stop.
    pub cancel: Option<Arc<AtomicBool>>,
}

/// The verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairVerdict {
    /// Visible.
    Visible,
    /// Hidden.
    Hidden,
    /// Unknown.
    Unknown,
}

/// The answer.
#[derive(Clone, Copy, Debug)]
pub struct PairAnswer {
    /// The verdict.
    pub verdict: PairVerdict,
    /// A free segment in scene units.
    pub witness: Option<[[f64; 3]; 2]>,
    /// Leaves of the proof.
    pub leaves: u64,
    /// Splits.
    pub splits: u64,
}

/// A scene prepared for questions.
#[derive(Clone, Debug)]
#[allow(dead_code)]
pub struct Pairs<'a>(&'a Scene);

impl<'a> Pairs<'a> {
    /// Prepares.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self(scene)
    }

    /// Placeholder: unknown.
    ///
    /// # Errors
    /// Never.
    pub fn decide(
        &self,
        _from: &PairEnd,
        _to: &PairEnd,
        _options: &PairOptions,
    ) -> Result<PairAnswer, std::convert::Infallible> {
        Ok(PairAnswer {
            verdict: PairVerdict::Unknown,
            witness: None,
            leaves: 0,
            splits: 0,
        })
    }
}
