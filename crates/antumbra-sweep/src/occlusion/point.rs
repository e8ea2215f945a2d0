//! Lines from a point of the grid: directions, cones in R^3.
//!
//! A corner c seen from e is the direction c - e (25 bits); an edge has the row (u - e) x (v - e)
//! (51 bits); a plane n . p = n . c has the nearness row n (51 bits) with scale n . (c - e) (77
//! bits), both turned so that the scale is positive. So the row of two planes' common line has 127
//! bits, well within what [`Space3`] holds.

use antumbra_kernel::{Aabb, Plane, Point, Sign, sub};
use antumbra_lines::{
    Child, Cone3, Corner3, Half, LineSpace as _, Mark, Nearness, Occluder, OcclusionTree, Plane3,
    Ray3, Slot, Space3, Wall,
};
use antumbra_scene::PolygonRef;

use super::boxes::outline;
use super::view::{Range, Region, Sides, View};

/// All directions from a point of the grid, or those of a convex frustum.
#[derive(Clone, Debug)]
pub struct PointView {
    space: Space3,
    eye: Point,
    frame: Vec<[i64; 3]>,
    edges: EdgePlanes,
}

/// The side of planes on which a point lies.
#[derive(Clone, Copy, Debug)]
pub struct EyeSides(Point);

impl Sides for EyeSides {
    fn away(&self, plane: &Plane) -> Sign {
        plane.side(self.0).flip()
    }
}

impl PointView {
    /// All directions.
    #[must_use]
    pub fn sphere(eye: Point) -> Self {
        Self {
            space: Space3::new(),
            eye,
            frame: Vec::new(),
            edges: EdgePlanes::default(),
        }
    }

    /// The directions within a convex pyramid, given by the directions of its edges in order, `u x v`
    /// of neighbors pointing inward; components are smaller than 2^30. `None` if they do not bound
    /// a strictly convex, pointed cone.
    #[must_use]
    pub fn frustum(eye: Point, edges: &[[i64; 3]]) -> Option<Self> {
        let small = edges.iter().flatten().all(|c| c.abs() < 1 << 30);
        (edges.len() >= 3 && small && is_convex(edges)).then(|| Self {
            space: Space3::new(),
            eye,
            frame: edges.to_vec(),
            edges: EdgePlanes::default(),
        })
    }

    /// The viewpoint.
    #[must_use]
    pub fn eye(&self) -> Point {
        self.eye
    }

    /// The line space, to read.
    #[must_use]
    pub fn space_ref(&self) -> &Space3 {
        &self.space
    }
}

/// Whether rays turn one way and every ray lies inside every facet.
pub(super) fn is_convex(edges: &[[i64; 3]]) -> bool {
    let n = edges.len();
    (0..n).all(|i| {
        let (u, v) = (edges[i].map(i128::from), edges[(i + 1) % n].map(i128::from));
        let m = |a: usize, b: usize| u[a] * v[b] - u[b] * v[a];
        let row = [m(1, 2), m(2, 0), m(0, 1)];
        (0..n).filter(|&j| j != i && j != (i + 1) % n).all(|j| {
            (0..3)
                .map(|k| row[k] * i128::from(edges[j][k]))
                .sum::<i128>()
                > 0
        })
    })
}

impl View for PointView {
    type Space = Space3;
    type Sides = EyeSides;

    fn space(&mut self) -> &mut Space3 {
        &mut self.space
    }

    fn frame(&mut self, tree: &mut OcclusionTree<Plane3>) {
        frame(&mut self.space, &self.frame, tree);
    }

    fn occluder(&mut self, polygon: &PolygonRef<'_>) -> Option<(Cone3, Occluder)> {
        let away = -polygon.plane.evaluate(self.eye);
        if away == 0 {
            return None;
        }
        let sign: i64 = if away < 0 { -1 } else { 1 };
        let nearness = Nearness {
            row: polygon.plane.normal.map(|c| i128::from(c * sign)),
            scale: away.abs(),
        };
        let occluder = self.space.occluder(nearness, polygon.id.0);
        let eye = self.eye;
        let mut directions: Vec<[i64; 3]> = polygon.corners.iter().map(|&c| sub(c, eye)).collect();
        // Corners turn counter-clockwise about the normal: inward rows need it to point away.
        if sign < 0 {
            directions.reverse();
        }
        let cone = self.space.cone(&directions);
        self.edges.add(occluder, &cone, sign < 0);
        Some((cone, occluder))
    }

