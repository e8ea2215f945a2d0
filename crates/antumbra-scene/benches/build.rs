//! How long a scene takes to build, kD-tree included. Each benchmark checks its scene first.

// The group macro writes an undocumented function.
#![allow(missing_docs)]

use std::hint::black_box;
use std::time::Duration;

use antumbra_scene::{Faces, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};
use criterion::{Criterion, criterion_group, criterion_main};

/// Layers of 20 x 20 quads, each an object of its own: `layers * 400` disjoint quads.
fn walls(layers: u32) -> SceneInput {
    let mut objects = Vec::new();
    for layer in 0..layers {
        for cell in 0..400 {
            let (x, z) = (f64::from(cell % 20) * 2.1, f64::from(cell / 20) * 2.1);
            let y = f64::from(layer) * 0.5;
            let vertices = vec![
                [x, y, z],
                [x + 2.02, y, z],
                [x + 2.02, y, z + 2.02],
                [x, y, z + 2.02],
            ];
            let mut faces = Faces::with_capacity(1, 4);
            faces.push(&[0, 1, 2, 3]);
            objects.push(ObjectInput {
                name: None,
                parts: vec![PartInput {
                    vertices,
                    faces,
                    ..PartInput::default()
                }],
            });
        }
    }
    SceneInput {
        objects,
        source_name: "walls".into(),
    }
}

/// A building of rooms: finely triangulated slabs and walls, and round tables that no merging
/// helps; about 40,000 triangles.
fn building() -> SceneInput {
    let mut objects = Vec::new();
    for floor in 0..5 {
        for room in 0..20 {
            let corner = [
                f64::from(room % 5) * 4.3,
                f64::from(room / 5) * 5.1,
                f64::from(floor) * 3.2,
            ];
            objects.push(object(sheet(corner, [4.3, 0.0, 0.0], [0.0, 5.1, 0.0], 8)));
            objects.push(object(sheet(corner, [4.3, 0.0, 0.0], [0.0, 0.0, 3.2], 8)));
            objects.push(object(sheet(corner, [0.0, 5.1, 0.0], [0.0, 0.0, 3.2], 8)));
            objects.push(object(bowl([
                corner[0] + 2.0,
                corner[1] + 2.5,
                corner[2] + 0.7,
            ])));
        }
    }
    SceneInput {
        objects,
        source_name: "building".into(),
    }
}

fn object(part: PartInput) -> ObjectInput {
    ObjectInput {
        name: None,
        parts: vec![part],
    }
}

fn sheet(corner: [f64; 3], u: [f64; 3], v: [f64; 3], n: u32) -> PartInput {
    let at = |i: u32, j: u32| {
        let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
        std::array::from_fn(|k| corner[k] + s * u[k] + t * v[k])
    };
    grid_mesh(n, at)
}

fn bowl(center: [f64; 3]) -> PartInput {
    grid_mesh(5, |i, j| {
        let (x, y) = (f64::from(i) / 5.0 - 0.5, f64::from(j) / 5.0 - 0.5);
        [center[0] + x, center[1] + y, center[2] + x * x + y * y]
    })
}

fn grid_mesh(n: u32, at: impl Fn(u32, u32) -> [f64; 3]) -> PartInput {
    let vertices = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i, j)))
        .map(|(i, j)| at(i, j))
        .collect();
    let mut faces = Faces::default();
    for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let here = j * (n + 1) + i;
        faces.push(&[here, here + 1, here + n + 2]);
        faces.push(&[here, here + n + 2, here + n + 1]);
    }
    PartInput {
        vertices,
        faces,
        ..PartInput::default()
    }
}

fn build(input: SceneInput) -> Scene {
    SceneBuilder::new(input).build().expect("a valid scene").0
}

fn scenes(c: &mut Criterion) {
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let mut group = c.benchmark_group("build, one thread");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(10));
    for (name, input) in [("400,000 quads", walls(1000)), ("building", building())] {
        let scene = build(input.clone());
        assert_eq!(scene.sanity_check(), Ok(()));
        group.bench_function(name, |b| {
            b.iter_batched(
                || input.clone(),
                |input| one.install(|| black_box(build(input))),
                criterion::BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, scenes);
criterion_main!(benches);
