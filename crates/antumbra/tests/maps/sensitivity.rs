//! Output sensitivity: what lies beyond the walls of a closed room costs next to nothing.

use antumbra::map::occlusion::{SweepOrder, SweepWork};
use antumbra::map::{MapOptions, MapWork, Mapper, Viewpoint};
use antumbra::scene::{Scene, SceneBuilder, SceneInput};
use antumbra_testkit::environment::{data, skip};

/// Copies of a building in a square, the one in the middle in its own place.
fn replicated(input: &SceneInput, n: i32, pitch: f64) -> Scene {
    let mut objects = Vec::new();
    for i in 0..n * n {
        let place = [i % n - n / 2, i / n - n / 2].map(|c| f64::from(c) * pitch);
        objects.extend(input.objects.iter().cloned().map(|mut object| {
            for v in object.parts.iter_mut().flat_map(|p| &mut p.vertices) {
                v[0] += place[0];
                v[1] += place[1];
            }
            object
        }));
    }
    let source_name = input.source_name.clone();
    let input = SceneInput {
        objects,
        source_name,
    };
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0 / 16384.0))
        .build()
        .expect("a scene");
    scene
}

#[test]
fn replicas_beyond_the_walls_of_a_room_add_little_work() {
    let path = data().map(|d| d.join("walk/duplex.glb"));
    let Some(input) = path.and_then(|p| antumbra_io::read_scene(&p).ok()) else {
        skip("duplex.glb is not at hand");
        return;
    };
    let eye = [1.9016, 6.026, 6.75];
    for order in [SweepOrder::DepthFirst, SweepOrder::Priority] {
        let mut options = MapOptions::default();
        options.sweep.order = order;
        let map = |n: i32| {
            let scene = replicated(&input, n, 40.0);
            let map = Mapper::new(&scene)
                .map(&Viewpoint::Sphere(eye), &options)
                .expect("a view");
            let seen: f64 = map.object_measures(&scene).iter().map(|m| m.1).sum();
            assert!(seen > 4.0 * std::f64::consts::PI - 1e-9, "a closed room");
            (map.faces().len(), *map.work())
        };
        // What a sweep spends its time on.
        let tests = |w: &MapWork| w.sweep.nodes_tested;
        let inserts = |w: &MapWork| w.sweep.polygons + w.tree_nodes as u64;
        let (faces, alone) = map(1);
        for n in [3, 5] {
            let (among, work) = map(n);
            assert_eq!(faces, among);
            let seen = format!("{order:?}, {n}: {work:?}, alone {alone:?}");
            assert!(10 * inserts(&work) < 11 * inserts(&alone), "{seen}");
            assert!(10 * tests(&work) < 11 * tests(&alone), "{seen}");
            let SweepWork {
                leaves,
                leaves_opened,
                ..
            } = work.sweep;
            assert!(100 * leaves_opened < leaves, "99 % are culled: {work:?}");
        }
    }
}
