//! Random segments with middles in a square: the plans of [Bittner02, 6.7].

use super::SplitMix64;
use crate::plan::{PlanInput, PlanSegment};

/// Parameters of [`random_segments`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentParams {
    /// How many segments.
    pub count: u32,
    /// The longest one in metres; they are evenly distributed up to it. The paper leaves it open: 130 / sqrt(count)
    /// makes cells see about as many of them as there.
    pub length: f64,
    /// The seed.
    pub seed: u64,
}

impl SegmentParams {
    /// The usual length.
    #[must_use]
    pub fn new(count: u32, seed: u64) -> Self {
        Self {
            count,
            length: 130.0 / f64::from(count.max(1)).sqrt(),
            seed,
        }
    }
}

/// Side of the square in metres.
const SIDE: f64 = 100.0;

/// Segments with directions and lengths that are evenly distributed and middles that are so in a square of 100 m,
/// which ends may leave by half a length; coordinates are multiples of 1/8192 m. One shorter than that may be a point.
///
/// ```
/// use antumbra_scene::synth::{SegmentParams, random_segments};
/// let plan = random_segments(&SegmentParams::new(1000, 1));
/// assert_eq!(plan.segments.len(), 1000);
/// assert_eq!(plan, random_segments(&SegmentParams::new(1000, 1)));
/// ```
#[must_use]
pub fn random_segments(params: &SegmentParams) -> PlanInput {
    let mut random = SplitMix64::new(params.seed);
    let mut plan = PlanInput::default();
    let class = plan.class("");
    let round = |v: f64| (v * 8192.0).round() / 8192.0;
    for feature in 0..params.count {
        let middle = [random.range(0.0, SIDE), random.range(0.0, SIDE)];
        let half = random.range(0.0, params.length) / 2.0;
        let (sin, cos) = random.range(0.0, std::f64::consts::PI).sin_cos();
        let end = |sign: f64| {
            let [x, y] = middle;
            [x + sign * half * cos, y + sign * half * sin].map(round)
        };
        plan.segments.push(PlanSegment {
            ends: [end(-1.0), end(1.0)],
            class,
            feature,
        });
    }
    plan
}
