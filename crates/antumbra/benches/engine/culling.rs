//! Culling the frames of measured walks: all 200 of each, from a fresh culler.

use antumbra::cull::{Camera, CullOptions, Culler};
use antumbra::scene::SceneBuilder;
use antumbra_io::read_scene;
use antumbra_testkit::environment::{data, skip};
use criterion::Criterion;

fn cameras(text: &str) -> Vec<Camera> {
    let lines = text.lines().filter(|l| !l.starts_with('#'));
    let camera = |line: &str| {
        let n: Vec<f64> = line
            .split_whitespace()
            .map(|w| w.parse().expect("a number"))
            .collect();
        let three = |i: usize| [n[i], n[i + 1], n[i + 2]];
        Camera::new(three(0), three(3), three(6), n[9], 16.0 / 9.0).expect("a camera")
    };
    lines.map(camera).collect()
}

/// The four walks, as fast and as tight as it gets.
pub(crate) fn walks(c: &mut Criterion) {
    for name in ["duplex", "delft_block", "kit_institute", "quake_e1m1"] {
        let folder = data().map(|d| d.join("walk"));
        let scene = folder
            .as_ref()
            .and_then(|d| read_scene(&d.join(format!("{name}.glb"))).ok());
        let path =
            folder.and_then(|d| std::fs::read_to_string(d.join(format!("{name}.path"))).ok());
        let (Some(input), Some(path)) = (scene, path) else {
            skip(&format!("walk/{name} is absent"));
            continue;
        };
        let (scene, _) = SceneBuilder::new(input).build().expect("a sound scene");
        let cameras = cameras(&path);
        let called = |options: CullOptions| {
            let mut culler = Culler::with_options(&scene, options);
            let seen = |c: &Camera| culler.cull(c).objects().len();
            cameras.iter().map(seen).sum::<usize>()
        };
        let (fast, tight) = (called(CullOptions::default()), called(CullOptions::tight()));
        assert!(
            0 < tight && tight <= fast,
            "{name}: tight {tight}, fast {fast}"
        );
        assert!(
            fast * 4 < cameras.len() * scene.objects().len(),
            "{name}: {fast}"
        );
        let mut group = c.benchmark_group("culling, 200 frames");
        let mut culler = Culler::new(&scene);
        group.bench_function(name, |b| {
            b.iter(|| {
                cameras
                    .iter()
                    .map(|c| culler.cull(c).objects().len())
                    .sum::<usize>()
            });
        });
        group.finish();
    }
}
