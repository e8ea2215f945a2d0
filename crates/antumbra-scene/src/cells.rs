//! View cells: the closed convex regions that visibility is asked from.

use antumbra_kernel::Aabb;

use crate::ObjectId;

/// A view cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewCell {
    /// Its name in outputs.
    pub name: String,
    /// Its box on the grid, snapped outwards; of an object cell the object's bounds.
    pub bounds: Aabb,
    /// What the source is.
    pub kind: CellKind,
}

/// What lines of a view cell start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// The open interior of the box.
    Box,
    /// The polygons of an object, which take no other part.
    Object(ObjectId),
}
