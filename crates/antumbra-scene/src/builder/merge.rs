//! Coplanar neighbors of one object become convex patches: a wall is a few rectangles, not many
//! triangles.
//!
//! In each plane all patches turn the same way, so two that lie on opposite sides of a common edge
//! pass it in opposite directions; patches that overlap pass it in the same one and are never
//! mistaken for neighbors. The union of such a pair is convex if and only if it turns the right way
//! at both ends of the edge. Corners that become straight vanish, so that edges which were split
//! on one side only meet again as wholes. Every merge is exact: the union of the patches, as a set
//! of points, never changes.
//!
//! Greedy, by decreasing length of the common edge. A merge only ever widens the angles of a patch,
//! so a pair once refused stays refused, and new candidates arise only where a corner vanished.

use std::collections::BinaryHeap;

use antumbra_kernel::{Plane, Point, sub};
use rustc_hash::FxHashMap;

use super::clean::Patch;
use super::cover::drop_covered;
use super::plane::Frame;

/// Merges the patches of one object, and drops those that the others of their plane cover.
/// Returns the rest, ordered by the first patch each one contains, and how many were dropped.
pub(crate) fn merge(points: &[Point], mut patches: Vec<Patch>) -> (Vec<Patch>, usize) {
    if patches.len() < 2 {
        return (patches, 0);
    }
    let mut dropped = 0;
    let key = |(i, patch): (usize, &Patch)| {
        let Plane { normal, offset } = patch.plane;
        ((normal, offset, patch.occludes), i)
    };
    let mut order: Vec<_> = patches.iter().enumerate().map(key).collect();
    order.sort_unstable();
    let mut kept: Vec<(usize, Patch)> = Vec::with_capacity(patches.len());
    for group in order.chunk_by(|x, y| x.0 == y.0) {
        let mut corners = |i: usize| std::mem::take(&mut patches[i].corners);
        let polygons: Vec<Vec<u32>> = group.iter().map(|&(_, i)| corners(i)).collect();
        let Patch {
            plane, occludes, ..
        } = patches[group[0].1];
        let frame = Frame::facing(plane.normal);
        let mut merged = merge_plane(points, frame, polygons);
        dropped += drop_covered(points, frame, &mut merged);
        for (first, corners) in merged {
            kept.push((
                group[first].1,
                Patch {
                    corners,
                    plane,
                    occludes,
                },
            ));
        }
    }
    kept.sort_by_key(|(first, _)| *first);
    (kept.into_iter().map(|(_, patch)| patch).collect(), dropped)
}

/// Merges polygons of one plane; each comes back with the smallest index it contains.
fn merge_plane(points: &[Point], frame: Frame, polygons: Vec<Vec<u32>>) -> Vec<(usize, Vec<u32>)> {
    match polygons.as_slice() {
        [_] => return polygons.into_iter().enumerate().collect(),
        // Two triangles of a rectangle: so common that they are worth no map of edges.
        [left, right] => {
            return match merge_two(points, frame, left, right) {
                Some(union) => vec![(0, union)],
                None => polygons.into_iter().enumerate().collect(),
            };
        }
        _ => {}
    }
    let mut plan = Merger::new(points, frame, polygons);
    while let Some((_, a, b)) = plan.candidates.pop() {
        plan.merge_along(a, b);
    }
    plan.polygons
        .into_iter()
        .enumerate()
        .filter(|(_, corners)| !corners.is_empty())
        .collect()
}

/// The convex union of two polygons along their common edge, if they have one: convex polygons on
/// opposite sides of an edge share no other.
fn merge_two(points: &[Point], frame: Frame, left: &[u32], right: &[u32]) -> Option<Vec<u32>> {
    let passes = |polygon: &[u32], a: u32, b: u32| {
        (0..polygon.len()).any(|k| polygon[k] == a && polygon[(k + 1) % polygon.len()] == b)
    };
    (0..left.len())
        .map(|k| (left[k], left[(k + 1) % left.len()]))
        .find(|&(a, b)| passes(right, b, a))
        .and_then(|(a, b)| {
            // As along any other edge, from its smaller vertex.
            if a < b {
                Union::of(points, frame, left, right, a, b)
            } else {
                Union::of(points, frame, right, left, b, a)
            }
        })
        .map(|union| union.corners)
}

