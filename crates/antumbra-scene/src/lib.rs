//! *Where are things?* Object space: snapped polygonal scenes, their kD-tree and view cells.
//!
//! This crate never sees a line: what can be seen is decided where it meets line space.

mod builder;
mod input;
mod kd;
mod report;
mod scene;
pub mod synth;

pub use builder::{BuildError, SceneBuilder};
pub use input::{Faces, ObjectInput, OccluderPolicy, PartInput, SceneInput};
pub use kd::{KdBox, KdHeuristic, KdNode, KdTree, SeenPolygons};
pub use report::{BuildReport, ObjectRepairs, RepairCounts};
pub use scene::{Object, ObjectId, PolygonId, PolygonRef, Scene};
