//! Patches that other patches of the same object and plane cover together are dropped: frames and
//! panels are often modeled in layers that share their faces.
//!
//! Exact: what is left of a patch after subtracting another is a set of convex pieces, each kept
//! as the list of half-planes that bound it. A corner is the name of two of their borders, which go
//! through grid points, and never a rounded point; so its side of a third border is a 3x3
//! determinant of 25-, 25- and 50-bit columns, 103 bits in all.

use std::cmp::Ordering;

use antumbra_kernel::Point;

use super::plane::Frame;

/// Drops polygons covered by the others, smallest first; returns how many.
///
/// All polygons are strictly convex, in one plane, and turn counter-clockwise in the frame.
pub(crate) fn drop_covered(
    points: &[Point],
    frame: Frame,
    polygons: &mut Vec<(usize, Vec<u32>)>,
) -> usize {
    if polygons.len() < 2 {
        return 0;
    }
    let shapes: Vec<Shape> = polygons
        .iter()
        .map(|(_, corners)| Shape::new(points, frame, corners))
        .collect();
    let neighbors = overlaps(&shapes);
    let mut order: Vec<usize> = (0..shapes.len())
        .filter(|&i| !neighbors[i].is_empty())
        .collect();
    order.sort_by_key(|&i| (shapes[i].doubled_area, i));
    let mut alive = vec![true; shapes.len()];
    for i in order {
        let others: Vec<&Shape> = neighbors[i]
            .iter()
            .filter(|&&j| alive[j])
            .map(|&j| &shapes[j])
            .collect();
        if is_covered(&shapes[i], &others) {
            alive[i] = false;
        }
    }
    let before = polygons.len();
    let mut alive = alive.into_iter();
    polygons.retain(|_| alive.next().unwrap_or(true));
    before - polygons.len()
}

/// A half-plane `a x + b y + c >= 0`.
type HalfPlane = [i128; 3];

/// A convex polygon of the plane, counter-clockwise.
struct Shape {
    corners: Vec<[i64; 2]>,
    sides: Vec<HalfPlane>,
    min: [i64; 2],
    max: [i64; 2],
    doubled_area: i64,
}

impl Shape {
    fn new(points: &[Point], frame: Frame, corners: &[u32]) -> Self {
        let mut corners: Vec<[i64; 2]> = corners
            .iter()
            .map(|&c| frame.project(points[c as usize]))
            .collect();
        let mut doubled_area = 0;
        for w in corners[1..].windows(2) {
            doubled_area += turn(corners[0], w[0], w[1]);
        }
        // The frame looks along an axis, maybe against it: then the projection turns clockwise.
        if doubled_area < 0 {
            corners.reverse();
            doubled_area = -doubled_area;
        }
        let n = corners.len();
        let sides = (0..n)
            .map(|i| left_of(corners[i], corners[(i + 1) % n]))
            .collect();
        let min = std::array::from_fn(|k| corners.iter().map(|c| c[k]).min().unwrap_or(0));
        let max = std::array::from_fn(|k| corners.iter().map(|c| c[k]).max().unwrap_or(0));
        Self {
            corners,
            sides,
            min,
            max,
            doubled_area,
        }
    }

    fn holds(&self, p: [i64; 2]) -> bool {
        let n = self.corners.len();
        (0..n).all(|i| turn(self.corners[i], self.corners[(i + 1) % n], p) >= 0)
    }
}

fn turn(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// What lies on the left of the way from `a` to `b`.
fn left_of(a: [i64; 2], b: [i64; 2]) -> HalfPlane {
    let (x, y) = (a[1] - b[1], b[0] - a[0]);
    [x, y, -(x * a[0] + y * a[1])].map(i128::from)
}

/// No polygon is compared with more others than this. Keeping one that is covered costs time later,
/// never truth, and heaps of overlapping polygons would cost more now.
const MOST: usize = 64;

/// For each shape some others whose boxes overlap its own in more than a border.
fn overlaps(shapes: &[Shape]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..shapes.len()).collect();
    order.sort_by_key(|&i| (shapes[i].min[0], i));
    let mut found = vec![Vec::new(); shapes.len()];
    let mut active: Vec<usize> = Vec::new();
    for i in order {
        let here = &shapes[i];
        active.retain(|&j| shapes[j].max[0] > here.min[0]);
        for &j in &active {
            let other = &shapes[j];
            if other.min[1] < here.max[1] && here.min[1] < other.max[1] {
                for (one, other) in [(i, j), (j, i)] {
                    if found[one].len() < MOST {
                        found[one].push(other);
                    }
                }
            }
        }
        active.push(i);
    }
    found
}

fn is_covered(shape: &Shape, others: &[&Shape]) -> bool {
    // Cheap and usually final: a corner that no other polygon holds.
    shape
        .corners
        .iter()
        .all(|&p| others.iter().any(|other| other.holds(p)))
        && is_piece_covered(&shape.sides, others)
}

