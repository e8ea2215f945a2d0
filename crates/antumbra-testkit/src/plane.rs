//! Coplanar polygons: their convex hull, and whether some of them cover another without a gap.

use dashu_int::IBig;

use crate::determinant::sign;
use crate::rational::RationalPoint;
use crate::scene::clip;
use crate::segment::normal;

/// Whether the union of closed polygons, all in the plane of `polygon`, covers it. Exact.
#[must_use]
pub fn covers(cover: &[&[[i64; 3]]], polygon: &[[i64; 3]]) -> bool {
    let whole = polygon
        .iter()
        .map(|c| RationalPoint::from_grid(*c))
        .collect();
    let mut uncovered: Vec<Vec<RationalPoint>> = vec![whole];
    for piece in cover {
        uncovered = uncovered
            .iter()
            .flat_map(|rest| subtract(rest, piece))
            .collect();
    }
    // What is left has interior points, or it was dropped.
    uncovered.is_empty()
}

/// The parts of a convex polygon outside of another in its plane; parts without area are dropped.
fn subtract(polygon: &[RationalPoint], other: &[[i64; 3]]) -> Vec<Vec<RationalPoint>> {
    let n = normal(other);
    let mut rest = polygon.to_vec();
    let mut parts = Vec::new();
    for i in 0..other.len() {
        let (a, b) = (other[i], other[(i + 1) % other.len()]);
        let edge: [IBig; 3] = std::array::from_fn(|k| IBig::from(b[k]) - IBig::from(a[k]));
        let inward: [IBig; 3] = std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            &n[i] * &edge[j] - &n[j] * &edge[i]
        });
        let value = |p: &RationalPoint| -> IBig {
            let along = |k: usize| &inward[k] * (&p.numerators()[k] - p.denominator() * a[k]);
            along(0) + along(1) + along(2)
        };
        let outside = clip(&rest, |p| -value(p));
        if outside.iter().any(|p| sign(&value(p)) != 0) {
            parts.push(outside);
        }
        rest = clip(&rest, value);
        if rest.is_empty() {
            break;
        }
    }
    parts
}

/// The convex hull of coplanar grid points, without collinear corners; `None` if they are collinear.
#[must_use]
pub fn hull(points: &[[i64; 3]]) -> Option<Vec<[i64; 3]>> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    // Drop one axis in which the plane is not seen edge-on.
    (0..3).find_map(|dropped| {
        let flat = |p: [i64; 3]| [p[(dropped + 1) % 3], p[(dropped + 2) % 3]];
        let turn = |a: [i64; 3], b: [i64; 3], c: [i64; 3]| {
            let ([ax, ay], [bx, by], [cx, cy]) = (flat(a), flat(b), flat(c));
            i128::from(bx - ax) * i128::from(cy - ay) - i128::from(by - ay) * i128::from(cx - ax)
        };
        let mut order = sorted.clone();
        order.sort_by_key(|p| flat(*p));
        let mut chain: Vec<[i64; 3]> = Vec::new();
        for pass in 0..2 {
            let start = chain.len();
            for p in &order {
                while chain.len() >= start + 2
                    && turn(chain[chain.len() - 2], chain[chain.len() - 1], *p) <= 0
                {
                    chain.pop();
                }
                chain.push(*p);
            }
            chain.pop();
            if pass == 0 {
                order.reverse();
            }
        }
        (chain.len() >= 3).then_some(chain)
    })
}

#[cfg(test)]
mod tests {
    use super::{covers, hull};

    fn rectangle(x: [i64; 2], y: [i64; 2]) -> Vec<[i64; 3]> {
        // In the slanted plane z = x + y.
        let p = |x, y| [x, y, x + y];
        vec![p(x[0], y[0]), p(x[1], y[0]), p(x[1], y[1]), p(x[0], y[1])]
    }

    #[test]
    fn covers_are_exact_to_the_last_unit() {
        let whole = rectangle([0, 10], [0, 10]);
        let (left, right) = (rectangle([-1, 5], [0, 10]), rectangle([5, 10], [0, 11]));
        assert!(covers(&[&left, &right], &whole));
        assert!(!covers(&[&left], &whole));
        let short = rectangle([6, 10], [0, 11]);
        assert!(!covers(&[&left, &short], &whole));
        let overlapping = rectangle([2, 10], [0, 9]);
        assert!(!covers(&[&left, &overlapping], &whole));
        assert!(covers(&[&left, &overlapping, &right], &whole));
    }

    #[test]
    fn hulls_have_corners_only() {
        let mut points = rectangle([0, 4], [0, 4]);
        points.extend(rectangle([1, 2], [0, 3]));
        let found = hull(&points).expect("not collinear");
        assert_eq!(found.len(), 4);
        assert!(found.iter().all(|p| rectangle([0, 4], [0, 4]).contains(p)));
        assert_eq!(hull(&[[0, 0, 0], [1, 1, 1], [2, 2, 2]]), None);
        assert_eq!(
            hull(&[[0, 5, 0], [0, 5, 1], [2, 5, 2]]).map(|h| h.len()),
            Some(3)
        );
    }
}
