//! How far a segment is from where lines leave: bounds for the maximal visibility distance [Bittner02, 6.5.5].
//!
//! The distance from a convex set grows along every line that leaves it. So of two segments whose ranges do not
//! overlap, the one with the smaller range comes first on all lines that meet both. Doubles compute distances
//! of grid points: with coordinates below 2^24 every operation errs by less than 2^-52 of at most 2^51, and the
//! square root of what a few of them leave by far less than one step; bounds keep two steps of distance to that.

use crate::range::Range;
use antumbra_kernel::Point2;

/// The range of a segment from a window, which may be a point.
pub(super) fn range(window: [Point2; 2], segment: [Point2; 2]) -> Range {
    let window = window.map(|p| p.to_f64());
    let segment = segment.map(|p| p.to_f64());
    let ends = segment.map(|p| to_segment(p, window));
    let far = ends[0].max(ends[1]);
    let back = window.map(|p| to_segment(p, segment));
    // Segments that do not cross are closest at an end of one of them; of those that do the bound is of no use, but
    // right: they are not nearer than nothing.
    let crosses = sides(window, segment) && sides(segment, window);
    let near = if crosses {
        0.0
    } else {
        ends[0].min(ends[1]).min(back[0]).min(back[1])
    };
    Range {
        near: (near.sqrt() - 2.0).max(0.0) as u32,
        far: (far.sqrt() + 2.0) as u32,
    }
}

/// Whether the ends of one segment may lie on two sides of another.
fn sides([a, b]: [[f64; 2]; 2], segment: [[f64; 2]; 2]) -> bool {
    let side = |p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    // Exact: products of 25 bits.
    side(segment[0]) * side(segment[1]) <= 0.0
}

/// The squared distance of a point from a segment.
fn to_segment(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let v = [p[0] - a[0], p[1] - a[1]];
    let length = d[0] * d[0] + d[1] * d[1];
    let t = if length > 0.0 {
        ((v[0] * d[0] + v[1] * d[1]) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let r = [v[0] - t * d[0], v[1] - t * d[1]];
    r[0] * r[0] + r[1] * r[1]
}

#[cfg(test)]
mod tests {
    use super::range;
    use antumbra_kernel::Point2;

    #[test]
    fn ranges_hold_the_distances() {
        let p = Point2::new;
        let r = range([p(0, 0), p(100, 0)], [p(50, -300), p(500, -300)]);
        assert!(r.near <= 300 && r.near >= 295 && r.far >= 500 && r.far <= 505);
        let r = range([p(0, 0), p(100, 0)], [p(50, 50), p(50, -300)]);
        assert_eq!(r.near, 0);
        let r = range([p(0, 0), p(0, 0)], [p(-30, 40), p(30, 40)]);
        assert!(r.near <= 40 && r.far >= 50);
    }
}
