//! The little float vector arithmetic that pictures need.

pub(super) type V3 = [f64; 3];

pub(super) fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: V3, b: V3) -> V3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The vector of length one in a direction; zero stays zero.
pub(super) fn unit(a: V3) -> V3 {
    let length = dot(a, a).sqrt();
    if length > 0.0 {
        a.map(|c| c / length)
    } else {
        a
    }
}

/// The point between two points at a fraction of the way.
pub(super) fn lerp(a: V3, b: V3, t: f64) -> V3 {
    std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
}

/// Twice the area of a polygon, as a vector along its normal.
pub(super) fn area_vector(corners: &[V3]) -> V3 {
    let mut sum = [0.0; 3];
    for pair in corners[1..].windows(2) {
        let n = cross(sub(pair[0], corners[0]), sub(pair[1], corners[0]));
        sum = std::array::from_fn(|k| sum[k] + n[k]);
    }
    sum
}

/// The part of a convex polygon where `side` is not negative; `side` must be affine.
pub(super) fn clip(corners: &[V3], side: impl Fn(V3) -> f64) -> Vec<V3> {
    let mut out = Vec::with_capacity(corners.len() + 1);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (sa, sb) = (side(a), side(b));
        if sa >= 0.0 {
            out.push(a);
        }
        if (sa > 0.0 && sb < 0.0) || (sa < 0.0 && sb > 0.0) {
            out.push(lerp(a, b, sa / (sa - sb)));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{area_vector, clip};

    #[test]
    fn half_a_square() {
        let square = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        assert_eq!(area_vector(&square), [0.0, 0.0, 8.0]);
        let half = clip(&square, |p| 1.0 - p[0]);
        assert_eq!(half.len(), 4);
        assert_eq!(area_vector(&half), [0.0, 0.0, 4.0]);
        assert!(clip(&square, |_| -1.0).is_empty());
    }
}
