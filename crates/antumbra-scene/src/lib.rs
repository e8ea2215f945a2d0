//! *Where are things?* Object space: snapped polygonal scenes, their kD-tree and view cells.
//!
//! This crate never sees a line: what can be seen is decided where it meets line space.

mod input;
mod kd;
mod scene;
pub mod synth;

pub use input::{Faces, ObjectInput, OccluderPolicy, PartInput, SceneInput};
pub use kd::{KdNode, KdTree};
pub use scene::{Object, ObjectId, PolygonId, PolygonRef, Scene};
