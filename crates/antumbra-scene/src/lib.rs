//! *Where are things?* Object space: snapped polygonal scenes, their kD-tree and view cells.
//!
//! This crate never sees a line: what can be seen is decided where it meets line space.

mod builder;
mod cells;
mod input;
mod kd;
mod meet;
pub mod plan;
mod report;
mod scene;
pub mod synth;
mod target_tree;

pub use builder::{BuildError, FusedOccluder, SceneBuilder, fuse_occluders};
pub use cells::{
    CellError, CellKind, CellSpec, CellSpecError, MAX_CELLS, NamedBox, ViewCell, make_cells,
};
pub use input::{Faces, ObjectInput, OccluderPolicy, PartInput, SceneInput};
pub use kd::{BoxFace, KdBox, KdHeuristic, KdNode, KdTree, Ropes, SeenPolygons};
pub use meet::{BoxContact, box_contact, polygons_touch};
pub use report::{BuildReport, ObjectRepairs, RepairCounts};
pub use scene::{Object, ObjectId, PolygonId, PolygonRef, Scene};
pub use target_tree::{TargetKind, TargetNode, TargetTree};
