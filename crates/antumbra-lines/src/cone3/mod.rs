//! Convex cones in R^3, exactly: directions from a viewpoint, parallel lines, lines of the plane.
//!
//! A line is a ray of R^3, a hyperplane a row of integers, and a cone a convex polygon of rays. Rays
//! are named: given by three integers, or as the meet of two hyperplanes; what is constructed is
//! never rounded into a sign. After [Bittner02, 2.2.4 and 5.4].
//!
//! Floats are filters only. A ray and a row are kept as doubles with relative errors of at most
//! 2^-52 a component. Three products and two sums of them err by less than 2^-50 times the sum of
//! the magnitudes (2^-52 + 2^-52 + 3 * 2^-53 < 2^-50, higher terms included); the filter asks for
//! 2^-49 of the computed sum, which covers the rounding of that sum.

mod depth;
mod exact;

use antumbra_kernel::{I256, Sign};

pub use depth::{Nearness, primitive};
pub use exact::ExactRay;
use exact::Row;

use crate::line_space::{Cut, Facet, Half, LineSpace, Wall};

/// A hyperplane of a [`Space3`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Plane3(u32);

/// A ray of R^3 by name, beside the doubles that filters read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray3 {
    rounded: [f64; 3],
    name: RayName,
}

/// What a ray is made from: two hyperplanes, first times second; or `GIVEN_RAY` and an entry of the space's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RayName(u32, u32);

const GIVEN_RAY: u32 = u32::MAX;

impl Ray3 {
    /// The direction in doubles, each component within a relative error of 2^-52; not normalized.
    #[inline]
    #[must_use]
    pub fn rounded(&self) -> [f64; 3] {
        self.rounded
    }

    /// The two hyperplanes that name the ray; `None` if it was given.
    #[inline]
    #[must_use]
    pub fn planes(&self) -> Option<[Plane3; 2]> {
        let RayName(a, b) = self.name;
        (a != GIVEN_RAY).then_some([Plane3(a), Plane3(b)])
    }
}

/// A corner of a cone: a ray, and the facet from it to the next ray.
#[derive(Clone, Copy, Debug)]
pub struct Corner3 {
    /// The ray.
    pub ray: Ray3,
    /// The hyperplane of the facet that follows.
    pub plane: Plane3,
    /// On which side of it the cone lies.
    pub side: Half,
    /// Which cut made the facet.
    pub wall: Wall,
}

/// A pointed convex cone with an interior: rays in order, so that `u x v` of neighbors points inward.
#[derive(Clone, Debug, Default)]
pub struct Cone3 {
    /// The corners.
    pub corners: Vec<Corner3>,
}

/// A table of hyperplanes, given rays and occluders, in which cones are cut.
#[derive(Clone, Debug, Default)]
pub struct Space3 {
    /// Rows as doubles; read by every filter.
    filters: Vec<[f64; 3]>,
    rows: Vec<Row>,
    given: Vec<[i64; 3]>,
    occluders: depth::Occluders,
    /// Scratch: the signs of the corners of the cone being cut.
    signs: Vec<Sign>,
    spare: Vec<Vec<Corner3>>,
    exact_signs: u64,
}

/// How far a [`Space3`] was filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    planes: usize,
    given: usize,
    occluders: usize,
}

/// Narrow rows are smaller than this.
const NARROW: i64 = 1 << 62;
/// Given rays are smaller than this.
const GIVEN: i64 = 1 << 35;
/// Rows below this are multiplied in doubles without rounding.
const SMALL: f64 = (1_u64 << 26) as f64;
/// Sums of magnitudes below this are made of exact terms.
const EXACT: f64 = (1_u64 << 52) as f64;
/// 2^-49, see the proof above.
const FILTER: f64 = 1.0 / (1_u64 << 49) as f64;

impl Space3 {
    /// An empty space.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// How far the tables are filled.
    #[must_use]
    pub fn mark(&self) -> Mark {
        Mark {
            planes: self.rows.len(),
            given: self.given.len(),
            occluders: self.occluders.len(),
        }
    }

    /// Forgets everything made since a mark; nothing made since may be used afterwards.
    pub fn rewind(&mut self, mark: Mark) {
        self.filters.truncate(mark.planes);
        self.rows.truncate(mark.planes);
        self.given.truncate(mark.given);
        self.occluders.truncate(mark.occluders);
    }

    /// How many hyperplanes there are.
    #[must_use]
    pub fn plane_count(&self) -> usize {
        self.rows.len()
    }

    /// How many signs the filters left to integers.
    #[must_use]
    pub fn exact_signs(&self) -> u64 {
        self.exact_signs
    }

    /// A hyperplane by its row.
    ///
    /// # Panics
    /// In debug builds, if a coefficient reaches 2^62 in magnitude, or all are zero.
    pub fn plane(&mut self, row: [i64; 3]) -> Plane3 {
        debug_assert!(row.iter().all(|c| c.abs() < NARROW) && row != [0; 3]);
        self.push(Row::Narrow(row))
    }

