//! Oriented lines of the plane, as rays of R^3 [Bittner02, 6.4].
//!
//! A line `a x + b y + c = 0` is the ray (a, b, c); a point p is the hyperplane (px, py, 1), positive
//! for lines that have p on their left. So sets of lines are cones of [`Space3`], shared with views
//! from a point. Rows of grid points are narrow (24 bits), their meets have at most 49 bits and are exact in
//! the doubles of the filters; rows of crossings have 75 bits. Each point has one hyperplane, so that
//! incidences are found by name.

use antumbra_kernel::{I256, Point2, Sign};
use rustc_hash::FxHashMap;

use crate::chord::{SegmentOccluder, SegmentOrder};
use crate::cone3::{Cone3, ExactRay, Mark, Plane3, Ray3, Space3};
use crate::line_space::{Cut, DepthSpace, Facet, Half, LineSpace, Occluder, Order, Wall};

/// The space of oriented lines of the plane.
#[derive(Clone, Debug, Default)]
pub struct PlaneLines {
    space: Space3,
    planes: FxHashMap<Point2, Plane3>,
    occluders: Vec<SegmentOccluder>,
}

impl PlaneLines {
    /// An empty space.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The hyperplane of a point: positive for lines that have it on their left.
    pub fn point(&mut self, p: Point2) -> Plane3 {
        let space = &mut self.space;
        *self
            .planes
            .entry(p)
            .or_insert_with(|| space.plane([i64::from(p.x), i64::from(p.y), 1]))
    }

    /// A hyperplane that is forgotten at the next [`PlaneLines::rewind`]: that of the point with these
    /// homogeneous coordinates, the last one positive, all below 2^62.
    pub fn passing(&mut self, point: [i64; 3]) -> Plane3 {
        self.space.plane(point)
    }

    /// The hyperplane of a homogeneous point with positive weight; coordinates below 2^127.
    pub fn crossing(&mut self, point: [i128; 3]) -> Plane3 {
        self.space.wide_plane(point.map(I256::from_i128))
    }

    /// The homogeneous point of a hyperplane.
    ///
    /// # Panics
    /// If there is no such hyperplane.
    #[must_use]
    pub fn point_of(&self, plane: Plane3) -> [i128; 3] {
        // Every row here was made from 128 bits.
        self.space.row(plane).map(|c| {
            let [low, high, ..] = *c.limbs();
            (u128::from(low) | u128::from(high) << 64) as i128
        })
    }

    /// Adds an occluder.
    pub fn occluder(&mut self, segment: SegmentOccluder) -> Occluder {
        self.occluders.push(segment);
        Occluder(self.occluders.len() as u32 - 1)
    }

    /// Forgets the occluders from a number on.
    pub fn forget(&mut self, from: Occluder) {
        self.occluders.truncate(from.0 as usize);
    }

    /// The segment of an occluder.
    ///
    /// # Panics
    /// If there is no such occluder.
    #[inline]
    #[must_use]
    pub fn segment(&self, occluder: Occluder) -> &SegmentOccluder {
        &self.occluders[occluder.0 as usize]
    }

    /// How many occluders there are.
    #[must_use]
    pub fn occluder_count(&self) -> usize {
        self.occluders.len()
    }

    /// The cone of some half-spaces in turning order; see [`Space3::cone_of`].
    pub fn cone_of(&mut self, facets: &[Facet<Plane3>]) -> Cone3 {
        self.space.cone_of(facets)
    }

    /// The line on two points; see [`Space3::meet`].
    #[inline]
    #[must_use]
    pub fn meet(&self, a: Plane3, b: Plane3) -> Ray3 {
        self.space.meet(a, b)
    }

    /// A line as integers.
    #[must_use]
    pub fn exact(&self, line: &Ray3) -> ExactRay {
        self.space.exact(line)
    }

    /// How far the space is filled.
    #[must_use]
    pub fn mark(&self) -> Mark {
        self.space.mark()
    }

    /// Forgets what was made since a mark; nothing of [`PlaneLines::point`] may have been made since.
    pub fn rewind(&mut self, mark: Mark) {
        self.space.rewind(mark);
    }

    /// How many signs the filters left to integers.
    #[must_use]
    pub fn exact_signs(&self) -> u64 {
        self.space.exact_signs()
    }
}

impl LineSpace for PlaneLines {
    type Plane = Plane3;
    type Ray = Ray3;
    type Piece = Cone3;

    #[inline]
    fn sign(&self, plane: Plane3, ray: &Ray3) -> Sign {
        self.space.sign(plane, ray)
    }

    fn rays<'p>(&self, piece: &'p Cone3) -> impl Iterator<Item = &'p Ray3> + 'p {
        self.space.rays(piece)
    }

    fn facets(&self, piece: &Cone3) -> impl Iterator<Item = Facet<Plane3>> {
        self.space.facets(piece)
    }

    #[inline]
    fn cut(&mut self, piece: Cone3, plane: Plane3, wall: Wall) -> Cut<Cone3> {
        self.space.cut(piece, plane, wall)
    }

    fn discard(&mut self, piece: Cone3) {
        self.space.discard(piece);
    }
}

impl DepthSpace for PlaneLines {
    fn order(&mut self, _piece: &Cone3, new: Occluder, old: Occluder) -> Order<Plane3> {
        match self.segment(new).order(self.segment(old)) {
            SegmentOrder::Behind => Order::Behind,
            SegmentOrder::InFront => Order::InFront,
            SegmentOrder::Crossing(point, front) => Order::Crossing(self.crossing(point), front),
        }
    }
}

/// A half-space as a facet that is still new.
#[inline]
#[must_use]
pub fn facet(plane: Plane3, side: Half) -> Facet<Plane3> {
    Facet {
        plane,
        side,
        wall: Wall::NONE,
    }
}
