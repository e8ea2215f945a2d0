//! How wrong a sign can be, and which way it then counts.
//!
//! All vectors are relative to the eye, in grid steps. The eye is rounded once to a multiple of
//! 2^-20 steps (see [`snap_eye`]), so that `corner - eye` and the differences of two such vectors
//! are exact doubles: multiples of 2^-20 below 2^33 have 53 bits. With `u = 2^-53` and `|v|` the sum
//! of the absolute values:
//!
//! * **A plane through the eye** and the ends `a`, `b` of an edge has the normal `a x b`. Each
//!   component is a difference of two rounded products: off by at most `3u |a||b|`. Divided by
//!   `|a||b|` ([`plane_through_eye`]) it is below 1 and off by at most `3u + 2u` of rounding: `2^-50`.
//! * **A side** `n . p` adds three rounded products and two rounded sums, `3u |p|`. Together at most
//!   `2^-50 |p| + 2^-51 |p| < 2^-49 |p|`.
//! * **A cut** `x = a + t (b - a)` is rounded by at most `4u max(|a|,|b|)`, wherever it lies between
//!   them. Vertices keep the largest `|.|` of what they come from, so after 128 cuts one behind the
//!   other a vertex is off by less than `128 * 2^-51 max = 2^-44 max`. No way through a tree is
//!   longer: nothing is taken deeper than [`MAX_DEPTH`] = 96 nodes, below which hang at most 24 edges.
//!
//! So [`TAU`]` = 2^-43`, twice as much, times that number is a *doubtful* zone which no wrong sign can leave: a value
//! beyond it has the sign of the exact value, for the exact plane and every point within the
//! rounding of a vertex. What is doubtful counts
//!
//! * for an **occluder** as not covered: its fragments only ever shrink, its borders are kept
//!   ([`super::tree`]);
//! * for **what is tested** as there: boxes and fragments grow by the zone and go to both sides.
//!
//! * **The plane of an occluder** does not go through the eye: `n . x - d` with a unit normal
//!   rounded by `4u` a component and `d = n . c` for a corner `c`. Off by at most
//!   `(4u + 3u)(|x| + |c|) + 2u (|x| + |c|) < 2^-49 (|x| + |c|)`; [`TAU`] covers it too.

/// Share of a vector's size within which a side is doubtful.
pub(super) const TAU: f64 = 1.0 / (1_u64 << 43) as f64;

/// The deepest way through an occlusion tree.
pub(super) const MAX_DEPTH: usize = 96;

/// The farthest eye, in grid steps, whose differences with corners are exact.
const FARTHEST: f64 = (1_u64 << 32) as f64;

/// The eye on multiples of 2^-20 grid steps; none if it is so far away (256 times the reach of the
/// grid) that differences would be rounded.
pub(super) fn snap_eye(eye: [f64; 3]) -> Option<[f64; 3]> {
    const FINE: f64 = (1 << 20) as f64;
    let near = eye.iter().all(|c| c.abs() < FARTHEST);
    near.then(|| eye.map(|c| (c * FINE).round() / FINE))
}

#[inline]
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The sum of the absolute values.
#[inline]
pub(super) fn size(v: [f64; 3]) -> f64 {
    v[0].abs() + v[1].abs() + v[2].abs()
}

#[inline]
pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The plane through the eye and two points, scaled so that [`TAU`] bounds its sides.
#[inline]
pub(super) fn plane_through_eye(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let scale = 1.0 / (size(a) * size(b));
    super::camera::cross(a, b).map(|c| c * scale)
}

/// Whether a point lies on the line through two others. Exact for points that are differences of
/// grid points with one snapped eye: their differences are integers below 2^25, products below 2^50.
pub(super) fn on_line(p: [f64; 3], a: [f64; 3], b: [f64; 3]) -> bool {
    super::camera::cross(sub(p, a), sub(b, a)) == [0.0; 3]
}

