//! Plans: what a cell of the plane sees of walls, exactly.

pub use antumbra_scene::plan::{
    CellShape, Owner, PieceId, Plan, PlanCell, PlanCellError, PlanError, PlanInput, PlanOptions,
    PlanReport, PlanSegment, SegmentId,
};
pub use antumbra_sweep::occlusion::{BoxTest, SweepOrder};
pub use antumbra_sweep::plan::{
    Fragment, Funnel, PlanLine, PlanView, PlanWork, Ratio, ViewOptions, Window, look,
};
