//! The lines through a point of the plane, as rays of R^2 [Bittner02, 2.2.2].
//!
//! A line is its direction, an angle of less than a half turn is a piece, and a point p seen from e
//! is the hyperplane of the directions parallel to `p - e`, positive for those that have it on their
//! left. Directions of grid points have 25 bits; those of crossings 77 with their weight, so products have
//! 155. Doubles filter: each component errs by at most 2^-53, two products and their difference by less
//! than 2^-50 of the sum of the magnitudes.

use antumbra_kernel::{I256, Point2, Sign};

use crate::chord::{SegmentOccluder, SegmentOrder};
use crate::line_space::{Cut, DepthSpace, Facet, Half, LineSpace, Occluder, Order, Wall};

/// A hyperplane of a [`Pencil`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction(u32);

/// A direction by its components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray2 {
    /// Exact components, below 2^80 in magnitude.
    pub exact: [i128; 2],
    /// The same, rounded, for filters.
    rounded: [f64; 2],
}

/// The directions from one ray to another, less than a half turn to its left.
#[derive(Clone, Copy, Debug)]
pub struct Wedge {
    /// The right border and the left border.
    pub rays: [Ray2; 2],
    planes: [Direction; 2],
    sides: [Half; 2],
    walls: [Wall; 2],
}

/// The space of lines through one point.
#[derive(Clone, Debug)]
pub struct Pencil {
    eye: Point2,
    directions: Vec<Ray2>,
    occluders: Vec<SegmentOccluder>,
}

impl Ray2 {
    fn new(exact: [i128; 2]) -> Self {
        Self {
            exact,
            rounded: exact.map(|c| c as f64),
        }
    }

    fn opposite(&self) -> Self {
        Self {
            exact: self.exact.map(|c| -c),
            rounded: self.rounded.map(|c| -c),
        }
    }

    /// The components in doubles.
    #[inline]
    #[must_use]
    pub fn rounded(&self) -> [f64; 2] {
        self.rounded
    }
}

/// The sign of `u x v`: positive if v points to the left of u. Exact.
#[inline]
fn turn(u: &Ray2, v: &Ray2) -> Sign {
    let ([a, b], [c, d]) = (u.rounded(), v.rounded());
    let (p, q) = (a * d, b * c);
    let bound = (p.abs() + q.abs()) * (1.0 / (1_u64 << 50) as f64);
    let value = p - q;
    if value > bound {
        Sign::Positive
    } else if value < -bound {
        Sign::Negative
    } else {
        let ([a, b], [c, d]) = (u.exact, v.exact);
        (I256::product_i128(a, d) - I256::product_i128(b, c)).sign()
    }
}

impl Pencil {
    /// All lines through a point of the grid.
    #[must_use]
    pub fn new(eye: Point2) -> Self {
        Self {
            eye,
            directions: Vec::new(),
            occluders: Vec::new(),
        }
    }

    /// The point.
    #[must_use]
    pub fn eye(&self) -> Point2 {
        self.eye
    }

    /// The direction to a point with homogeneous coordinates and positive weight.
    fn toward(&self, [x, y, w]: [i128; 3]) -> Ray2 {
        let [ex, ey] = self.eye.to_i64().map(i128::from);
        Ray2::new([x - ex * w, y - ey * w])
    }

    fn plane(&mut self, ray: Ray2) -> Direction {
        self.directions.push(ray);
        Direction(self.directions.len() as u32 - 1)
    }

    /// The direction with these components.
    #[must_use]
    pub fn ray(&self, components: [i64; 2]) -> Ray2 {
        Ray2 {
            exact: components.map(i128::from),
            rounded: components.map(|c| c as f64),
        }
    }

    /// The directions between two, the second to the left of the first by less than a half turn.
    pub fn wedge(&mut self, right: [i64; 2], left: [i64; 2]) -> Wedge {
        let rays = [self.ray(right), self.ray(left)];
        debug_assert!(turn(&rays[0], &rays[1]).is_positive());
        let planes = rays.map(|r| self.plane(r));
        // A point on the right border lies right of the directions inside.
        Wedge {
            rays,
            planes,
            sides: [Half::Negative, Half::Positive],
            walls: [Wall::NONE; 2],
        }
    }

