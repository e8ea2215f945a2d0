//! From faces as given to strictly convex, exactly planar patches on the grid.
//!
//! Degenerate faces are dropped: a face without area hides nothing. Faces that
//! snapping has bent, and faces that never were convex, are cut into triangles over the same
//! corners, so that their outline, and with it every contact with a neighbor, stays what it was.

use antumbra_kernel::{Plane, Point, sub};

use super::plane::{Frame, canonical_plane, collinear};
use super::triangulate::triangulate;

/// A strictly convex polygon over the vertices of one object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Patch {
    /// Numbers of the corners, counter-clockwise about the normal of `plane`.
    pub(crate) corners: Vec<u32>,
    /// Its canonical plane.
    pub(crate) plane: Plane,
    /// Whether it is an occluder.
    pub(crate) occludes: bool,
}

impl Patch {
    /// A patch from strictly convex corners in either order.
    pub(crate) fn new(points: &[Point], mut corners: Vec<u32>, occludes: bool) -> Option<Self> {
        let at = |i: usize| points[corners[i] as usize];
        let plane = canonical_plane(at(0), at(1), at(2))?;
        if Frame::facing(plane.normal).turn(at(0), at(1), at(2)) < 0 {
            corners.reverse();
        }
        Some(Self {
            corners,
            plane,
            occludes,
        })
    }
}

/// What became of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cleaned {
    /// One patch.
    Kept,
    /// No area: nothing was added.
    Degenerate,
    /// Several triangles were added.
    Triangulated,
}

/// Appends the patches of a face.
pub(crate) fn clean(
    points: &[Point],
    face: &[u32],
    occludes: bool,
    out: &mut Vec<Patch>,
) -> Cleaned {
    if let [a, b, c] = *face {
        let Some(patch) = Patch::new(points, vec![a, b, c], occludes) else {
            return Cleaned::Degenerate;
        };
        out.push(patch);
        return Cleaned::Kept;
    }
    let mut corners = face.to_vec();
    drop_repeats(&mut corners);
    match shape(points, &corners) {
        Shape::Degenerate => Cleaned::Degenerate,
        Shape::Convex(strict) => {
            out.extend(Patch::new(points, strict, occludes));
            Cleaned::Kept
        }
        Shape::Other => {
            let before = out.len();
            triangulate(points, &corners, |triangle| {
                out.extend(Patch::new(points, triangle.to_vec(), occludes));
            });
            if out.len() == before {
                Cleaned::Degenerate
            } else {
                Cleaned::Triangulated
            }
        }
    }
}

enum Shape {
    Degenerate,
    /// Planar and convex: the corners that are no mere points of an edge.
    Convex(Vec<u32>),
    Other,
}

fn shape(points: &[Point], corners: &[u32]) -> Shape {
    let n = corners.len();
    let at = |i: usize| points[corners[i % n] as usize];
    // A base of the plane: the first corner, the next (distinct) one, any third off their line.
    let Some(third) = (2..n).find(|&i| !collinear(at(0), at(1), at(i))) else {
        return Shape::Degenerate;
    };
    let Some(plane) = canonical_plane(at(0), at(1), at(third)) else {
        return Shape::Degenerate;
    };
    if (0..n).any(|i| !plane.side(at(i)).is_zero()) {
        return Shape::Other;
    }
    let frame = Frame::facing(plane.normal);
    let mut strict = Vec::with_capacity(n);
    let mut side = 0;
    for (i, &corner) in corners.iter().enumerate() {
        let (before, here, after) = (at(i + n - 1), at(i), at(i + 1));
        match frame.turn(before, here, after).signum() {
            0 if !runs_on(before, here, after) => return Shape::Other,
            0 => {}
            s if side == 0 || side == s => {
                side = s;
                strict.push(corner);
            }
            _ => return Shape::Other,
        }
    }
    // All turns are to one side; a polygon that turns once around has two changes of heading.
    if headings(points, &strict, frame) == 2 {
        Shape::Convex(strict)
    } else {
        Shape::Other
    }
}

/// Of three collinear points, whether the path goes on in the same direction.
fn runs_on(a: Point, b: Point, c: Point) -> bool {
    let (p, q) = (sub(b, a), sub(c, b));
    (0..3).map(|k| p[k] * q[k]).sum::<i64>() > 0
}

/// How often the edges change between ascending and descending (lexicographically).
fn headings(points: &[Point], corners: &[u32], frame: Frame) -> usize {
    let n = corners.len();
    let ascends = |i: usize| {
        let (a, b) = (
            points[corners[i % n] as usize],
            points[corners[(i + 1) % n] as usize],
        );
        frame.project(a) < frame.project(b)
    };
    (0..n).filter(|&i| ascends(i) != ascends(i + 1)).count()
}

/// Drops corners that repeat the one before them, around the corner list.
fn drop_repeats(corners: &mut Vec<u32>) {
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;

    use super::{Cleaned, Patch, clean};

    fn run(points: &[[i32; 3]], face: &[u32]) -> (Cleaned, Vec<Patch>) {
        let points: Vec<Point> = points.iter().map(|&p| Point::from(p)).collect();
        let mut out = Vec::new();
        (clean(&points, face, true, &mut out), out)
    }

    #[test]
    fn collinear_corners_vanish_and_convex_faces_stay() {
        let points = [[0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]];
        let (what, patches) = run(&points, &[0, 1, 2, 2, 3, 4, 0]);
        assert_eq!(what, Cleaned::Kept);
        assert_eq!(patches.len(), 1);
        assert_eq!(patches[0].corners.len(), 4);
    }

    #[test]
    fn faces_without_area_are_dropped() {
        let points = [[0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 4, 0]];
        for face in [
            &[0, 1, 2][..],
            &[0, 1, 2, 1],
            &[0, 0, 1, 1],
            &[3],
            &[],
            &[0, 3, 0, 3],
        ] {
            assert_eq!(
                run(&points, face),
                (Cleaned::Degenerate, vec![]),
                "{face:?}"
            );
        }
    }

    #[test]
    fn bent_and_concave_faces_become_triangles() {
        let bent = [[0, 0, 0], [4, 0, 0], [4, 4, 1], [0, 4, 0]];
        let (what, patches) = run(&bent, &[0, 1, 2, 3]);
        assert_eq!((what, patches.len()), (Cleaned::Triangulated, 2));
        let concave = [[0, 0, 0], [4, 0, 0], [1, 1, 0], [0, 4, 0]];
        let (what, patches) = run(&concave, &[0, 1, 2, 3]);
        assert_eq!((what, patches.len()), (Cleaned::Triangulated, 2));
        // Turns to one side only, but twice around.
        let star = [
            [0, 30, 0],
            [18, -24, 0],
            [-29, 9, 0],
            [29, 9, 0],
            [-18, -24, 0],
        ];
        assert_eq!(run(&star, &[0, 1, 2, 3, 4]).0, Cleaned::Triangulated);
    }
}
