//! *What can be seen from here?* Exact visibility in polygonal scenes, with a certificate for
//! every answer.
//!
//! The scene is snapped once to an integer grid; everything after is exact. See [`region`] for
//! potentially visible sets, [`pair`] for two polygons, objects or points, [`ray`](mod@ray) for one
//! line, [`map`] for everything seen from a point, [`shadow`] for what a light reaches, [`plan`] for
//! floor plans and city maps in the plane. [`cull`] is for cameras in real time: in floats, without
//! certificates, and never wrong about what it culls.

pub mod cull;
pub mod map;
pub mod pair;
pub mod plan;
pub mod ray;
pub mod region;
pub mod shadow;

pub use antumbra_kernel as kernel;
pub use antumbra_scene as scene;
