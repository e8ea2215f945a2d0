//! Synthetic scenes, so that the tables of the papers can be rebuilt by anyone.
//!
//! Every generator is a pure function from its parameters (and a seed, where chance is involved)
//! to a [`SceneInput`](crate::SceneInput) in metres, Z-up: the same parameters give the same
//! scene on every machine. What the papers leave open (boxes, distances, furniture) is fixed
//! here and stated where it is chosen.
//!
//! | generator | rebuilds |
//! |---|---|
//! | [`random_triangles`] | \[Bittner02, 8.14.1\] tests R1 to R9 |
//! | [`random_segments`] | \[Bittner02, 6.7\] plans of 1,000 to 20,000 random segments |
//! | [`layers`] | \[Bittner02, 8.14.2\] tests S1 to S6: walls and chessboards |
//! | [`office`] | \[Chry96\]: offices of 139 to 751 polygons with a light |
//! | [`floor`] | \[TS92\]: a furnished office floor; also the scene of `antumbra demo` |
//! | [`maze`] | \[Bittner02, 4.8\] `big-7`: a maze of furnished rooms |
//!
//! A number of polygons is the number of faces handed to the builder, which may merge coplanar
//! neighbours of one object.

mod floor;
mod furniture;
mod layers;
mod maze;
mod office;
mod rng;
mod segments;
mod shape;
mod triangles;
mod wall;

pub use floor::{FloorPlan, floor};
pub use layers::{LayerParams, LayerPattern, layers};
pub use maze::{MazeParams, maze};
pub use office::{OfficeKind, office};
pub use rng::SplitMix64;
pub use segments::{SegmentParams, random_segments};
pub use triangles::{TriangleParams, random_triangles};

/// The name of the object that acts as the source in the scenes of the thesis.
pub const SOURCE: &str = "source";

/// Counts the faces of a scene: the "number of polygons" of the papers' tables.
///
/// ```
/// use antumbra_scene::synth::{OfficeKind, face_count, office};
/// assert_eq!(face_count(&office(OfficeKind::Office1)), 139);
/// ```
#[must_use]
pub fn face_count(scene: &crate::SceneInput) -> usize {
    scene
        .objects
        .iter()
        .flat_map(|o| &o.parts)
        .map(|p| p.faces.len())
        .sum()
}
