//! Where a segment meets a convex polygon, decided from first principles over big rationals.

use dashu_int::IBig;

use crate::determinant::sign;
use crate::rational::{Fraction, RationalPoint};

/// How a closed segment meets a closed convex polygon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Contact {
    /// They share no point.
    Miss,
    /// They share a point but do not cross: the segment meets the border, ends on the polygon, or
    /// runs in its plane. `t` is the first shared point, from 0 at the start to 1 at the end.
    Touch {
        /// Where, as a fraction of the segment.
        t: Fraction,
    },
    /// The open segment crosses the relative interior of the polygon from one side to the other.
    Cross {
        /// Where, as a fraction of the segment.
        t: Fraction,
    },
}

/// A vector normal to a planar polygon by the right-hand rule: the sum of its fan triangles'
/// normals, so that collinear corners do no harm. Zero only if all corners are collinear.
#[must_use]
pub fn normal(polygon: &[[i64; 3]]) -> [IBig; 3] {
    let mut sum = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
    for pair in polygon.get(1..).unwrap_or_default().windows(2) {
        let (u, v) = (
            difference(pair[0], polygon[0]),
            difference(pair[1], polygon[0]),
        );
        for (k, c) in cross(&u, &v).into_iter().enumerate() {
            sum[k] += c;
        }
    }
    sum
}

/// On which side of a polygon's plane a point lies, as a number of that sign.
#[must_use]
pub fn height(polygon: &[[i64; 3]], point: &RationalPoint) -> IBig {
    distance_from(&normal(polygon), polygon[0], point)
}

/// How the closed segment between two distinct points meets a convex planar polygon.
///
/// # Panics
/// If the polygon has fewer than three corners.
#[must_use]
pub fn contact(from: &RationalPoint, to: &RationalPoint, polygon: &[[i64; 3]]) -> Contact {
    assert!(
        polygon.len() >= 3,
        "a polygon with {} corners",
        polygon.len()
    );
    let n = normal(polygon);
    let (start, end) = (
        distance_from(&n, polygon[0], from),
        distance_from(&n, polygon[0], to),
    );
    match (sign(&start), sign(&end)) {
        (0, 0) => contact_in_plane(from, to, polygon, &n),
        (a, b) if a == b => Contact::Miss,
        (a, b) => {
            // Heights are scaled by the denominators: h = start / denominator. The plane is met at
            // t = h0 / (h0 - h1), in the point (h0 to - h1 from) / (h0 - h1).
            let bottom = &start * to.denominator() - &end * from.denominator();
            let t = Fraction::new(&start * to.denominator(), bottom.clone());
            let at = |k: usize| &start * &to.numerators()[k] - &end * &from.numerators()[k];
            let x = RationalPoint::new([at(0), at(1), at(2)], bottom);
            let inside = edge_signs(&x, polygon, &n);
            match inside.iter().min() {
                Some(-1) | None => Contact::Miss,
                Some(0) => Contact::Touch { t },
                Some(_) if a == 0 || b == 0 => Contact::Touch { t },
                Some(_) => Contact::Cross { t },
            }
        }
    }
}

/// Whether a point of the polygon's plane lies in the polygon's relative interior.
#[must_use]
pub fn strictly_inside(point: &RationalPoint, polygon: &[[i64; 3]]) -> bool {
    edge_signs(point, polygon, &normal(polygon))
        .iter()
        .all(|s| *s > 0)
}

/// For each edge, whether a point of the plane lies inside of it (1), on its line (0), or outside.
fn edge_signs(point: &RationalPoint, polygon: &[[i64; 3]], n: &[IBig; 3]) -> Vec<i8> {
    edges(polygon)
        .map(|(a, b)| sign(&distance_from(&inward(a, b, n), a, point)))
        .collect()
}

/// Both ends in the plane: clip the segment by the half-plane of each edge.
fn contact_in_plane(
    from: &RationalPoint,
    to: &RationalPoint,
    polygon: &[[i64; 3]],
    n: &[IBig; 3],
) -> Contact {
    let (mut enter, mut leave) = (Fraction::from(0), Fraction::from(1));
    for (a, b) in edges(polygon) {
        let inner = inward(a, b, n);
        let start = distance_from(&inner, a, from) * to.denominator();
        let end = distance_from(&inner, a, to) * from.denominator();
        match (sign(&start), sign(&end)) {
            (-1, -1) => return Contact::Miss,
            (-1, _) => enter = enter.max(Fraction::new(start.clone(), start - end)),
            (_, -1) => leave = leave.min(Fraction::new(start.clone(), start - end)),
            _ => {}
        }
    }
    if enter <= leave {
        Contact::Touch { t: enter }
    } else {
        Contact::Miss
    }
}

