//! Which of two planar occluders comes first along a ray of R^3.
//!
//! The plane of an occluder gives a row L and a scale D > 0 such that `L . r / D` is larger the nearer
//! the occluder is along r: for a viewpoint e and a plane n . p = n . c it is n and n . (c - e), both
//! negated if need be, since the ray meets the plane at t = D / (L . r). So one is in front of another
//! where `D_old L_new - D_new L_old` is positive, and this row is the hyperplane through the viewpoint
//! and their common line.
//!
//! Floats filter: both products `L . r` err by less than 2^-50 of their sums of magnitudes (see the
//! module above), the scales and the two products with them by 2^-52 each more, the difference by
//! 2^-53: 2^-48 of the weighted sums of magnitudes is on the safe side.

use antumbra_kernel::{I256, Int, Sign};

use super::exact::{ExactRay, Row, sign};
use super::{Cone3, Plane3, Ray3, Space3};
use crate::line_space::{DepthSpace, Half, Occluder, Order};

/// How near an occluder's plane is along rays: `row . r / scale`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nearness {
    /// The row; not zero.
    pub row: [i128; 3],
    /// The scale, larger than zero.
    pub scale: i128,
}

/// The occluders of a space.
#[derive(Clone, Debug, Default)]
pub(super) struct Occluders {
    /// What filters read, apart from the rest.
    rounded: Vec<Rounded>,
    exact: Vec<(Nearness, u32)>,
}

#[derive(Clone, Copy, Debug)]
struct Rounded {
    row: [f64; 3],
    scale: f64,
}

impl Occluders {
    pub(super) fn len(&self) -> usize {
        self.exact.len()
    }

    pub(super) fn truncate(&mut self, len: usize) {
        self.rounded.truncate(len);
        self.exact.truncate(len);
    }

    fn rounded(&self, occluder: Occluder) -> &Rounded {
        &self.rounded[occluder.0 as usize]
    }

    fn key(&self, occluder: Occluder) -> u32 {
        self.exact[occluder.0 as usize].1
    }

    /// The row of the common line of two of them.
    fn common_row(&self, a: Occluder, b: Occluder) -> [I256; 3] {
        let [a, b] = [a, b].map(|o| &self.exact[o.0 as usize].0);
        std::array::from_fn(|k| {
            I256::product_i128(b.scale, a.row[k]) - I256::product_i128(a.scale, b.row[k])
        })
    }
}

/// 2^-48, see the proof above.
const FILTER: f64 = 1.0 / (1_u64 << 48) as f64;

impl Space3 {
    /// Adds an occluder by its plane. Of two in one plane the smaller key is in front.
    ///
    /// For any two, the products of the scale of one and the row of the other must be smaller than
    /// 2^159 in magnitude.
    pub fn occluder(&mut self, nearness: Nearness, key: u32) -> Occluder {
        debug_assert!(nearness.scale > 0);
        let occluder = Occluder(self.occluders.len() as u32);
        self.occluders.rounded.push(Rounded {
            row: nearness.row.map(|c| c as f64),
            scale: nearness.scale as f64,
        });
        self.occluders.exact.push((nearness, key));
        occluder
    }

    /// The key of an occluder.
    ///
    /// # Panics
    /// If there is no such occluder.
    #[must_use]
    pub fn key(&self, occluder: Occluder) -> u32 {
        self.occluders.key(occluder)
    }

    /// The sign of how much nearer `a` is than `b` along a ray: zero where their planes meet.
    /// Exact, degree 9 at a meet of two edges.
    ///
    /// # Panics
    /// If there is no such occluder.
    #[must_use]
    pub fn nearer(&self, a: Occluder, b: Occluder, ray: &Ray3) -> Sign {
        let occluders = &self.occluders;
        filtered(occluders.rounded(a), occluders.rounded(b), &ray.rounded).unwrap_or_else(|| {
            let row = Row::Wide(occluders.common_row(a, b));
            sign(&row, &self.exact(ray))
        })
    }

    /// The hyperplane of the common line of two occluders, positive where `a` is nearer.
    ///
    /// # Panics
    /// If there is no such occluder.
    pub fn common_plane(&mut self, a: Occluder, b: Occluder) -> Plane3 {
        let row = self.occluders.common_row(a, b);
        self.wide_plane(row)
    }

    /// How far from a viewpoint a ray meets the occluder's plane: an upper bound, infinite where it cannot be told.
    ///
    /// # Panics
    /// If there is no such occluder.
    #[must_use]
    pub fn farthest(&self, occluder: Occluder, ray: &Ray3) -> f64 {
        let (entry, r) = (self.occluders.rounded(occluder), ray.rounded);
        let p: [f64; 3] = std::array::from_fn(|k| entry.row[k] * r[k]);
        let size = p[0].abs() + p[1].abs() + p[2].abs();
        // A lower bound of the product, by the proof above.
        let least = p[0] + p[1] + p[2] - size * FILTER;
        if least <= 0.0 {
            return f64::INFINITY;
        }
        let length = (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]).sqrt();
        // The scale, the length, two products and a quotient: together below 2^-48.
        entry.scale / least * length * (1.0 + FILTER)
    }

    /// Where a ray meets the occluder's plane, as a multiple of the ray (viewpoints only). Rounded.
    ///
    /// # Panics
    /// If there is no such occluder.
    #[must_use]
    pub fn distance(&self, occluder: Occluder, ray: [f64; 3]) -> f64 {
        let entry = self.occluders.rounded(occluder);
        entry.scale / (0..3).map(|k| entry.row[k] * ray[k]).sum::<f64>()
    }
}