    /// A hyperplane by a wide row; coefficients are smaller than 2^160 in magnitude.
    pub fn wide_plane(&mut self, row: [I256; 3]) -> Plane3 {
        debug_assert!(row.iter().all(|c| c.bits() <= 160));
        self.push(Row::of_wide(row))
    }

    fn push(&mut self, row: Row) -> Plane3 {
        self.filters.push(row.to_f64());
        self.rows.push(row);
        Plane3(self.rows.len() as u32 - 1)
    }

    /// The row of a hyperplane.
    ///
    /// # Panics
    /// If there is no such hyperplane.
    #[must_use]
    pub fn row(&self, plane: Plane3) -> [I256; 3] {
        self.rows[plane.0 as usize].wide()
    }

    /// A ray by its components.
    ///
    /// # Panics
    /// In debug builds, if a component reaches 2^35 in magnitude.
    pub fn ray(&mut self, direction: [i64; 3]) -> Ray3 {
        debug_assert!(direction.iter().all(|c| c.abs() < GIVEN));
        self.given.push(direction);
        Ray3 {
            rounded: direction.map(|c| c as f64),
            name: RayName(GIVEN_RAY, self.given.len() as u32 - 1),
        }
    }

    /// The hyperplane through two given directions, positive on the left of the way from one to the
    /// other. Wide where its coefficients need it.
    pub fn plane_through(&mut self, u: [i64; 3], v: [i64; 3]) -> Plane3 {
        let m = |i: usize, j: usize| {
            i128::from(u[i]) * i128::from(v[j]) - i128::from(u[j]) * i128::from(v[i])
        };
        let row = [m(1, 2), m(2, 0), m(0, 1)];
        let narrow = row.iter().all(|c| c.abs() < i128::from(NARROW));
        if narrow {
            self.plane(row.map(|c| c as i64))
        } else {
            self.wide_plane(row.map(I256::from_i128))
        }
    }

    /// The cone over a strictly convex polygon of directions, `u x v` of neighbors pointing inward.
    pub fn cone(&mut self, directions: &[[i64; 3]]) -> Cone3 {
        let mut corners = self.spare.pop().unwrap_or_default();
        corners.clear();
        for (i, &u) in directions.iter().enumerate() {
            let v = directions[(i + 1) % directions.len()];
            let corner = Corner3 {
                ray: self.ray(u),
                plane: self.plane_through(u, v),
                side: Half::Positive,
                wall: Wall::NONE,
            };
            corners.push(corner);
        }
        Cone3 { corners }
    }

    /// The pointed cone of some half-spaces, each a facet, in the order in which inward rows turn: for
    /// three of them, their determinant is positive.
    pub fn cone_of(&mut self, facets: &[Facet<Plane3>]) -> Cone3 {
        let mut corners = self.spare.pop().unwrap_or_default();
        corners.clear();
        let n = facets.len();
        for (i, facet) in facets.iter().enumerate() {
            let before = &facets[(i + n - 1) % n];
            corners.push(Corner3 {
                ray: self.meet_inward((before.plane, before.side), (facet.plane, facet.side)),
                plane: facet.plane,
                side: facet.side,
                wall: facet.wall,
            });
        }
        Cone3 { corners }
    }

    /// The product of two rows, each turned so that it is positive on its side.
    #[inline]
    #[must_use]
    pub fn meet_inward(&self, a: (Plane3, Half), b: (Plane3, Half)) -> Ray3 {
        if a.1 == b.1 {
            self.meet(a.0, b.0)
        } else {
            self.meet(b.0, a.0)
        }
    }

    /// The ray where two hyperplanes meet, their rows multiplied in this order.
    ///
    /// The hyperplanes must differ.
    #[inline]
    #[must_use]
    pub fn meet(&self, a: Plane3, b: Plane3) -> Ray3 {
        let (u, v) = (&self.filters[a.0 as usize], &self.filters[b.0 as usize]);
        let small = |r: &[f64; 3]| r.iter().all(|c| c.abs() < SMALL);
        if small(u) && small(v) {
            // Products below 2^52 and their differences are exact in doubles.
            let m = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
            return Ray3 {
                rounded: [m(1, 2), m(2, 0), m(0, 1)],
                name: RayName(a.0, b.0),
            };
        }
        let exact = exact::meet(&self.rows[a.0 as usize], &self.rows[b.0 as usize]);
        Ray3 {
            rounded: exact.to_f64(),
            name: RayName(a.0, b.0),
        }
    }

    /// A ray as integers.
    #[must_use]
    pub fn exact(&self, ray: &Ray3) -> ExactRay {
        match ray.name {
            RayName(GIVEN_RAY, i) => ExactRay::Given(self.given[i as usize]),
            RayName(a, b) => exact::meet(&self.rows[a as usize], &self.rows[b as usize]),
        }
    }

    /// The sign of `row . ray`: the name, then the filter, then integers.
    #[inline]
    fn side(&self, plane: Plane3, ray: &Ray3) -> (Sign, bool) {
        let (h, r) = (&self.filters[plane.0 as usize], &ray.rounded);
        let (a, b, c) = (h[0] * r[0], h[1] * r[1], h[2] * r[2]);
        let size = a.abs() + b.abs() + c.abs();
        let bound = size * FILTER;
        let value = a + b + c;
        if value > bound {
            return (Sign::Positive, false);
        }
        if value < -bound {
            return (Sign::Negative, false);
        }
        // Integers below 2^53 are doubles, and so are all products and sums here.
        if size < EXACT {
            return (Sign::of(value), false);
        }
        self.side_by_name(plane, ray)
    }