fn edges(polygon: &[[i64; 3]]) -> impl Iterator<Item = ([i64; 3], [i64; 3])> {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// A vector in the polygon's plane that points from the edge inwards.
fn inward(a: [i64; 3], b: [i64; 3], n: &[IBig; 3]) -> [IBig; 3] {
    cross(n, &difference(b, a))
}

/// `direction . (point - origin)`, times the point's (positive) denominator.
fn distance_from(direction: &[IBig; 3], origin: [i64; 3], point: &RationalPoint) -> IBig {
    let along = |k: usize| {
        &direction[k] * (&point.numerators()[k] - point.denominator() * IBig::from(origin[k]))
    };
    along(0) + along(1) + along(2)
}

fn difference(a: [i64; 3], b: [i64; 3]) -> [IBig; 3] {
    std::array::from_fn(|k| IBig::from(a[k]) - IBig::from(b[k]))
}

fn cross(u: &[IBig; 3], v: &[IBig; 3]) -> [IBig; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &u[i] * &v[j] - &u[j] * &v[i]
    })
}

#[cfg(test)]
mod tests {
    use dashu_int::IBig;

    use super::{Contact, contact, normal, strictly_inside};
    use crate::points::Points;
    use crate::rational::{Fraction, RationalPoint};

    const SQUARE: [[i64; 3]; 4] = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]];

    fn meet(from: [i64; 3], to: [i64; 3]) -> Contact {
        contact(
            &RationalPoint::from_grid(from),
            &RationalPoint::from_grid(to),
            &SQUARE,
        )
    }

    fn fraction(n: i64, d: i64) -> Fraction {
        Fraction::new(IBig::from(n), IBig::from(d))
    }

    #[test]
    fn crossing_means_strictly_through_the_interior() {
        assert_eq!(
            meet([1, 1, -1], [1, 1, 2]),
            Contact::Cross { t: fraction(1, 3) }
        );
        assert_eq!(
            meet([1, 1, 2], [1, 1, -1]),
            Contact::Cross { t: fraction(2, 3) }
        );
        assert_eq!(
            meet([0, 1, -1], [0, 1, 1]),
            Contact::Touch { t: fraction(1, 2) }
        );
        assert_eq!(
            meet([4, 4, -1], [4, 4, 1]),
            Contact::Touch { t: fraction(1, 2) }
        );
        assert_eq!(meet([5, 1, -1], [5, 1, 1]), Contact::Miss);
    }

    #[test]
    fn ends_on_the_polygon_touch() {
        assert_eq!(
            meet([1, 1, 0], [1, 1, 5]),
            Contact::Touch {
                t: Fraction::from(0)
            }
        );
        assert_eq!(
            meet([1, 1, 5], [1, 1, 0]),
            Contact::Touch {
                t: Fraction::from(1)
            }
        );
        assert_eq!(meet([5, 5, 0], [5, 5, 5]), Contact::Miss);
        assert_eq!(meet([1, 1, 1], [1, 1, 5]), Contact::Miss);
    }

    #[test]
    fn segments_in_the_plane_touch_where_they_enter() {
        assert_eq!(
            meet([-4, 1, 0], [12, 1, 0]),
            Contact::Touch { t: fraction(1, 4) }
        );
        assert_eq!(
            meet([1, 1, 0], [2, 2, 0]),
            Contact::Touch {
                t: Fraction::from(0)
            }
        );
        assert_eq!(
            meet([-2, 2, 0], [2, -2, 0]),
            Contact::Touch { t: fraction(1, 2) }
        );
        assert_eq!(meet([-2, 1, 0], [1, -2, 0]), Contact::Miss);
        assert_eq!(meet([-3, 0, 0], [-1, 0, 0]), Contact::Miss);
        assert_eq!(
            meet([-3, 0, 0], [0, 0, 0]),
            Contact::Touch {
                t: Fraction::from(1)
            }
        );
        assert_eq!(meet([0, 5, 0], [4, 5, 0]), Contact::Miss);
    }

    #[test]
    fn the_point_it_names_is_on_the_polygon() {
        let mut points = Points::new(6);
        let mut crossed = 0;
        for _ in 0..2000 {
            let (from, to) = (points.coarse(), points.coarse());
            let triangle = [points.coarse(), points.coarse(), points.coarse()];
            if from == to || normal(&triangle).iter().all(|c| *c == IBig::ZERO) {
                continue;
            }
            let (from, to) = (RationalPoint::from_grid(from), RationalPoint::from_grid(to));
            if let Contact::Cross { t } = contact(&from, &to, &triangle) {
                crossed += 1;
                let weights = [t.denominator() - t.numerator(), t.numerator().clone()];
                let at = RationalPoint::mean(&[&from, &to], &weights);
                assert_eq!(super::height(&triangle, &at), IBig::ZERO);
                assert!(strictly_inside(&at, &triangle));
                let Contact::Cross { t: back } = contact(&to, &from, &triangle) else {
                    panic!("crossing depends on the direction");
                };
                assert_eq!(
                    back,
                    Fraction::new(&weights[0] * IBig::ONE, t.denominator().clone())
                );
            }
        }
        assert!(crossed > 50, "only {crossed} crossings");
    }
}
