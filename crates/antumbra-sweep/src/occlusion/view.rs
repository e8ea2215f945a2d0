//! What a sweep needs to know about the lines it follows: how polygons and boxes become pieces.

use antumbra_kernel::{Aabb, Plane, Point, Sign};
use antumbra_lines::{DepthSpace, LineSpace, Mark, Occluder, OcclusionTree, Slot};
use antumbra_scene::PolygonRef;

pub use crate::range::Range;

/// The hyperplanes of a view's line space.
pub(crate) type PlaneOf<V> = <<V as View>::Space as LineSpace>::Plane;
type PieceOf<V> = <<V as View>::Space as LineSpace>::Piece;

/// The lines that meet a box.
#[derive(Clone, Debug)]
pub enum Region<T> {
    /// The source touches the box.
    Touching,
    /// No open set of lines meets the box.
    Nowhere,
    /// A convex piece that holds them.
    Piece(T),
}

/// From which side planes are seen: all that the test of a box against a blocked leaf needs.
pub trait Sides {
    /// The sign of the plane's normal along the lines: positive if it points away from the source,
    /// zero if the plane is seen edge-on. Exact.
    fn away(&self, plane: &Plane) -> Sign;

    /// Whether a closed box lies behind a plane, or on it, as seen from the source. Exact.
    fn behind(&self, bounds: &Aabb, plane: &Plane) -> bool {
        let side = self.away(plane).flip();
        side != Sign::Zero && none_beyond(bounds, plane, side)
    }
}

/// A source of lines, and the line space they fill.
pub trait View {
    /// The line space.
    type Space: DepthSpace;
    /// From which side it sees planes.
    type Sides: Sides;

    /// The line space.
    fn space(&mut self) -> &mut Self::Space;

    /// Frames the tree before the sweep: pieces of the problem's lines.
    fn frame(&mut self, tree: &mut OcclusionTree<PlaneOf<Self>>);

    /// The pieces of the problem's lines, each with the slot of the framed tree that holds it. Their
    /// facets have walls above all numbers of nodes; two pieces meet at a wall, or one ends there.
    fn roots(&mut self, tree: &OcclusionTree<PlaneOf<Self>>) -> Vec<(Slot, PieceOf<Self>)>;

    /// The hyperplane of an edge of an occluder that is in the tree: that from its polygon's corner
    /// of this number to the next.
    fn edge_plane(&self, occluder: Occluder, edge: usize) -> PlaneOf<Self>;

    /// The lines that an occluder blocks; `None` if they are no open set.
    fn occluder(&mut self, polygon: &PolygonRef<'_>) -> Option<(PieceOf<Self>, Occluder)>;

    /// The lines that meet a box.
    fn region(&mut self, bounds: &Aabb) -> Region<PieceOf<Self>>;

    /// The line through a point that is not the source.
    fn line_through(&mut self, point: Point) -> <Self::Space as LineSpace>::Ray;

    /// How far the space is filled, to [`View::rewind`] to.
    fn mark(&mut self) -> Mark;

    /// Forgets what was made since a mark and left no trace in the tree.
    fn rewind(&mut self, mark: Mark);

    /// From which side planes are seen.
    fn sides(&self) -> Self::Sides;

    /// Whether the part below an axis-parallel plane comes first.
    fn lower_first(&self, axis: usize, at: i32) -> bool;

    /// How far away a box is; comparable between boxes of one view.
    fn distance(&self, bounds: &Aabb) -> u128;

    /// How far away a box is at least, in the unit of [`View::range`].
    fn near(&self, bounds: &Aabb) -> u32;

    /// How far away a polygon is, in some unit that grows along the lines.
    fn range(&self, polygon: &PolygonRef<'_>) -> Range;

    /// How far away an occluder is at most on the lines of a piece, in the unit of [`View::range`]; the largest
    /// number if that is not known.
    fn far(space: &Self::Space, piece: &PieceOf<Self>, occluder: Occluder) -> u32;
}

/// Whether no corner of a box lies strictly on one side of a plane. Exact: it looks at the corner
/// that lies farthest to that side; 77 bits.
fn none_beyond(bounds: &Aabb, plane: &Plane, side: Sign) -> bool {
    let toward = i64::from(side.to_i8());
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    let corner: [i32; 3] = std::array::from_fn(|k| {
        if plane.normal[k] * toward > 0 {
            high[k]
        } else {
            low[k]
        }
    });
    plane.side(corner.into()) != side
}
