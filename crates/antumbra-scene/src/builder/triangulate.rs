//! Ear clipping for faces that are not planar or not convex after snapping.
//!
//! Decided by exact turns in the projection along the axis in which the face is seen largest.
//! Whatever the outline (self-touching, self-crossing), the triangles span exactly its corners:
//! each outline edge is an edge of one triangle, so no gap opens to a neighbor.

use antumbra_kernel::{Point, cross, sub};

use super::plane::{Frame, collinear};

/// Calls `emit` with the triangles of a polygon; those without area are left out.
pub(crate) fn triangulate(points: &[Point], corners: &[u32], mut emit: impl FnMut([u32; 3])) {
    let frame = Frame::facing(newell(points, corners));
    let mut rest = corners.to_vec();
    while rest.len() >= 3 {
        let i = find_ear(points, &rest, frame);
        let n = rest.len();
        let [a, b, c] = [rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]];
        if !collinear(points[a as usize], points[b as usize], points[c as usize]) {
            emit([a, b, c]);
        }
        rest.remove(i);
    }
}

/// The corner to clip next: a true ear, else a corner without a turn, else any convex corner,
/// else the first.
fn find_ear(points: &[Point], rest: &[u32], frame: Frame) -> usize {
    let n = rest.len();
    let at = |i: usize| points[rest[i % n] as usize];
    let turn = |i: usize| frame.turn(at(i + n - 1), at(i), at(i + 1));
    let is_ear = |i: usize| {
        let (a, b, c) = (at(i + n - 1), at(i), at(i + 1));
        turn(i) > 0
            && (2..n - 1).all(|k| {
                let p = at(i + k);
                let p2 = frame.project(p);
                // A corner met twice (a bridge to a hole) is no obstacle to its own ear.
                [a, b, c].iter().any(|&q| frame.project(q) == p2)
                    || !frame.holds([a, b, c].into_iter(), p)
            })
    };
    (0..n)
        .find(|&i| is_ear(i))
        .or_else(|| (0..n).find(|&i| turn(i) == 0))
        .or_else(|| (0..n).find(|&i| turn(i) > 0))
        .unwrap_or(0)
}

/// Newell's normal: twice the vector area of the outline, scaled down if needed to fit (only its
/// longest axis and sign are used).
fn newell(points: &[Point], corners: &[u32]) -> [i64; 3] {
    let Some(&first) = corners.first() else {
        return [0; 3];
    };
    let origin = points[first as usize];
    let mut sum = [0_i128; 3];
    for pair in corners.windows(2) {
        let (p, q) = (points[pair[0] as usize], points[pair[1] as usize]);
        let part = cross(sub(p, origin), sub(q, origin));
        for k in 0..3 {
            sum[k] += i128::from(part[k]);
        }
    }
    // 52 bits a term and fewer than 2^32 terms: 84 bits.
    let largest = sum.iter().map(|s| s.unsigned_abs()).max().unwrap_or(0);
    let excess = (128 - largest.leading_zeros()).saturating_sub(62);
    sum.map(|s| (s >> excess) as i64)
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;

    use super::triangulate;
    use crate::builder::plane::Frame;

    fn doubled_area(outline: &[[i32; 3]]) -> (usize, i64) {
        let points: Vec<Point> = outline.iter().map(|&p| Point::from(p)).collect();
        let corners: Vec<u32> = (0..points.len() as u32).collect();
        let frame = Frame::facing([0, 0, 1]);
        let (mut count, mut area) = (0, 0);
        triangulate(&points, &corners, |t| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            count += 1;
            area += frame.turn(a, b, c).abs();
        });
        (count, area)
    }

    #[test]
    fn concave_outlines_keep_their_area() {
        let comb = [
            [0, 0, 0],
            [6, 0, 0],
            [6, 3, 0],
            [5, 1, 0],
            [4, 3, 0],
            [3, 1, 0],
            [2, 3, 0],
            [1, 1, 0],
            [0, 3, 0],
        ];
        let (count, area) = doubled_area(&comb);
        assert_eq!(count, 7);
        // 6 x 3 less three notches of base 2 and depth 2.
        assert_eq!(area, 2 * 18 - 3 * 4);
        let mut turned = comb;
        turned.reverse();
        assert_eq!(doubled_area(&turned).1, area);
    }

    #[test]
    fn a_hole_on_a_bridge_stays_open() {
        let ring = [
            [0, 0, 0],
            [9, 0, 0],
            [9, 9, 0],
            [0, 9, 0],
            [0, 0, 0],
            [3, 3, 0],
            [3, 6, 0],
            [6, 6, 0],
            [6, 3, 0],
            [3, 3, 0],
        ];
        assert_eq!(doubled_area(&ring).1, 2 * (81 - 9));
    }

    #[test]
    fn crossing_outlines_end() {
        let (count, _) = doubled_area(&[[0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 4, 0], [2, -3, 0]]);
        assert!(count <= 3);
    }
}
