//! What the double description needs of its numbers, so that it is written once for fixed widths
//! and once more never: big integers take over where a row is too wide.

use antumbra_kernel::Sign;
use dashu_int::IBig;

/// Rows (half-spaces of line space through the origin) and vertices (extreme rays) with exact
/// signs.
pub(super) trait Numbers: Sized {
    /// A half-space: the points where the scalar product is not negative.
    type Row: Clone + PartialEq;
    /// A point of line space up to positive factors.
    type Vertex: Clone;
    /// A value of the Plücker quadric or its bilinear form.
    type Form;

    /// The largest sum of [`Numbers::excess`] over the rows of one cone.
    const ROOM: u32;

    /// How many bits a row is wider than an edge row.
    fn excess(row: &Self::Row) -> u32;

    /// The sign of the scalar product, exact.
    fn sign(row: &Self::Row, vertex: &Self::Vertex) -> Sign;

    /// The coefficients modulo the prime of [`super::modular`].
    fn residues(row: &Self::Row) -> [u64; 6];

    /// A point on five hyperplanes; zero if they are dependent.
    fn meet(rows: [&Self::Row; 5]) -> Self::Vertex;

    /// The opposite point.
    fn opposite(vertex: &Self::Vertex) -> Self::Vertex;

    /// The opposite half-space.
    fn complement(row: &Self::Row) -> Self::Row;

    /// The quadric `d . m`.
    fn quadric(vertex: &Self::Vertex) -> Self::Form;

    /// The bilinear form `d . m' + m . d'`.
    fn bilinear(v: &Self::Vertex, w: &Self::Vertex) -> Self::Form;

    /// The sign of the bilinear form, faster than its value.
    fn bilinear_sign(v: &Self::Vertex, w: &Self::Vertex) -> Sign;

    /// The sign of a value.
    fn form_sign(form: &Self::Form) -> Sign;

    /// Whether `b^2 > 4 q r`.
    fn crosses(b: &Self::Form, q: &Self::Form, r: &Self::Form) -> bool;

    /// The coefficients as big integers.
    fn wide(row: &Self::Row) -> [IBig; 6];
}
