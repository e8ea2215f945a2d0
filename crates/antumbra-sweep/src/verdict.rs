//! Answers: what is visible, with a witness each, and what is not known.

use antumbra_kernel::Point;
use antumbra_scene::{ObjectId, PolygonId};

use crate::search::Work;

/// Fine coordinates count 2^-FINE_BITS grid steps.
pub const FINE_BITS: u32 = 16;
const FINE: f64 = (1_u64 << FINE_BITS) as f64;

/// A point with coordinates in units of 2^-16 grid steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FinePoint(pub [i64; 3]);

impl FinePoint {
    /// The nearest fine point to fractional grid coordinates.
    #[must_use]
    pub fn round(p: [f64; 3]) -> Self {
        Self(p.map(|c| (c * FINE).round() as i64))
    }

    /// A grid point.
    #[must_use]
    pub fn from_grid(p: Point) -> Self {
        Self(p.to_i64().map(|c| c << FINE_BITS))
    }

    /// Fractional grid coordinates, for sampling and output.
    #[must_use]
    pub fn to_f64(self) -> [f64; 3] {
        self.0.map(|c| c as f64 / FINE)
    }
}

/// A free line of sight: the proof of *visible*.
///
/// The line through both points leaves the source's interior, crosses the polygon's interior and
/// strictly misses every occluder in between, so that an open set of lines around it is free too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Witness {
    /// Where the line leaves the source; on the boundary of a box cell exactly.
    pub from: FinePoint,
    /// Another point of the line, near the polygon.
    pub through: FinePoint,
    /// The polygon that is seen.
    pub polygon: PolygonId,
    /// Number of the source gate, see [`crate::GateProof`].
    pub source: u32,
}

/// An object of a potentially visible set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibleEntry {
    /// The object.
    pub object: ObjectId,
    /// Whether it meets the closed cell; such objects need no witness.
    pub touching: bool,
    /// The free line, for all others.
    pub witness: Option<Witness>,
}

/// How far a result can be trusted, after [Bittner02, 2.3.2].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Neither too much nor too little.
    Exact,
    /// Nothing is missing: an occluder meets the open cell and only its part outside was used.
    Conservative,
    /// Sets of lines below this angle (radians) were ignored.
    AggressiveBelow(f64),
}

/// The result for one view cell.
#[derive(Clone, Debug)]
pub struct CellResult {
    /// Visible objects in order.
    pub visible: Vec<VisibleEntry>,
    /// Objects that a budget or a cancellation left undecided, in order; never to be culled.
    pub unknown: Vec<ObjectId>,
    /// How far the result can be trusted.
    pub accuracy: Accuracy,
    /// The canonical bytes of the certificate of everything hidden.
    pub proof: Vec<u8>,
    /// What was done.
    pub work: Work,
}