    /// The hyperplane of a direction.
    pub fn direction(&mut self, components: [i64; 2]) -> Direction {
        let ray = self.ray(components);
        self.plane(ray)
    }

    /// Adds an occluder.
    pub fn occluder(&mut self, segment: SegmentOccluder) -> Occluder {
        self.occluders.push(segment);
        Occluder(self.occluders.len() as u32 - 1)
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

    /// How far the space is filled: directions and occluders.
    #[must_use]
    pub fn filled(&self) -> (usize, usize) {
        (self.directions.len(), self.occluders.len())
    }

    /// Forgets what was made since.
    pub fn rewind(&mut self, (directions, occluders): (usize, usize)) {
        self.directions.truncate(directions);
        self.occluders.truncate(occluders);
    }
}

impl LineSpace for Pencil {
    type Plane = Direction;
    type Ray = Ray2;
    type Piece = Wedge;

    /// Positive if the hyperplane's point lies left of the ray. Within the half turn in front of the
    /// plane's direction this is the side of the point; behind, that of the opposite direction.
    #[inline]
    fn sign(&self, plane: Direction, ray: &Ray2) -> Sign {
        turn(ray, &self.directions[plane.0 as usize])
    }

    fn rays<'p>(&self, piece: &'p Wedge) -> impl Iterator<Item = &'p Ray2> + 'p {
        piece.rays.iter()
    }

    fn facets(&self, piece: &Wedge) -> impl Iterator<Item = Facet<Direction>> {
        let piece = *piece;
        (0..2).map(move |k| Facet {
            plane: piece.planes[k],
            side: piece.sides[k],
            wall: piece.walls[k],
        })
    }

    fn cut(&mut self, mut piece: Wedge, plane: Direction, wall: Wall) -> Cut<Wedge> {
        let signs = [0, 1].map(|k| self.sign(plane, &piece.rays[k]));
        if !signs[0].times(signs[1]).is_negative() {
            let half = match (signs[0], signs[1]) {
                (Sign::Negative, _) | (Sign::Zero, Sign::Negative) => Half::Negative,
                _ => Half::Positive,
            };
            for k in (0..2).filter(|&k| signs[k].is_zero() && !wall.is_none()) {
                (piece.planes[k], piece.sides[k], piece.walls[k]) = (plane, half, wall);
            }
            return Cut::Whole(half, piece);
        }
        // The ray of the cut lies between the two, so it or its opposite does.
        let mut ray = self.directions[plane.0 as usize];
        if !turn(&piece.rays[0], &ray).is_positive() || !turn(&ray, &piece.rays[1]).is_positive() {
            ray = ray.opposite();
        }
        let (mut right, mut left) = (piece, piece);
        right.rays[1] = ray;
        left.rays[0] = ray;
        let half = |sign: Sign| {
            if sign.is_negative() {
                Half::Negative
            } else {
                Half::Positive
            }
        };
        (right.planes[1], right.sides[1], right.walls[1]) = (plane, half(signs[0]), wall);
        (left.planes[0], left.sides[0], left.walls[0]) = (plane, half(signs[1]), wall);
        Cut::Parts(if signs[0].is_negative() {
            [right, left]
        } else {
            [left, right]
        })
    }
}

impl DepthSpace for Pencil {
    fn order(&mut self, _piece: &Wedge, new: Occluder, old: Occluder) -> Order<Direction> {
        match self.segment(new).order(self.segment(old)) {
            SegmentOrder::Behind => Order::Behind,
            SegmentOrder::InFront => Order::InFront,
            SegmentOrder::Crossing(point, front) => {
                let ray = self.toward(point);
                Order::Crossing(self.plane(ray), front)
            }
        }
    }
}
