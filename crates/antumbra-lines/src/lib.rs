//! *Which lines?* Line space: cones of lines and what is cut out of them.
//!
//! This crate never sees a scene. Lines are points, hyperplanes come as integer rows, and a set
//! of lines is a convex cone in R^6 (Plücker space, [Bittner02, ch. 8]).

mod cone;
mod quadric;
mod space;
mod start;
mod thin;

pub use cone::{Cone, ConeError, Halfspace, RaySigns, Split};
pub use quadric::{RealLines, real_lines};
pub use space::{PluckerSpace, RowId, VertexId};
pub use start::{Chord, Gate, Start, common_line, common_line_row, start_halfspaces};
pub use thin::nearly_real;