#[inline]
fn filtered(a: &Rounded, b: &Rounded, r: &[f64; 3]) -> Option<Sign> {
    let p: [f64; 3] = std::array::from_fn(|k| a.row[k] * r[k]);
    let q: [f64; 3] = std::array::from_fn(|k| b.row[k] * r[k]);
    let value = b.scale * (p[0] + p[1] + p[2]) - a.scale * (q[0] + q[1] + q[2]);
    let size = |t: [f64; 3]| t[0].abs() + t[1].abs() + t[2].abs();
    let bound = (b.scale * size(p) + a.scale * size(q)) * FILTER;
    if value > bound {
        Some(Sign::Positive)
    } else if value < -bound {
        Some(Sign::Negative)
    } else {
        None
    }
}

impl DepthSpace for Space3 {
    fn order(&mut self, piece: &Cone3, new: Occluder, old: Occluder) -> Order<Plane3> {
        let [a, b] = [new, old].map(|o| *self.occluders.rounded(o));
        let mut common: Option<Row> = None;
        let mut found = [false; 3];
        for corner in &piece.corners {
            let sign = filtered(&a, &b, &corner.ray.rounded).unwrap_or_else(|| {
                self.exact_signs += 1;
                let row =
                    common.get_or_insert_with(|| Row::Wide(self.occluders.common_row(new, old)));
                sign(row, &self.exact(&corner.ray))
            });
            found[(sign.to_i8() + 1) as usize] = true;
        }
        match found {
            [true, _, true] => {
                let row = self.occluders.common_row(new, old);
                Order::Crossing(self.wide_plane(row), Half::Positive)
            }
            [true, _, false] => Order::Behind,
            [false, _, true] => Order::InFront,
            [false, _, false] if self.occluders.key(new) < self.occluders.key(old) => {
                Order::InFront
            }
            [false, _, false] => Order::Behind,
        }
    }
}

/// The greatest common divisor of a ray's components taken out: equal rays become equal integers.
///
/// Big integers do the work; for output and tests.
#[must_use]
pub fn primitive(ray: &ExactRay) -> [dashu_int::IBig; 3] {
    use dashu_int::{IBig, ops::Gcd};
    let big = ray.wide().map(|c| to_big(&c));
    let common = big
        .iter()
        .filter(|c| **c != IBig::ZERO)
        .cloned()
        .reduce(|a, b| IBig::from(a.gcd(b)));
    match common {
        Some(g) => {
            let g = if g < IBig::ZERO { -g } else { g };
            big.map(|c| c / &g)
        }
        None => big,
    }
}

fn to_big(v: &Int<6>) -> dashu_int::IBig {
    let magnitude = if v.is_negative() { -*v } else { *v };
    let limbs = magnitude.limbs().iter().rev();
    let big = limbs.fold(dashu_int::IBig::ZERO, |sum, &limb| {
        (sum << 64) + dashu_int::IBig::from(limb)
    });
    if v.is_negative() { -big } else { big }
}

#[cfg(test)]
mod tests {
    use antumbra_testkit::random::Random;

    use super::{Nearness, Space3};

    #[test]
    fn nothing_of_an_occluder_is_beyond_its_bound() {
        let mut random = Random::new(7);
        let mut number = |size: i64| random.integer(-size, size);
        for round in 0..4_000 {
            // A plane through a point seen from the origin; some are seen nearly edge-on.
            let point: [i64; 3] = std::array::from_fn(|_| number(1 << 24));
            let mut normal: [i64; 3] = std::array::from_fn(|_| number(1 << 49));
            if round % 2 == 0 {
                let v: [i64; 3] = std::array::from_fn(|_| number(1 << 23));
                let m = |i: usize, j: usize| point[i] * v[j] - point[j] * v[i];
                normal = [m(1, 2) + number(1), m(2, 0), m(0, 1)];
            }
            let scale: i128 = (0..3)
                .map(|k| i128::from(normal[k]) * i128::from(point[k]))
                .sum();
            if scale == 0 {
                continue;
            }
            let sign = scale.signum();
            let mut space = Space3::new();
            let row = normal.map(|c| i128::from(c) * sign);
            let scale = scale.abs();
            let occluder = space.occluder(Nearness { row, scale }, 0);
            let ray = space.ray(point);
            let length = point.map(|c| (c as f64).powi(2)).iter().sum::<f64>().sqrt();
            let bound = space.farthest(occluder, &ray);
            assert!(bound >= length, "{bound} for {length}");
            if round % 2 == 1 {
                assert!(bound < length * 1.001, "{bound} for {length}");
            }
        }
    }
}
