//! The outline of a box as seen from a point outside.

use antumbra_kernel::Aabb;

/// The corners (see [`Aabb::corners`]) of the outline in order; empty if the point lies in the closed box.
/// The orientation is not fixed. On each axis the point is below (-1), within (0) or above (1).
pub(super) fn outline(bounds: &Aabb, position: [i8; 3]) -> ([[i32; 3]; 6], usize) {
    let near = (0..3).fold(0_usize, |n, k| n | usize::from(position[k] > 0) << k);
    let off: [bool; 3] = position.map(|p| p != 0);
    let bits = |axes: [usize; 3]| axes.map(|k| 1_usize << k);
    let (loop_, n): ([usize; 6], usize) = match off {
        [false, false, false] => ([0; 6], 0),
        [true, true, true] => {
            let [a, b, c] = bits([0, 1, 2]);
            ([a, a | b, b, b | c, c, c | a], 6)
        }
        [true, false, false] => face(bits([0, 1, 2])),
        [false, true, false] => face(bits([1, 2, 0])),
        [false, false, true] => face(bits([2, 0, 1])),
        [true, true, false] => corner(bits([0, 1, 2])),
        [true, false, true] => corner(bits([0, 2, 1])),
        [false, true, true] => corner(bits([1, 2, 0])),
    };
    let ends = [bounds.min.to_array(), bounds.max.to_array()];
    let at = |flips: usize| std::array::from_fn(|k| ends[(near ^ flips) >> k & 1][k]);
    (loop_.map(at), n)
}

/// One face is seen: its rectangle.
fn face([_, b, c]: [usize; 3]) -> ([usize; 6], usize) {
    ([0, b, b | c, c, 0, 0], 4)
}

/// Two faces are seen, which share an edge along the third axis.
fn corner([a, b, c]: [usize; 3]) -> ([usize; 6], usize) {
    ([b, 0, a, a | c, c, b | c], 6)
}
