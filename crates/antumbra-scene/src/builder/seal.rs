//! No cracks made by snapping: the slit between an edge and the vertices that lay on it is closed.
//!
//! Where a long edge of one face met several short edges of its neighbors, snapping may have moved
//! the vertices between them off the long edge, by one grid step at most. Bending the long face to
//! follow them would cost its planarity, and a wall would fall to pieces. Instead the slit itself
//! becomes an occluder: for an edge `a b` with near vertices `v1 .. vn` in order, the triangles
//! `a v1 b`, `v1 v2 b`, ... span the closed path from `a` over the vertices to `b` and back. All
//! faces stay, so nothing opens; the path runs along the edges of the face on the one side and of
//! the faces on the other, so nothing is left open. Vertices exactly on the edge need nothing:
//! closed polygons that share a segment leave no gap.
//!
//! Order along the edge is by the sum of the coordinates, each taken in the direction of the edge.
//! Snapping keeps the order of each single coordinate, so collinear points come in the order they
//! had before snapping, on every edge that lay along them alike.

use antumbra_kernel::{Point, sub};

use super::clean::Patch;
use super::near::{PointTree, is_near};
use super::plane::{Frame, collinear};

/// What was closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sealed {
    /// How many times a vertex off an edge was inserted into it.
    pub(crate) vertices: usize,
    /// How many triangles that took.
    pub(crate) triangles: usize,
}

/// Appends the triangles that close the slits between the occluding patches of one object.
pub(crate) fn seal(points: &[Point], patches: &mut Vec<Patch>) -> Sealed {
    if points.len() <= FEW && !any_near(points, patches) {
        return Sealed::default();
    }
    let edges = occluding_edges(patches);
    if edges.is_empty() {
        return Sealed::default();
    }
    let tree = PointTree::new(occluding_vertices(points, patches));
    let mut sealed = Sealed::default();
    let mut near: Vec<(i64, u32)> = Vec::new();
    let mut triangles = Vec::new();
    for sharing in edges.chunk_by(|x, y| x[..2] == y[..2]) {
        let [a, b, _] = sharing[0];
        vertices_between(points, &tree, a, b, &mut near);
        let path: Vec<u32> = [a]
            .into_iter()
            .chain(near.iter().map(|n| n.1))
            .chain([b])
            .collect();
        for slit in slits(points, &path) {
            let faces = sharing.iter().map(|e| &patches[e[2] as usize]);
            if covered(points, slit, faces) {
                continue;
            }
            sealed.vertices += slit.len() - 2;
            span(points, slit, &mut triangles);
        }
    }
    sealed.triangles = triangles.len();
    patches.append(&mut triangles);
    sealed
}

/// Objects with so few vertices are looked through before a tree is built: most are single
/// rectangles, and need nothing.
const FEW: usize = 8;

/// Whether a vertex lies near an edge it is no end of.
fn any_near(points: &[Point], patches: &[Patch]) -> bool {
    patches.iter().any(|patch| {
        let next = patch.corners.iter().cycle().skip(1);
        patch.corners.iter().zip(next).any(|(&a, &b)| {
            let (start, end) = (points[a as usize], points[b as usize]);
            (0..points.len() as u32)
                .filter(|&i| i != a && i != b)
                .any(|i| is_near(start, end, points[i as usize]))
        })
    })
}

/// The edges of all occluding patches, smaller vertex first, each with its patch; sorted.
fn occluding_edges(patches: &[Patch]) -> Vec<[u32; 3]> {
    let mut edges = Vec::new();
    for (i, patch) in patches
        .iter()
        .enumerate()
        .filter(|(_, patch)| patch.occludes)
    {
        let next = patch.corners.iter().cycle().skip(1);
        edges.extend(
            patch
                .corners
                .iter()
                .zip(next)
                .map(|(&a, &b)| [a.min(b), a.max(b), i as u32]),
        );
    }
    edges.sort_unstable();
    edges
}

fn occluding_vertices(points: &[Point], patches: &[Patch]) -> Vec<(Point, u32)> {
    let mut used = vec![false; points.len()];
    for patch in patches.iter().filter(|patch| patch.occludes) {
        patch.corners.iter().for_each(|&c| used[c as usize] = true);
    }
    (0..points.len())
        .filter(|&i| used[i])
        .map(|i| (points[i], i as u32))
        .collect()
}

/// The vertices near the edge and strictly between its ends, in order along it.
fn vertices_between(
    points: &[Point],
    tree: &PointTree,
    a: u32,
    b: u32,
    near: &mut Vec<(i64, u32)>,
) {
    let (start, end) = (points[a as usize], points[b as usize]);
    let heading = sub(end, start).map(i64::signum);
    let along = |p: Point| {
        let d = sub(p, start);
        (0..3).map(|k| heading[k] * d[k]).sum::<i64>()
    };
    let length = along(end);
    near.clear();
    tree.for_each_near(start, end, |p, i| {
        let key = along(p);
        if 0 < key && key < length {
            near.push((key, i));
        }
    });
    near.sort_unstable();
}

