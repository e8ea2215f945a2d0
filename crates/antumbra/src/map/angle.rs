//! Solid angles and areas of convex cones, from exactly named rays: the only rounding is here.

/// The solid angle of a convex cone, in steradians, from its rays in either order: a fan of
/// triangles, each by its half-angle formula, so that thin ones lose nothing.
pub(super) fn solid_angle(rays: &[[f64; 3]]) -> f64 {
    let Some((first, rest)) = rays.split_first() else {
        return 0.0;
    };
    let a = unit(*first);
    let fan = rest.windows(2).map(|w| triangle(a, unit(w[0]), unit(w[1])));
    fan.sum::<f64>().abs()
}

fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    let volume = dot(a, cross(minus(b, a), minus(c, a)));
    2.0 * volume.atan2(1.0 + dot(a, b) + dot(b, c) + dot(c, a))
}

/// The area of a convex polygon of rays (x, y, 1).
pub(super) fn flat_area(rays: &[[f64; 3]]) -> f64 {
    let at = |r: &[f64; 3]| [r[0] / r[2], r[1] / r[2]];
    let Some((first, rest)) = rays.split_first() else {
        return 0.0;
    };
    let a = at(first);
    let double: f64 = rest
        .windows(2)
        .map(|w| {
            let (b, c) = (at(&w[0]), at(&w[1]));
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        })
        .sum();
    double.abs() / 2.0
}

pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    // Components may be as large as 2^323: scale first, so that squares stay finite.
    let largest = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    let v = v.map(|c| c / largest);
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::{flat_area, solid_angle};

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let octant = [[1e90, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
        let expected = std::f64::consts::FRAC_PI_2;
        assert!((solid_angle(&octant) - expected).abs() < 1e-15);
        // A face of a cube is a sixth, whichever way it turns.
        let mut face = [
            [1.0, 1.0, 1.0],
            [-1.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
            [1.0, -1.0, 1.0],
        ];
        let sixth = 4.0 * std::f64::consts::PI / 6.0;
        assert!((solid_angle(&face) - sixth).abs() < 1e-15);
        face.reverse();
        assert!((solid_angle(&face) - sixth).abs() < 1e-15);
        assert_eq!(flat_area(&face), 4.0);
    }
}
