//! Parallel lines: an orthographic view, as cones in R^3.
//!
//! Along a direction d of integers below 2^10 whose largest component is on axis a, a point p is on the
//! line with coordinates x = p_b d_a - p_a d_b and y = p_c d_a - p_a d_c (36 bits), and the line is the
//! ray (x, y, 1). A plane n . p = k is met where p_a (n . d) = k d_a - n_b x - n_c y, so that its
//! nearness has a row of 86 bits and a scale of 63; the row of two planes' common line has 149 bits.

use antumbra_kernel::{Aabb, Plane, Point, Sign};
use antumbra_lines::{Cone3, Mark, Nearness, Occluder, OcclusionTree, Plane3, Ray3, Slot, Space3};
use antumbra_scene::PolygonRef;

use super::boxes::outline;
use super::point::{EdgePlanes, frame, orient, roots};
use super::view::{Range, Region, Sides, View};

/// All lines of one direction within a rectangle.
#[derive(Clone, Debug)]
pub struct ParallelView {
    space: Space3,
    direction: [i32; 3],
    axes: [usize; 3],
    frame: Vec<[i64; 3]>,
    edges: EdgePlanes,
}

/// The side of planes that a direction comes from.
#[derive(Clone, Copy, Debug)]
pub struct ParallelSides([i32; 3]);

impl Sides for ParallelSides {
    fn away(&self, plane: &Plane) -> Sign {
        Sign::of(product(plane, self.0))
    }
}

/// Ranges count products with the direction in units of 2^9, so that they fit.
const UNIT: u32 = 9;

/// A product of a point and a direction, which is below 2^36 in magnitude, moved to be positive.
fn positive(product: i64) -> u128 {
    (product + (1 << 40)) as u128
}

fn product(plane: &Plane, d: [i32; 3]) -> i128 {
    (0..3)
        .map(|k| i128::from(plane.normal[k]) * i128::from(d[k]))
        .sum()
}

impl ParallelView {
    /// Components of a direction are smaller than this.
    pub const LIMIT: i32 = 1 << 10;

    /// The lines along a direction that meet the rectangle around the image of a box. `None` if the
    /// direction is zero or a component too large.
    #[must_use]
    pub fn new(direction: [i32; 3], around: &Aabb) -> Option<Self> {
        let a = (0..3).max_by_key(|&k| (direction[k].abs(), 2 - k))?;
        if direction[a] == 0 || direction[a].abs() >= Self::LIMIT {
            return None;
        }
        let mut view = Self {
            space: Space3::new(),
            direction,
            axes: [a, (a + 1) % 3, (a + 2) % 3],
            frame: Vec::new(),
            edges: EdgePlanes::default(),
        };
        let images = around.corners().map(|p| view.image(p));
        let low = |k: usize| images.iter().map(|p| p[k]).min().unwrap_or(0) - 1;
        let high = |k: usize| images.iter().map(|p| p[k]).max().unwrap_or(0) + 1;
        let (l, h) = ([low(0), low(1)], [high(0), high(1)]);
        view.frame = vec![
            [l[0], l[1], 1],
            [h[0], l[1], 1],
            [h[0], h[1], 1],
            [l[0], h[1], 1],
        ];
        Some(view)
    }

    /// The line through a point, as a ray with third component 1.
    #[must_use]
    pub fn image(&self, p: Point) -> [i64; 3] {
        let (p, d) = (p.to_i64(), self.direction.map(i64::from));
        let [a, b, c] = self.axes;
        [p[b] * d[a] - p[a] * d[b], p[c] * d[a] - p[a] * d[c], 1]
    }

    /// The point of a line, given by a ray in doubles, at a coordinate on the view's main axis.
    #[must_use]
    pub fn point_at(&self, ray: [f64; 3], main: f64) -> [f64; 3] {
        let [a, b, c] = self.axes;
        let d = self.direction.map(f64::from);
        let mut p = [0.0; 3];
        p[a] = main;
        p[b] = (ray[0] / ray[2] + main * d[b]) / d[a];
        p[c] = (ray[1] / ray[2] + main * d[c]) / d[a];
        p
    }