struct Merger<'a> {
    points: &'a [Point],
    frame: Frame,
    /// The corners of each polygon; empty once it went into another.
    polygons: Vec<Vec<u32>>,
    /// The polygon a merged one went into; itself if it is still there.
    into: Vec<u32>,
    /// Polygons that had a directed edge when it was entered: a list by edge.
    edges: FxHashMap<(u32, u32), Vec<u32>>,
    /// Edges to merge along: squared length, then direction (smaller vertex first).
    candidates: BinaryHeap<(i64, u32, u32)>,
}

impl<'a> Merger<'a> {
    fn new(points: &'a [Point], frame: Frame, polygons: Vec<Vec<u32>>) -> Self {
        let mut plan = Self {
            points,
            frame,
            into: (0..polygons.len() as u32).collect(),
            edges: FxHashMap::default(),
            candidates: BinaryHeap::new(),
            polygons: Vec::new(),
        };
        for (i, corners) in polygons.iter().enumerate() {
            for (k, &a) in corners.iter().enumerate() {
                plan.enter(a, corners[(k + 1) % corners.len()], i as u32);
            }
        }
        plan.polygons = polygons;
        plan
    }

    /// Notes an edge, and a chance to merge if the opposite edge is known.
    fn enter(&mut self, a: u32, b: u32, polygon: u32) {
        self.edges.entry((a, b)).or_default().push(polygon);
        if self.edges.contains_key(&(b, a)) {
            let d = sub(self.points[b as usize], self.points[a as usize]);
            let squared = d.iter().map(|c| c * c).sum();
            self.candidates.push((squared, a.min(b), a.max(b)));
        }
    }

    /// Merges all pairs it can along one edge.
    fn merge_along(&mut self, a: u32, b: u32) {
        for left in self.holders(a, b) {
            for right in self.holders(b, a) {
                let polygon = |i: u32| self.polygons[i as usize].as_slice();
                let union = Union::of(self.points, self.frame, polygon(left), polygon(right), a, b);
                if let Some(union) = union {
                    self.replace(left, right, union);
                    break;
                }
            }
        }
    }

    /// The polygons that still have a directed edge, smallest first.
    fn holders(&mut self, a: u32, b: u32) -> Vec<u32> {
        let Some(list) = self.edges.get_mut(&(a, b)) else {
            return Vec::new();
        };
        let mut holders = std::mem::take(list);
        for p in &mut holders {
            *p = current(&mut self.into, *p);
        }
        holders.sort_unstable();
        holders.dedup();
        holders.retain(|&p| {
            let corners = &self.polygons[p as usize];
            (0..corners.len()).any(|k| corners[k] == a && corners[(k + 1) % corners.len()] == b)
        });
        self.edges.insert((a, b), holders.clone());
        holders
    }

    fn replace(&mut self, left: u32, right: u32, union: Union) {
        let (keep, gone) = (left.min(right), left.max(right));
        self.into[gone as usize] = keep;
        self.polygons[gone as usize] = Vec::new();
        self.polygons[keep as usize] = union.corners;
        for (a, b) in union.fresh.into_iter().flatten() {
            self.enter(a, b, keep);
        }
    }
}

struct Union {
    corners: Vec<u32>,
    /// Where a corner vanished, one longer edge has come from two.
    fresh: [Option<(u32, u32)>; 2],
}

impl Union {
    /// The convex union of `left`, which passes from `a` to `b`, and `right`, which passes back.
    fn of(
        points: &[Point],
        frame: Frame,
        left: &[u32],
        right: &[u32],
        a: u32,
        b: u32,
    ) -> Option<Self> {
        let from_b = rotated(left, b);
        let from_a = rotated(right, a);
        // from_b ends in a, from_a ends in b.
        let (before_a, after_a) = (from_b[from_b.len() - 2], from_a[1]);
        let (before_b, after_b) = (from_a[from_a.len() - 2], from_b[1]);
        let turn = |a: u32, b: u32, c: u32| {
            let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
            frame.turn(a, b, c)
        };
        let turn_a = turn(before_a, a, after_a);
        let turn_b = turn(before_b, b, after_b);
        if turn_a < 0 || turn_b < 0 {
            return None;
        }
        let mut corners = Vec::with_capacity(from_a.len() + from_b.len() - 2);
        corners.extend_from_slice(&from_b[usize::from(turn_b == 0)..from_b.len() - 1]);
        corners.extend_from_slice(&from_a[usize::from(turn_a == 0)..from_a.len() - 1]);
        let fresh = [
            (turn_a == 0).then_some((before_a, after_a)),
            (turn_b == 0).then_some((before_b, after_b)),
        ];
        Some(Self { corners, fresh })
    }
}

