//! Plans: what a room, a street or a point of the plane sees of walls, exactly.
//!
//! A [`Plan`] is made of segments, a [`PlanCell`] is a polygon, a segment or a point. [`see`] says which
//! segments the cell sees, which fragments of them, and through which lines; [`see_all`] does so for many
//! cells at once; [`isovist()`] is the area that is seen; [`mutual`] asks whether two cells see each other.
//!
//! ```
//! use antumbra::plan::{Plan, PlanCell, PlanInput, PlanOptions, PlanSegment, SeeOptions, see};
//! // A wall, and a longer one behind it.
//! let wall = |a, b| PlanSegment { ends: [a, b], class: 0, feature: 0 };
//! let input = PlanInput {
//!     segments: vec![wall([-2.0, 2.0], [2.0, 2.0]), wall([-9.0, 4.0], [9.0, 4.0])],
//!     ..PlanInput::default()
//! };
//! let plan = Plan::build(&input, &PlanOptions::default())?;
//! let cell = PlanCell::new(&plan, &[[-1.0, 0.0], [1.0, 0.0]])?;
//! let seen = see(&plan, &cell, &SeeOptions::default());
//! assert_eq!(seen.segments[0].fragments, [[0.0, 1.0]]);
//! // From 1 past the end at 2 one sees the far wall from 3 on.
//! assert_eq!(seen.segments[1].fragments, [[0.0, 6.0 / 18.0], [12.0 / 18.0, 1.0]]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod isovist;
mod mutual;
mod seen;

pub use antumbra_scene::plan::{
    CellShape, Owner, PieceId, Plan, PlanCell, PlanCellError, PlanError, PlanInput, PlanKd,
    PlanNode, PlanOptions, PlanReport, PlanSegment, SegmentId,
};
pub use antumbra_sweep::occlusion::{BoxTest, SweepOrder};
pub use antumbra_sweep::plan::{
    Fragment, Funnel, Growth, PlanLine, PlanView, PlanWork, Ratio, Sight,
    ViewOptions as SeeOptions, Window, look,
};
pub use antumbra_sweep::{Accuracy, PlanCheck, PlanProof};
pub use check::check;
pub use isovist::{Isovist, isovist};
pub use mutual::{mutual, mutual_matrix};
pub use seen::{Seen, SeenSegment, see, see_all};