    /// The direction.
    #[must_use]
    pub fn direction(&self) -> [i32; 3] {
        self.direction
    }
}

impl View for ParallelView {
    type Space = Space3;
    type Sides = ParallelSides;

    fn space(&mut self) -> &mut Space3 {
        &mut self.space
    }

    fn frame(&mut self, tree: &mut OcclusionTree<Plane3>) {
        frame(&mut self.space, &self.frame, tree);
    }

    fn occluder(&mut self, polygon: &PolygonRef<'_>) -> Option<(Cone3, Occluder)> {
        let rate = product(polygon.plane, self.direction);
        if rate == 0 {
            return None;
        }
        let [a, b, c] = self.axes;
        let d = i128::from(self.direction[a]);
        // Nearer is smaller along the direction.
        let sign = -d.signum() * rate.signum();
        let n = polygon.plane.normal.map(i128::from);
        let nearness = Nearness {
            row: [-n[b] * sign, -n[c] * sign, polygon.plane.offset * d * sign],
            scale: rate.abs(),
        };
        let occluder = self.space.occluder(nearness, polygon.id.0);
        let mut images: Vec<[i64; 3]> = polygon.corners.iter().map(|&p| self.image(p)).collect();
        let first = images[0];
        orient(&mut images);
        let cone = self.space.cone(&images);
        self.edges.add(occluder, &cone, images[0] != first);
        Some((cone, occluder))
    }

    fn roots(&mut self, tree: &OcclusionTree<Plane3>) -> Vec<(Slot, Cone3)> {
        roots(&mut self.space, &self.frame, tree)
    }

    fn edge_plane(&self, occluder: Occluder, edge: usize) -> Plane3 {
        self.edges.of(occluder, edge)
    }

    fn region(&mut self, bounds: &Aabb) -> Region<Cone3> {
        let position = self.direction.map(|c| -(c.signum() as i8));
        let (corners, n) = outline(bounds, position);
        let mut images: Vec<[i64; 3]> =
            corners[..n].iter().map(|&c| self.image(c.into())).collect();
        images.dedup();
        match orient(&mut images) {
            true => Region::Piece(self.space.cone(&images)),
            false => Region::Nowhere,
        }
    }

    fn line_through(&mut self, point: Point) -> Ray3 {
        let image = self.image(point);
        self.space.ray(image)
    }

    fn mark(&mut self) -> Mark {
        self.space.mark()
    }

    fn rewind(&mut self, mark: Mark) {
        self.space.rewind(mark);
    }

    fn sides(&self) -> ParallelSides {
        ParallelSides(self.direction)
    }

    fn lower_first(&self, axis: usize, _at: i32) -> bool {
        self.direction[axis] > 0
    }

    fn near(&self, bounds: &Aabb) -> u32 {
        (self.distance(bounds) >> UNIT) as u32
    }

    fn range(&self, polygon: &PolygonRef<'_>) -> Range {
        let along = |p: &Point| {
            let products = p.to_i64().into_iter().zip(self.direction);
            products.map(|(c, d)| c * i64::from(d)).sum::<i64>()
        };
        let (mut near, mut far) = (i64::MAX, i64::MIN);
        for at in polygon.corners.iter().map(along) {
            (near, far) = (near.min(at), far.max(at));
        }
        Range {
            near: (positive(near) >> UNIT) as u32,
            far: (positive(far) >> UNIT) as u32 + 1,
        }
    }

    fn far(_: &Space3, _: &Cone3, _: Occluder) -> u32 {
        u32::MAX
    }

    fn distance(&self, bounds: &Aabb) -> u128 {
        let (low, high) = (bounds.min.to_i64(), bounds.max.to_i64());
        let nearest: i64 = (0..3)
            .map(|k| {
                let d = i64::from(self.direction[k]);
                (d * low[k]).min(d * high[k])
            })
            .sum();
        positive(nearest)
    }
}
