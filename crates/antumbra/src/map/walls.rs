//! Matching both sides of each wall: where cells meet, their borders are cut at each other's corners.
//!
//! The cells on one side of a wall cover it without overlap, and so do those on the other side. A
//! merge of the two sequences gives the elementary edges and says which corners are one vertex. Each
//! decision is the side of a ray on a hyperplane, as everywhere.

use std::cmp::Ordering;

use antumbra_kernel::Sign;
use antumbra_lines::{Half, Leaf, LineSpace as _, Ray3, Space3, Wall};

use super::cells::Cells;

/// What lies beyond a frame.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// A piece of a wall between two cells and two corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) from: u32,
    pub(super) to: u32,
    /// The cell whose border runs from `from` to `to`, and the one on the other side.
    pub(super) cells: [u32; 2],
    pub(super) wall: Wall,
    /// Whether the polygon of the first cell is nearer than that of the second, at both corners; zero where one of
    /// the cells has none.
    pub(super) nearer: [Sign; 2],
    /// A corner whose facet lies on the wall, positive side first, for its hyperplane.
    facet: u32,
}

/// The elementary edges of all walls, and the vertices.
pub(super) struct Walls {
    pub(super) segments: Vec<Segment>,
    /// For each corner the vertex it is.
    pub(super) vertex: Vec<u32>,
    /// A corner for each vertex.
    pub(super) rays: Vec<u32>,
    /// For each corner the segments of its facet: first, and how many.
    pub(super) along: Vec<(u32, u32)>,
}

impl Walls {
    pub(super) fn of(cells: &Cells, space: &Space3) -> Self {
        let mut matcher = Matcher {
            cells,
            space,
            parent: (0..cells.corners.len() as u32).collect(),
            segments: Vec::with_capacity(cells.corners.len()),
            along: vec![(0, 0); cells.corners.len()],
        };
        let mut order = cells.by_wall();
        let wall = |c: u32| cells.corners[c as usize].wall;
        let is_negative = |c: &u32| cells.corners[*c as usize].side == Half::Negative;
        for facets in order.chunk_by_mut(|&a, &b| wall(a) == wall(b)) {
            let wall = wall(facets[0]);
            let middle = facets.partition_point(is_negative);
            let (negative, positive) = facets.split_at_mut(middle);
            // Borders run with the wall on the positive side and against it on the negative one.
            matcher.sort(positive, true);
            matcher.sort(negative, false);
            matcher.merge(wall, positive, negative);
        }
        matcher.finish()
    }
}

impl Walls {
    /// Cuts every segment along which the two polygons beside it change places in depth. That takes
    /// two edges in one hyperplane that cross there, one polygon on each side: rare, but no vertex
    /// says so.
    pub(super) fn split_crossings(&mut self, cells: &mut Cells, space: &mut Space3) {
        let segments = self.segments.iter_mut().enumerate();
        let crossings: Vec<(usize, Ray3)> = segments
            .filter_map(|(i, segment)| Some((i, crossing(segment, cells, space)?)))
            .collect();
        if crossings.is_empty() {
            return;
        }
        let mut segments = Vec::with_capacity(self.segments.len() + crossings.len());
        let mut first = Vec::with_capacity(self.segments.len() + 1);
        let mut next = crossings.into_iter().peekable();
        for (i, segment) in self.segments.iter().enumerate() {
            first.push(segments.len() as u32);
            segments.push(*segment);
            if let Some((_, ray)) = next.next_if(|(at, _)| *at == i) {
                let middle = cells.add_ray(ray);
                self.vertex.push(self.rays.len() as u32);
                self.rays.push(middle);
                let [from, to] = segment.nearer;
                let before = &mut segments[first[i] as usize];
                (before.to, before.nearer) = (middle, [from, Sign::Zero]);
                segments.push(Segment {
                    from: middle,
                    nearer: [Sign::Zero, to],
                    ..*segment
                });
            }
        }
        first.push(segments.len() as u32);
        for (start, count) in &mut self.along {
            let end = first[(*start + *count) as usize];
            *start = first[*start as usize];
            *count = end - *start;
        }
        self.segments = segments;
    }
}

/// Finds which of a segment's two polygons is nearer at its ends, and where they change places strictly between.
fn crossing(segment: &mut Segment, cells: &Cells, space: &mut Space3) -> Option<Ray3> {
    if segment.cells[1] == OUTSIDE {
        return None;
    }
    let [a, b] = segment.cells.map(|c| cells.leaves[c as usize]);
    let (Leaf::Blocked(a), Leaf::Blocked(b)) = (a, b) else {
        return None;
    };
    if a == b {
        return None;
    }
    let [from, to] = [segment.from, segment.to].map(|c| space.nearer(a, b, cells.ray(c)));
    segment.nearer = [from, to];
    if !from.times(to).is_negative() {
        return None;
    }
    let common = space.common_plane(a, b);
    let wall = cells.corners[segment.facet as usize].plane;
    // The segment runs with the positive side of its wall: n x h leads from + to -.
    Some(if from.is_positive() {
        space.meet(wall, common)
    } else {
        space.meet(common, wall)
    })
}

