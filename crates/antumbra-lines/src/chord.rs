//! Segments of the plane as occluders, and which of two comes first along lines that meet both.
//!
//! Two segments that do not cross have one order for all lines that pass them in the same direction:
//! one of them lies on one side of the other's line. So the order is decided by [`orient2d`] of
//! ends, whatever the piece of line space; only segments that cross change places, at the hyperplane of
//! their crossing point. After [Bittner02, 6.5.1].

use antumbra_kernel::{Point2, crossing2d, orient2d};

use crate::line_space::Half;

/// A segment as the lines of a piece pass it: its ends on their left and on their right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentOccluder {
    /// The end on the left of the lines.
    pub left: Point2,
    /// The end on their right.
    pub right: Point2,
    /// Whose segment it is.
    pub key: u32,
}

/// The order of two segments along lines that pass both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentOrder {
    /// The new one is nowhere in front.
    Behind,
    /// The new one is nowhere behind.
    InFront,
    /// They cross in this homogeneous point; the new one is in front of the old one on the lines that
    /// have it on this side.
    Crossing([i128; 3], Half),
}

impl SegmentOccluder {
    /// The key of a segment that is looked at, not through: what lies along it does not hide it.
    pub const TARGET: u32 = u32::MAX;
    /// The key of the side of a box.
    pub const SIDE: u32 = u32::MAX - 1;

    /// How far a point lies behind the segment: negative in front, zero on its line. 51 bits.
    #[inline]
    #[must_use]
    pub fn depth(&self, p: Point2) -> i64 {
        orient2d(self.left, self.right, p)
    }

    /// The order of this segment and an old one; of two on one line the old one is in front. Exact,
    /// degree 2.
    #[must_use]
    pub fn order(&self, old: &Self) -> SegmentOrder {
        let (l, r) = (old.depth(self.left), old.depth(self.right));
        if l == 0 && r == 0 && self.key == Self::TARGET {
            return SegmentOrder::InFront;
        }
        if l >= 0 && r >= 0 {
            return SegmentOrder::Behind;
        }
        if l <= 0 && r <= 0 {
            return SegmentOrder::InFront;
        }
        let (ol, or) = (self.depth(old.left), self.depth(old.right));
        if ol <= 0 && or <= 0 {
            return SegmentOrder::Behind;
        }
        if ol >= 0 && or >= 0 {
            return SegmentOrder::InFront;
        }
        let point = crossing2d([self.left, self.right], [old.left, old.right]);
        // A line that has the crossing on its left passes right of it, where the right ends are.
        let front = if r < 0 {
            Half::Positive
        } else {
            Half::Negative
        };
        SegmentOrder::Crossing(point, front)
    }
}

#[cfg(test)]
mod tests {
    use super::{SegmentOccluder, SegmentOrder};
    use crate::line_space::Half;
    use antumbra_kernel::Point2;

    /// Lines run downwards: their left is to the right of the page.
    fn segment(left: (i32, i32), right: (i32, i32)) -> SegmentOccluder {
        SegmentOccluder {
            left: Point2::new(left.0, left.1),
            right: Point2::new(right.0, right.1),
            key: 0,
        }
    }

    #[test]
    fn nearer_segments_are_in_front() {
        let near = segment((4, -1), (-4, -1));
        let far = segment((9, -5), (-1, -4));
        assert_eq!(far.order(&near), SegmentOrder::Behind);
        assert_eq!(near.order(&far), SegmentOrder::InFront);
        let on = segment((2, -1), (-9, -1));
        assert_eq!(on.order(&near), SegmentOrder::Behind);
    }

    #[test]
    fn segments_that_cross_change_places_at_their_crossing() {
        let falling = segment((4, -6), (-4, -2));
        let rising = segment((4, -2), (-4, -6));
        let SegmentOrder::Crossing(k, front) = falling.order(&rising) else {
            panic!("they cross");
        };
        assert_eq!(k.map(|c| c / k[2]), [0, -4, 1]);
        // On the right of the page it is behind, on the left, where the crossing is on the lines' left, in front.
        assert_eq!(front, Half::Positive);
        let SegmentOrder::Crossing(_, front) = rising.order(&falling) else {
            panic!("they cross");
        };
        assert_eq!(front, Half::Negative);
    }

    #[test]
    fn a_segment_that_ends_on_another_does_not_cross_it() {
        let wall = segment((4, -4), (-4, -4));
        let stem = segment((2, -4), (0, -1));
        assert_eq!(stem.order(&wall), SegmentOrder::InFront);
        assert_eq!(wall.order(&stem), SegmentOrder::Behind);
    }
}