/// The polygon that now contains a given one; shortens the way for the next time.
fn current(into: &mut [u32], mut polygon: u32) -> u32 {
    while into[polygon as usize] != polygon {
        let up = into[into[polygon as usize] as usize];
        into[polygon as usize] = up;
        polygon = up;
    }
    polygon
}

/// The corner list from a given corner on.
fn rotated(corners: &[u32], first: u32) -> Vec<u32> {
    let at = corners.iter().position(|&c| c == first).unwrap_or(0);
    [&corners[at..], &corners[..at]].concat()
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;

    use super::merge;
    use crate::builder::clean::{Patch, clean};

    fn merged(list: &[[i32; 3]], faces: &[&[u32]]) -> Vec<Patch> {
        let points: Vec<Point> = list.iter().map(|&p| Point::from(p)).collect();
        let mut patches = Vec::new();
        for face in faces {
            clean(&points, face, true, &mut patches);
        }
        merge(&points, patches).0
    }

    #[test]
    fn a_wall_of_two_triangles_is_a_rectangle_whatever_their_orientation() {
        let corners = [[0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3]];
        for faces in [[&[0, 1, 2][..], &[0, 2, 3]], [&[0, 1, 2], &[3, 2, 0]]] {
            let out = merged(&corners, &faces);
            assert_eq!(out.len(), 1);
            assert_eq!(out[0].corners.len(), 4);
        }
    }

    #[test]
    fn an_l_shape_becomes_two_pieces() {
        let corners = [
            [0, 0, 0],
            [2, 0, 0],
            [2, 1, 0],
            [1, 1, 0],
            [1, 2, 0],
            [0, 2, 0],
        ];
        let out = merged(&corners, &[&[3, 4, 5], &[3, 5, 0], &[3, 0, 1], &[3, 1, 2]]);
        assert_eq!(out.len(), 2);
    }

    #[test]
    fn an_edge_split_on_one_side_does_not_keep_rectangles_apart() {
        let corners = [
            [0, 0, 0],
            [4, 0, 0],
            [4, 2, 0],
            [0, 2, 0],
            [1, 2, 0],
            [3, 2, 0],
            [0, 5, 0],
            [1, 5, 0],
            [3, 5, 0],
            [4, 5, 0],
        ];
        let out = merged(
            &corners,
            &[&[0, 1, 2, 3], &[3, 4, 7, 6], &[4, 5, 8, 7], &[5, 2, 9, 8]],
        );
        assert_eq!(out.len(), 1);
        assert_eq!(out[0].corners.len(), 4);
    }

    #[test]
    fn overlapping_layers_are_no_neighbors() {
        // Two triangles on the same side of their common edge, and two layers of a square.
        let corners = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]];
        assert_eq!(merged(&corners, &[&[0, 1, 2], &[0, 1, 3]]).len(), 2);
        let layers = merged(&corners, &[&[0, 1, 2], &[0, 2, 3], &[0, 1, 3], &[1, 2, 3]]);
        assert_eq!(layers.len(), 1);
        assert_eq!(layers[0].corners.len(), 4);
    }

    #[test]
    fn a_fan_becomes_a_disc() {
        // Rational points of a circle of radius 65.
        let ring = [
            [65, 0],
            [63, 16],
            [60, 25],
            [56, 33],
            [52, 39],
            [39, 52],
            [33, 56],
            [25, 60],
            [16, 63],
            [0, 65],
            [-39, 52],
            [-65, 0],
            [-39, -52],
            [0, -65],
            [39, -52],
        ];
        let mut corners: Vec<[i32; 3]> = ring.iter().map(|&[x, y]| [x, y, 1]).collect();
        corners.push([0, 0, 1]);
        let n = ring.len() as u32;
        let faces: Vec<[u32; 3]> = (0..n).map(|i| [n, i, (i + 1) % n]).collect();
        let lists: Vec<&[u32]> = faces.iter().map(|f| &f[..]).collect();
        let out = merged(&corners, &lists);
        assert_eq!(out.len(), 1);
        assert_eq!(out[0].corners.len(), ring.len());
    }

    #[test]
    fn planes_and_flags_keep_patches_apart() {
        let corners = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 1]];
        assert_eq!(merged(&corners, &[&[0, 1, 2], &[0, 2, 3]]).len(), 2);
        let points: Vec<Point> = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]]
            .map(Point::from)
            .to_vec();
        let mut patches = Vec::new();
        clean(&points, &[0, 1, 2], true, &mut patches);
        clean(&points, &[0, 2, 3], false, &mut patches);
        assert_eq!(merge(&points, patches).0.len(), 2);
    }
}