    fn roots(&mut self, tree: &OcclusionTree<Plane3>) -> Vec<(Slot, Cone3)> {
        roots(&mut self.space, &self.frame, tree)
    }

    fn edge_plane(&self, occluder: Occluder, edge: usize) -> Plane3 {
        self.edges.of(occluder, edge)
    }

    fn region(&mut self, bounds: &Aabb) -> Region<Cone3> {
        let (eye, low, high) = (
            self.eye.to_array(),
            bounds.min.to_array(),
            bounds.max.to_array(),
        );
        let position =
            std::array::from_fn(|k| i8::from(eye[k] > high[k]) - i8::from(eye[k] < low[k]));
        let (corners, n) = outline(bounds, position);
        if n == 0 {
            return Region::Touching;
        }
        let mut directions: Vec<[i64; 3]> = corners[..n]
            .iter()
            .map(|&c| sub(c.into(), self.eye))
            .collect();
        directions.dedup();
        match orient(&mut directions) {
            true => Region::Piece(self.space.cone(&directions)),
            // A flat box seen edge-on, and all polygons in it.
            false => Region::Nowhere,
        }
    }

    fn line_through(&mut self, point: Point) -> Ray3 {
        self.space.ray(sub(point, self.eye))
    }

    fn mark(&mut self) -> Mark {
        self.space.mark()
    }

    fn rewind(&mut self, mark: Mark) {
        self.space.rewind(mark);
    }

    fn sides(&self) -> EyeSides {
        EyeSides(self.eye)
    }

    fn lower_first(&self, axis: usize, at: i32) -> bool {
        self.eye.to_array()[axis] < at
    }

    fn near(&self, bounds: &Aabb) -> u32 {
        // At most 3 * 2^50.
        (self.distance(bounds) as u64).isqrt() as u32
    }

    /// In grid steps.
    fn range(&self, polygon: &PolygonRef<'_>) -> Range {
        let squares = polygon.corners.iter().map(|&c| {
            let d = sub(c, self.eye);
            (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) as u64
        });
        let far = squares.max().unwrap_or(0).isqrt() as u32 + 1;
        // Nothing of a plane is nearer than its foot; both roundings are far below 2^-40.
        let normal = polygon.plane.normal.map(|c| c as f64);
        let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        let foot = polygon.plane.evaluate(self.eye).abs() as f64 / length;
        let foot = (foot * (1.0 - f64::EPSILON * 8192.0)) as u32;
        let bounds = Aabb::around(polygon.corners.iter().copied());
        let near = bounds.map_or(0, |b| self.near(&b)).max(foot);
        Range { near, far }
    }

    fn far(space: &Space3, piece: &Cone3, occluder: Occluder) -> u32 {
        let corners = piece.corners.iter();
        let far = corners.map(|c| space.farthest(occluder, &c.ray));
        far.fold(0.0, f64::max).ceil() as u32
    }

    fn distance(&self, bounds: &Aabb) -> u128 {
        let (eye, low, high) = (self.eye.to_i64(), bounds.min.to_i64(), bounds.max.to_i64());
        (0..3)
            .map(|k| (low[k] - eye[k]).max(eye[k] - high[k]).max(0) as u128)
            .map(|d| d * d)
            .sum()
    }
}

/// The sphere in eight octants, or a pyramid with the rest outside.
pub(super) fn frame(space: &mut Space3, edges: &[[i64; 3]], tree: &mut OcclusionTree<Plane3>) {
    if edges.is_empty() {
        for row in [[1, 0, 0], [0, 1, 0], [0, 0, 1]] {
            tree.partition(space.plane(row));
        }
        return;
    }
    let cone = space.cone(edges);
    for corner in &cone.corners {
        tree.restrict(corner.plane, Half::Positive);
    }
    space.discard(cone);
}

/// Turns a weakly convex loop of directions so that `u x v` points inward; `false` if all lie in one
/// plane. Drops repeated directions at the seam.
pub(super) fn orient(directions: &mut Vec<[i64; 3]>) -> bool {
    if directions.len() > 1 && directions.first() == directions.last() {
        directions.pop();
    }
    if directions.len() < 3 {
        return false;
    }
    let (u, v) = (directions[0].map(i128::from), directions[1].map(i128::from));
    let m = |a: usize, b: usize| u[a] * v[b] - u[b] * v[a];
    let row = [m(1, 2), m(2, 0), m(0, 1)];
    let turn = directions[2..]
        .iter()
        .map(|d| (0..3).map(|k| row[k] * i128::from(d[k])).sum::<i128>())
        .find(|&s| s != 0);
    if turn.is_some_and(|t| t < 0) {
        directions.reverse();
    }
    turn.is_some()
}