    #[cold]
    fn side_by_name(&self, plane: Plane3, ray: &Ray3) -> (Sign, bool) {
        let RayName(a, b) = ray.name;
        if a != GIVEN_RAY && (a == plane.0 || b == plane.0) {
            return (Sign::Zero, false);
        }
        let sign = exact::sign(&self.rows[plane.0 as usize], &self.exact(ray));
        (sign, true)
    }

    /// Where a cone's facet crosses a hyperplane: on the way from a positive to a negative ray.
    fn crossing(&self, corner: &Corner3, plane: Plane3, from: Sign) -> Ray3 {
        // With the inward row n = u x v, the ray is n x h from + to -, and h x n from - to +.
        let forward = (corner.side == Half::Positive) == from.is_positive();
        if forward {
            self.meet(corner.plane, plane)
        } else {
            self.meet(plane, corner.plane)
        }
    }
}

impl LineSpace for Space3 {
    type Plane = Plane3;
    type Ray = Ray3;
    type Piece = Cone3;

    #[inline]
    fn sign(&self, plane: Plane3, ray: &Ray3) -> Sign {
        self.side(plane, ray).0
    }

    fn rays<'p>(&self, piece: &'p Cone3) -> impl Iterator<Item = &'p Ray3> + 'p {
        piece.corners.iter().map(|c| &c.ray)
    }

    fn facets(&self, piece: &Cone3) -> impl Iterator<Item = Facet<Plane3>> {
        piece.corners.iter().map(|c| Facet {
            plane: c.plane,
            side: c.side,
            wall: c.wall,
        })
    }

    fn cut(&mut self, mut piece: Cone3, plane: Plane3, wall: Wall) -> Cut<Cone3> {
        let mut signs = std::mem::take(&mut self.signs);
        signs.clear();
        let mut found = [false; 3];
        for corner in &piece.corners {
            let (sign, exact) = self.side(plane, &corner.ray);
            self.exact_signs += u64::from(exact);
            found[(sign.to_i8() + 1) as usize] = true;
            signs.push(sign);
        }
        let [negative, zero, positive] = found;
        let cut = if negative && positive {
            let parts = self.parts(&piece, plane, wall, &signs);
            self.discard(piece);
            Cut::Parts(parts)
        } else {
            let half = if negative {
                Half::Negative
            } else {
                Half::Positive
            };
            if zero && !wall.is_none() {
                mark_facet(&mut piece, plane, half, wall, &signs);
            }
            Cut::Whole(half, piece)
        };
        self.signs = signs;
        cut
    }

    fn discard(&mut self, piece: Cone3) {
        if self.spare.len() < 64 {
            self.spare.push(piece.corners);
        }
    }
}

impl Space3 {
    /// Both parts of a cone that has rays strictly on both sides.
    fn parts(&mut self, piece: &Cone3, plane: Plane3, wall: Wall, signs: &[Sign]) -> [Cone3; 2] {
        let mut parts = [
            self.spare.pop().unwrap_or_default(),
            self.spare.pop().unwrap_or_default(),
        ];
        parts.iter_mut().for_each(Vec::clear);
        let n = piece.corners.len();
        for i in 0..n {
            let corner = &piece.corners[i];
            let (here, next) = (signs[i], signs[(i + 1) % n]);
            let crossing = here.times(next).is_negative();
            for half in [Half::Negative, Half::Positive] {
                let part = &mut parts[half.index()];
                let inside = half.sign();
                if here == inside || (here.is_zero() && next == inside) {
                    part.push(*corner);
                } else if here.is_zero() {
                    part.push(on_cut(corner.ray, plane, half, wall));
                }
            }
            if crossing {
                let ray = self.crossing(corner, plane, here);
                let leaving = if here.is_positive() {
                    Half::Positive
                } else {
                    Half::Negative
                };
                parts[leaving.index()].push(on_cut(ray, plane, leaving, wall));
                parts[leaving.opposite().index()].push(Corner3 { ray, ..*corner });
            }
        }
        parts.map(|corners| Cone3 { corners })
    }
}

/// A corner from which the facet of a cut goes on.
fn on_cut(ray: Ray3, plane: Plane3, side: Half, wall: Wall) -> Corner3 {
    Corner3 {
        ray,
        plane,
        side,
        wall,
    }
}

/// Marks the facet of a whole piece that lies in a hyperplane, if there is one.
fn mark_facet(piece: &mut Cone3, plane: Plane3, side: Half, wall: Wall, signs: &[Sign]) {
    let n = signs.len();
    for i in 0..n {
        if signs[i].is_zero() && signs[(i + 1) % n].is_zero() {
            piece.corners[i] = on_cut(piece.corners[i].ray, plane, side, wall);
        }
    }
}