struct Matcher<'a> {
    cells: &'a Cells,
    space: &'a Space3,
    parent: Vec<u32>,
    segments: Vec<Segment>,
    along: Vec<(u32, u32)>,
}

impl Matcher<'_> {
    /// The two corners of a facet, in the direction of the wall.
    fn ends(&self, corner: u32, with: bool) -> [u32; 2] {
        let next = self.cells.next(corner);
        if with { [corner, next] } else { [next, corner] }
    }

    /// Where `p` lies on a wall with respect to `q`, if `beyond` is another point of the wall after
    /// `q` (or before it, if `after` is false).
    fn compare(&self, p: &Ray3, q: &Ray3, beyond: &Ray3, after: bool) -> Option<Ordering> {
        let (plane, side) = q
            .planes()?
            .into_iter()
            .map(|plane| (plane, self.space.sign(plane, beyond)))
            .find(|(_, side)| !side.is_zero())?;
        let here = self.space.sign(plane, p);
        Some(if here.is_zero() {
            Ordering::Equal
        } else if (here == side) == after {
            Ordering::Greater
        } else {
            Ordering::Less
        })
    }

    fn sort(&self, facets: &mut [u32], with: bool) {
        if facets.len() < 2 {
            return;
        }
        facets.sort_by(|&a, &b| {
            if a == b {
                return Ordering::Equal;
            }
            let ([p, _], [q, end]) = (self.ends(a, with), self.ends(b, with));
            let ray = |c: u32| self.cells.ray(c);
            // Without names q is the given end where the wall starts.
            self.compare(ray(p), ray(q), ray(end), true)
                .unwrap_or(Ordering::Greater)
        });
    }

    fn merge(&mut self, wall: Wall, positive: &[u32], negative: &[u32]) {
        let (Some(&first), Some(&other)) = (positive.first(), negative.first()) else {
            let with = !positive.is_empty();
            let facets = if with { positive } else { negative };
            facets.iter().for_each(|&f| self.border(wall, f));
            self.join_along(facets, with);
            return;
        };
        let (mut i, mut j) = (0, 0);
        let mut from = self.ends(first, true)[0];
        self.join(from, self.ends(other, false)[0]);
        // Segments of a facet must be consecutive on both sides: they are, in one merge.
        loop {
            let ([_, p], [q0, q]) = (self.ends(positive[i], true), self.ends(negative[j], false));
            let last = (i + 1 == positive.len(), j + 1 == negative.len());
            let ray = |c: u32| self.cells.ray(c);
            let order = match last {
                (true, true) => Ordering::Equal,
                (true, false) => Ordering::Greater,
                (false, true) => Ordering::Less,
                (false, false) => self
                    .compare(ray(p), ray(q), ray(q0), false)
                    .unwrap_or(Ordering::Equal),
            };
            let to = if order == Ordering::Greater { q } else { p };
            self.segment(wall, [from, to], [positive[i], negative[j]]);
            from = to;
            if order != Ordering::Greater {
                i += 1;
                if let Some(&next) = positive.get(i) {
                    self.join(p, self.ends(next, true)[0]);
                }
            }
            if order != Ordering::Less {
                j += 1;
                if let Some(&next) = negative.get(j) {
                    self.join(q, self.ends(next, false)[0]);
                }
            }
            if order == Ordering::Equal {
                self.join(p, q);
            }
            if last == (true, true) {
                return;
            }
        }
    }

    fn join_along(&mut self, facets: &[u32], with: bool) {
        for pair in facets.windows(2) {
            let (a, b) = (self.ends(pair[0], with)[1], self.ends(pair[1], with)[0]);
            self.join(a, b);
        }
    }

    fn segment(&mut self, wall: Wall, [from, to]: [u32; 2], facets: [u32; 2]) {
        let index = self.segments.len() as u32;
        for facet in facets {
            let (first, count) = &mut self.along[facet as usize];
            if *count == 0 {
                *first = index;
            }
            *count += 1;
        }
        self.segments.push(Segment {
            from,
            to,
            cells: facets.map(|f| self.cells.owner[f as usize]),
            wall,
            nearer: [Sign::Zero; 2],
            facet: facets[0],
        });
    }

    /// A facet on the frame of the view.
    fn border(&mut self, wall: Wall, facet: u32) {
        self.along[facet as usize] = (self.segments.len() as u32, 1);
        self.segments.push(Segment {
            from: facet,
            to: self.cells.next(facet),
            cells: [self.cells.owner[facet as usize], OUTSIDE],
            wall,
            nearer: [Sign::Zero; 2],
            facet,
        });
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parent[corner as usize] != corner {
            let up = self.parent[self.parent[corner as usize] as usize];
            self.parent[corner as usize] = up;
            corner = up;
        }
        corner
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn finish(mut self) -> Walls {
        let n = self.parent.len() as u32;
        let mut vertex = vec![u32::MAX; n as usize];
        let mut rays = Vec::new();
        for corner in 0..n {
            let root = self.root(corner) as usize;
            if vertex[root] == u32::MAX {
                vertex[root] = rays.len() as u32;
                rays.push(root as u32);
            }
            vertex[corner as usize] = vertex[root];
        }
        Walls {
            segments: self.segments,
            vertex,
            rays,
            along: self.along,
        }
    }
}
