//! *What is the sign?* The arithmetic of Antumbra: an integer grid, fixed-width integers and
//! predicates that return exact signs.
//!
//! Floats occur in two places only: [`Grid`], which snaps the scene once, and the filters inside
//! the predicates, each with its proved error bound written beside it.

mod flat;
mod grid;
pub mod plucker;
mod point;
mod sign;
mod wide;

pub use flat::{Point2, Rect, crossing2d, line2d, orient2d, side2d};
pub use grid::{Grid, Rounding, SnapError};
pub use point::{Aabb, LIMIT, Plane, Point, cross, sub};
pub use sign::Sign;
pub use wide::{I256, I512, Int};
