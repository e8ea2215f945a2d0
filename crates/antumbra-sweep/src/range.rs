//! How far away things are from the source of the lines [Bittner02, 6.5.5].

/// Bounds of a distance that grows along all lines: nowhere nearer than, nowhere farther than.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// A lower bound.
    pub near: u32,
    /// An upper bound.
    pub far: u32,
}
