//! Equilateral triangles, randomly placed and turned, in front of a square source.

use std::f64::consts::TAU;

use super::{SOURCE, SplitMix64, shape};
use crate::{Faces, ObjectInput, PartInput, SceneInput};

/// Half the side of the cube that holds all triangles, in metres.
const HALF_BOX: f64 = 50.0;
/// Distance of the source from that cube, in metres.
const GAP: f64 = 10.0;

/// The parameters of [`random_triangles`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleParams {
    /// How many triangles.
    pub count: u32,
    /// The area of each triangle in square metres; at most 5000, so that it fits the box.
    pub area: f64,
    /// The area of the source in square metres.
    pub source_area: f64,
    /// What chance depends on.
    pub seed: u64,
}

/// Random triangles: tests R1 to R9 of \[Bittner02, 8.14.1\].
///
/// The triangles `t0`, `t1`, ... are equilateral, uniformly turned, and lie in the cube
/// `[-50, 50]^3`: their centers are uniform in what the triangles' circumradius leaves of it. The
/// object [`SOURCE`] comes last: a square at `x = -60` that faces `+x`, centered on the `x` axis, so
/// that no triangle crosses its plane. The thesis states neither the cube nor the distance, so its
/// Table 8.1 is rebuilt in kind, not to the digit. Visible from a source of 2 square metres, seed 1:
///
/// | triangles | area of each | here | Table 8.1 |
/// |---|---|---|---|
/// | 100 | 200 | 99 | 98 |
/// | 1000 | 200 | 211 | 268 |
/// | 10000 | 200 | 708 | 539 |
/// | 1000 | 50 | 755 | 761 |
/// | 1000 | 12.5 | 990 | 995 |
///
/// # Panics
/// Never; areas that are not positive give degenerate triangles, which the builder reports.
#[must_use]
pub fn random_triangles(params: &TriangleParams) -> SceneInput {
    let mut rng = SplitMix64::new(params.seed);
    let radius = (4.0 * params.area / (3.0 * 3.0_f64.sqrt())).sqrt();
    let reach = (HALF_BOX - radius).max(0.0);
    let mut objects: Vec<ObjectInput> = (0..params.count)
        .map(|i| {
            let center = [0; 3].map(|_| rng.range(-reach, reach));
            triangle(&format!("t{i}"), center, radius, &mut rng)
        })
        .collect();
    let half = params.source_area.sqrt() / 2.0;
    objects.push(shape::square_facing_x(
        SOURCE,
        -HALF_BOX - GAP,
        [0.0, 0.0],
        half,
    ));
    SceneInput {
        objects,
        source_name: format!(
            "random-triangles --count {} --area {} --source-area {} --seed {}",
            params.count, params.area, params.source_area, params.seed
        ),
    }
}

/// One equilateral triangle with a uniformly random orientation.
fn triangle(name: &str, center: [f64; 3], radius: f64, rng: &mut SplitMix64) -> ObjectInput {
    // A uniform normal by Archimedes (uniform in z and longitude), then a uniform turn about it.
    let z = rng.range(-1.0, 1.0);
    let (sin, cos) = rng.range(0.0, TAU).sin_cos();
    let flat = (1.0 - z * z).sqrt();
    let u = [-sin, cos, 0.0];
    let v = [-z * cos, -z * sin, flat];
    let turn = rng.range(0.0, TAU);
    let vertices = (0..3)
        .map(|k| {
            let (s, c) = (turn + TAU * f64::from(k) / 3.0).sin_cos();
            std::array::from_fn(|i| center[i] + radius * (c * u[i] + s * v[i]))
        })
        .collect();
    ObjectInput {
        name: Some(name.to_owned()),
        parts: vec![PartInput {
            class: Some("triangle".to_owned()),
            translucent: false,
            vertices,
            faces: Faces::from_iter([[0, 1, 2]]),
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::{TriangleParams, random_triangles};

    const R1: TriangleParams = TriangleParams {
        count: 100,
        area: 200.0,
        source_area: 2.0,
        seed: 1,
    };

    #[test]
    fn areas_and_counts_are_as_asked() {
        let scene = random_triangles(&R1);
        assert_eq!(scene.objects.len(), 101);
        for object in &scene.objects[..100] {
            let [a, b, c] = object.parts[0].vertices[..] else {
                panic!("a triangle")
            };
            let u: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let v: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
            let n = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            let area = n.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0;
            assert!((area - 200.0).abs() < 1e-9);
            assert!([a, b, c].iter().flatten().all(|x| x.abs() <= 50.0 + 1e-9));
        }
        let source = &scene.objects[100];
        assert_eq!(source.name.as_deref(), Some("source"));
        assert!(source.parts[0].vertices.iter().all(|p| p[0] == -60.0));
    }

    #[test]
    fn the_seed_decides_everything() {
        assert_eq!(random_triangles(&R1), random_triangles(&R1));
        let other = random_triangles(&TriangleParams { seed: 2, ..R1 });
        assert_ne!(other.objects[0], random_triangles(&R1).objects[0]);
    }

    #[test]
    fn orientations_are_spread_evenly() {
        let scene = random_triangles(&TriangleParams { count: 3000, ..R1 });
        // The mean of |n . axis| over the sphere is one half for every axis.
        for axis in 0..3 {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let mean = scene.objects[..3000]
                .iter()
                .map(|o| {
                    let p = &o.parts[0].vertices;
                    let (a, b) = ((p[1][i] - p[0][i]), (p[1][j] - p[0][j]));
                    let (c, d) = ((p[2][i] - p[0][i]), (p[2][j] - p[0][j]));
                    (a * d - b * c).abs() / 400.0
                })
                .sum::<f64>()
                / 3000.0;
            assert!((mean - 0.5).abs() < 0.03, "axis {axis}: {mean}");
        }
    }
}