/// Whether the interior of a convex piece lies in the union of the others.
fn is_piece_covered(piece: &[HalfPlane], others: &[&Shape]) -> bool {
    let Some((first, rest)) = others.split_first() else {
        return false;
    };
    let Some(outside) = subtract(piece, &first.sides) else {
        return is_piece_covered(piece, rest);
    };
    outside.iter().all(|part| is_piece_covered(part, rest))
}

/// What is left of a piece outside a convex polygon, as convex pieces; `None` if they do not
/// overlap.
fn subtract(piece: &[HalfPlane], polygon: &[HalfPlane]) -> Option<Vec<Vec<HalfPlane>>> {
    let mut outside = Vec::new();
    let mut inside = piece.to_vec();
    for half in polygon {
        outside.extend(clip(&inside, &half.map(|c| -c)));
        inside = clip(&inside, half)?;
    }
    Some(outside)
}

/// The part of a convex piece in a half-plane, if it has an interior.
fn clip(piece: &[HalfPlane], half: &HalfPlane) -> Option<Vec<HalfPlane>> {
    let n = piece.len();
    // Corner i is where side i meets the next one.
    let sides: Vec<Ordering> = (0..n)
        .map(|i| side(&piece[i], &piece[(i + 1) % n], half))
        .collect();
    if sides.iter().all(|s| s.is_ge()) {
        return Some(piece.to_vec());
    }
    // The corners on the positive side are consecutive; so are the edges that have one.
    let first = (0..n).find(|&i| sides[i].is_gt() && sides[(i + n - 1) % n].is_le())?;
    let mut kept: Vec<HalfPlane> = vec![piece[first]];
    let mut i = first;
    while sides[i].is_gt() {
        i = (i + 1) % n;
        kept.push(piece[i]);
    }
    kept.push(*half);
    Some(kept)
}

/// Whether the corner of two sides lies in a half-plane (greater), on its border, or outside. They follow each other counter-clockwise, so the
/// third coordinate of their meeting point is positive.
fn side(p: &HalfPlane, q: &HalfPlane, half: &HalfPlane) -> Ordering {
    let x = p[1] * q[2] - p[2] * q[1];
    let y = p[2] * q[0] - p[0] * q[2];
    let w = p[0] * q[1] - p[1] * q[0];
    (half[0] * x + half[1] * y + half[2] * w).cmp(&0)
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{LIMIT, Point};

    use super::drop_covered;
    use crate::builder::plane::Frame;

    /// Indices of the polygons that stay.
    fn left(polygons: &[&[[i32; 2]]]) -> Vec<usize> {
        let mut points = Vec::new();
        let mut lists = Vec::new();
        for (i, polygon) in polygons.iter().enumerate() {
            let first = points.len() as u32;
            points.extend(polygon.iter().map(|&[x, y]| Point::new(x, y, 5)));
            lists.push((i, (first..points.len() as u32).collect()));
        }
        drop_covered(&points, Frame::facing([0, 0, 1]), &mut lists);
        lists.into_iter().map(|(i, _)| i).collect()
    }

    fn rectangle(x: [i32; 2], y: [i32; 2]) -> [[i32; 2]; 4] {
        [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
    }

    #[test]
    fn what_one_or_several_cover_goes() {
        let (a, b) = (rectangle([0, 10], [0, 10]), rectangle([2, 5], [3, 10]));
        assert_eq!(left(&[&a, &b]), [0]);
        assert_eq!(left(&[&b, &a]), [1]);
        assert_eq!(left(&[&a, &a, &a]).len(), 1);
        let halves = [rectangle([0, 6], [0, 10]), rectangle([5, 10], [0, 10])];
        let middle = rectangle([3, 8], [2, 7]);
        assert_eq!(left(&[&middle, &halves[0], &halves[1]]), [1, 2]);
    }

    #[test]
    fn what_sticks_out_or_shows_through_a_gap_stays() {
        let halves = [rectangle([0, 5], [0, 10]), rectangle([6, 10], [0, 10])];
        let middle = rectangle([3, 8], [2, 7]);
        assert_eq!(left(&[&middle, &halves[0], &halves[1]]).len(), 3);
        assert_eq!(
            left(&[&rectangle([0, 4], [0, 4]), &rectangle([1, 3], [1, 5])]).len(),
            2
        );
        assert_eq!(
            left(&[&rectangle([0, 4], [0, 4]), &rectangle([4, 8], [0, 4])]).len(),
            2
        );
    }

    #[test]
    fn crossing_edges_are_decided_exactly() {
        // Two long triangles whose edges cross near a corner of the small one, off any grid point.
        let m = LIMIT - 1;
        let up = [[-m, -m], [m, -m], [0, m]];
        let down = [[-m, m], [0, -m], [m, m]];
        let covered = [[-100, 0], [100, 0], [0, 100]];
        assert_eq!(left(&[&up, &down, &covered]), [0, 1]);
        // One step beyond the point where both edges meet, (m/2, 0) rounded up.
        let beyond = [[0, 0], [m / 2 + 1, 0], [0, 100]];
        assert_eq!(left(&[&up, &down, &beyond]).len(), 3);
    }
}
