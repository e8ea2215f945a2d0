//! *Which lines?* Line space: cones of lines and what is cut out of them.
//!
//! This crate never sees a scene. Lines are points, hyperplanes come as integer rows, and a set
//! of lines is a convex cone: in R^3 for lines through a point, parallel lines and lines of the
//! plane ([`Space3`], [`PlaneLines`]), in R^6 for lines between polygons ([`PluckerSpace`], [Bittner02, ch. 8]).
//! [`LineSpace`] is what they have in common; an [`OcclusionTree`] grows in any such space.

mod chord;
mod cone;
mod cone3;
mod line_space;
mod modular;
mod pencil;
mod plane_lines;
mod quadric;
mod space;
mod start;
mod thin;
mod tree;

pub use chord::{SegmentOccluder, SegmentOrder};
pub use cone::{Cone, ConeError, Halfspace, RaySigns, Split};
pub use cone3::{Cone3, Corner3, ExactRay, Mark, Nearness, Plane3, Ray3, Space3, primitive};
pub use line_space::{Cut, DepthSpace, Facet, Half, LineSpace, Occluder, Order, Position, Wall};
pub use pencil::{Direction, Pencil, Ray2, Wedge};
pub use plane_lines::{PlaneLines, facet};
pub use quadric::{RealLines, real_lines};
pub use space::{PluckerSpace, RowId, VertexId};
pub use start::{Chord, Gate, Start, common_line, common_line_row, start_halfspaces};
pub use thin::nearly_real;
pub use tree::{Child, Leaf, OcclusionTree, Slot, TreeNode, Visibility};