/// The exact components of a normal below 2^51 in a high and a low part: `n = high * 2^26 + low`.
pub(super) fn parts(normal: [i64; 3]) -> [[f64; 3]; 2] {
    [
        normal.map(|n| (n >> 26) as f64),
        normal.map(|n| (n & ((1 << 26) - 1)) as f64),
    ]
}

/// Whether a difference of grid points is orthogonal to a normal given in parts. Exact: differences
/// are integers of at most 2^24, so the three products of each part and their sums are below 2^53; the
/// rounded sum of two doubles is zero only if the exact one is.
pub(super) fn on_plane(difference: [f64; 3], [high, low]: [[f64; 3]; 2]) -> bool {
    dot(high, difference) * ((1 << 26) as f64) + dot(low, difference) == 0.0
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{Point, cross, sub as difference};
    use proptest::prelude::*;

    use super::{TAU, dot, on_line, on_plane, parts, plane_through_eye, size, snap_eye, sub};

    fn point() -> impl Strategy<Value = Point> {
        let far = -(1 << 23) + 1..(1 << 23);
        let near = -3..4;
        let coordinate = move || prop_oneof![far.clone(), near.clone()];
        (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Point::new(x, y, z))
    }

    proptest! {
        /// The sign of a side against exact integers: eyes are multiples of 2^-20, so that 2^20 times
        /// everything has 45 bits, and the determinant 138.
        #[test]
        fn a_side_beyond_the_zone_has_the_exact_sign(
            [a, b, p] in prop::array::uniform3(point()),
            eye in prop::array::uniform3(-1.0e7..1.0e7),
        ) {
            use dashu_int::IBig;
            let eye = snap_eye(eye).expect("near");
            let rel = [a, b, p].map(|q| sub(q.to_f64(), eye));
            let d = dot(plane_through_eye(rel[0], rel[1]), rel[2]);
            let fine = rel.map(|v| v.map(|c| IBig::from((c * f64::from(1 << 20)) as i64)));
            let minor = |i: usize, j: usize| &fine[0][i] * &fine[1][j] - &fine[0][j] * &fine[1][i];
            let exact = minor(1, 2) * &fine[2][0] + minor(2, 0) * &fine[2][1] + minor(0, 1) * &fine[2][2];
            // A sixteenth of the zone is far more than the bound needs.
            if d.abs() > TAU / 16.0 * size(rel[2]) {
                prop_assert_eq!(d > 0.0, exact > IBig::ZERO);
            }
        }

        #[test]
        fn incidence_is_exact([a, b, c, p] in prop::array::uniform4(point()), eye in prop::array::uniform3(-1.0e7..1.0e7), t in -2..3) {
            let eye = snap_eye(eye).expect("near");
            let rel = |q: Point| sub(q.to_f64(), eye);
            let normal = cross(difference(b, a), difference(c, a));
            let exact = |q: Point| {
                let d = difference(q, a);
                (0..3).map(|k| i128::from(normal[k]) * i128::from(d[k])).sum::<i128>() == 0
            };
            if normal != [0; 3] && normal.iter().all(|n| n.abs() < 1 << 51) {
                for q in [a, b, c, p] {
                    let d = sub(rel(q), rel(a));
                    if d.iter().all(|c| c.abs() <= f64::from(1 << 24)) {
                        prop_assert_eq!(on_plane(d, parts(normal)), exact(q));
                    }
                }
            }
            prop_assert_eq!(on_line(rel(p), rel(a), rel(b)), cross(difference(p, a), difference(b, a)) == [0; 3]);
            let step = difference(b, a);
            let q = [a.x, a.y, a.z].map(i64::from);
            let q: [i64; 3] = std::array::from_fn(|k| q[k] + i64::from(t) * step[k]);
            let q = sub(q.map(|c| c as f64), eye);
            prop_assert!(on_line(q, rel(a), rel(b)));
        }
    }
}