/// Where the cones of a framed tree are: the eight octants, or the one pyramid.
pub(super) fn roots(
    space: &mut Space3,
    edges: &[[i64; 3]],
    tree: &OcclusionTree<Plane3>,
) -> Vec<(Slot, Cone3)> {
    if edges.is_empty() {
        return (0..8).map(|bits| octant(space, tree, bits)).collect();
    }
    let mut cone = space.cone(edges);
    let mut slot = Slot::Root;
    for (i, corner) in cone.corners.iter_mut().enumerate() {
        // The frame was made of these hyperplanes, in this order.
        if let Child::Node(node) = tree.child(slot) {
            corner.plane = tree.nodes()[node as usize].plane;
            slot = Slot::Side(node, Half::Positive);
        }
        corner.wall = Wall(FIRST_ROOT_WALL - i as u32);
    }
    vec![(slot, cone)]
}

/// Walls of roots count down from here.
const FIRST_ROOT_WALL: u32 = u32::MAX - 1;

/// The octant whose axis k is positive where bit k is set. Octants that share a quarter of a
/// coordinate plane have the same wall there.
fn octant(space: &mut Space3, tree: &OcclusionTree<Plane3>, bits: u32) -> (Slot, Cone3) {
    let positive = |k: usize| bits >> k & 1 == 1;
    let half = |k: usize| {
        if positive(k) {
            Half::Positive
        } else {
            Half::Negative
        }
    };
    let mut slot = Slot::Root;
    let mut planes = [None; 3];
    for (k, plane) in planes.iter_mut().enumerate() {
        if let Child::Node(node) = tree.child(slot) {
            *plane = Some(tree.nodes()[node as usize].plane);
            slot = Slot::Side(node, half(k));
        }
    }
    // The axes turn inward in this order if an even number of them is negative.
    let order = if bits.count_ones() % 2 == 1 {
        [0, 1, 2]
    } else {
        [0, 2, 1]
    };
    let corners = (0..3).filter_map(|i| {
        let (here, next) = (order[i], order[(i + 1) % 3]);
        let across = 3 - here - next;
        let mut axis = [0_i64; 3];
        axis[here] = if positive(here) { 1 } else { -1 };
        let quarter = bits & !(1 << across);
        Some(Corner3 {
            ray: space.ray(axis),
            plane: planes[across]?,
            side: half(across),
            wall: Wall(FIRST_ROOT_WALL - (across as u32 * 8 + quarter)),
        })
    });
    let corners = corners.collect();
    (slot, Cone3 { corners })
}

/// The hyperplanes of the edges of all occluders of a view.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgePlanes {
    planes: Vec<Plane3>,
    /// Where the planes of an occluder start, and whether its cone runs against its polygon.
    first: Vec<(u32, bool)>,
}

impl EdgePlanes {
    /// Adds those of a new occluder, dropping all of higher numbers.
    pub(super) fn add(&mut self, occluder: Occluder, cone: &Cone3, reversed: bool) {
        let index = occluder.0 as usize;
        if let Some(&(start, _)) = self.first.get(index) {
            self.planes.truncate(start as usize);
            self.first.truncate(index);
        }
        self.first.push((self.planes.len() as u32, reversed));
        self.planes.extend(cone.corners.iter().map(|c| c.plane));
    }

    /// The plane of the edge from a polygon's corner to the next.
    pub(super) fn of(&self, occluder: Occluder, edge: usize) -> Plane3 {
        let index = occluder.0 as usize;
        let (start, reversed) = self.first[index];
        let end = self
            .first
            .get(index + 1)
            .map_or(self.planes.len(), |&(s, _)| s as usize);
        let planes = &self.planes[start as usize..end];
        let n = planes.len();
        // Reversed, ray i belongs to corner n - 1 - i, so facet i is edge n - 2 - i.
        let i = if reversed {
            (2 * n - 2 - edge) % n
        } else {
            edge
        };
        planes[i]
    }
}