/// The parts of a path between consecutive points on the segment from its first to its last
/// point, without those parts that follow the segment themselves.
fn slits<'a>(points: &[Point], path: &'a [u32]) -> impl Iterator<Item = &'a [u32]> {
    let (start, end) = (
        points[path[0] as usize],
        points[path[path.len() - 1] as usize],
    );
    let on: Vec<usize> = (0..path.len())
        .filter(|&i| collinear(start, end, points[path[i] as usize]))
        .collect();
    let parts: Vec<&[u32]> = on
        .windows(2)
        .filter(|w| w[1] - w[0] > 1)
        .map(|w| &path[w[0]..=w[1]])
        .collect();
    parts.into_iter()
}

/// Whether one of the faces on the edge already covers the slit.
fn covered<'a>(points: &[Point], slit: &[u32], mut faces: impl Iterator<Item = &'a Patch>) -> bool {
    faces.any(|face| {
        let frame = Frame::facing(face.plane.normal);
        slit[1..slit.len() - 1]
            .iter()
            .map(|&v| points[v as usize])
            .all(|p| {
                face.plane.side(p).is_zero()
                    && frame.holds(face.corners.iter().map(|&c| points[c as usize]), p)
            })
    })
}

/// Spans a closed path with a fan of triangles from its last point.
fn span(points: &[Point], path: &[u32], out: &mut Vec<Patch>) {
    let apex = path[path.len() - 1];
    for pair in path[..path.len() - 1].windows(2) {
        // A triangle without area covers a segment that the fan covers anyway.
        out.extend(Patch::new(points, vec![pair[0], pair[1], apex], true));
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;

    use super::{Sealed, seal};
    use crate::builder::clean::{Patch, clean};

    fn patches(points: &[Point], faces: &[&[u32]], occludes: bool) -> Vec<Patch> {
        let mut out = Vec::new();
        for face in faces {
            clean(points, face, occludes, &mut out);
        }
        out
    }

    fn points(list: &[[i32; 3]]) -> Vec<Point> {
        list.iter().map(|&p| Point::from(p)).collect()
    }

    /// A quad above the x-axis, and two below that meet it in a vertex near its middle.
    fn t_junction(middle: [i32; 3]) -> (Vec<Point>, Vec<Patch>) {
        let p = points(&[
            [0, 0, 0],
            [100, 0, 0],
            [100, 50, 0],
            [0, 50, 0],
            middle,
            [0, -50, 0],
            [50, -50, 0],
            [100, -50, 0],
        ]);
        let faces = patches(&p, &[&[0, 1, 2, 3], &[0, 4, 6, 5], &[4, 1, 7, 6]], true);
        (p, faces)
    }

    #[test]
    fn a_vertex_on_the_edge_needs_nothing() {
        let (p, mut faces) = t_junction([50, 0, 0]);
        assert_eq!(seal(&p, &mut faces), Sealed::default());
        assert_eq!(faces.len(), 3);
    }

    #[test]
    fn a_vertex_beside_the_edge_is_closed_by_one_triangle() {
        let (p, mut faces) = t_junction([50, 0, -1]);
        let before = faces.len();
        assert_eq!(
            seal(&p, &mut faces),
            Sealed {
                vertices: 1,
                triangles: 1
            }
        );
        let mut corners = faces[before].corners.clone();
        corners.sort_unstable();
        assert_eq!(corners, [0, 1, 4]);
    }

    #[test]
    fn what_the_face_covers_and_what_is_far_stays() {
        for middle in [[50, 1, 0], [50, -2, 0]] {
            let (p, mut faces) = t_junction(middle);
            assert_eq!(seal(&p, &mut faces), Sealed::default(), "{middle:?}");
        }
    }

    #[test]
    fn several_vertices_are_spanned_by_a_fan_between_those_on_the_edge() {
        let mut list = vec![[0, 0, 0], [90, 0, 0], [50, 40, 0]];
        list.extend([
            [10, 0, 1],
            [20, -1, 1],
            [30, 0, 0],
            [40, 0, 0],
            [60, 1, -1],
            [0, 0, -9],
        ]);
        let p = points(&list);
        let mut faces = patches(&p, &[&[0, 1, 2]], true);
        for pair in [[0, 3], [3, 4], [4, 5], [5, 6], [6, 7], [7, 1]] {
            faces.extend(patches(&p, &[&[pair[0], pair[1], 8]], true));
        }
        assert_eq!(
            seal(&p, &mut faces),
            Sealed {
                vertices: 3,
                triangles: 3
            }
        );
    }

    #[test]
    fn transparent_faces_are_left_alone() {
        let p = points(&[
            [0, 0, 0],
            [100, 0, 0],
            [50, 50, 0],
            [50, 0, 1],
            [50, -50, 0],
        ]);
        let mut faces = patches(&p, &[&[0, 1, 2]], true);
        faces.extend(patches(&p, &[&[0, 3, 4], &[3, 1, 4]], false));
        assert_eq!(seal(&p, &mut faces), Sealed::default());
    }
}
