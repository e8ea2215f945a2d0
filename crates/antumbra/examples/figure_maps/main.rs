//! Rebuilds Table 5.1 and Figure 5.6 of [Bittner02] on generated scenes: nine views, and the growth
//! of an occlusion tree. Prints the table and writes the curve.
#![allow(clippy::print_stdout, reason = "prints a table")]

mod curve;

use std::time::Instant;

use antumbra::map::occlusion::{
    PointView, SweepOptions, Twins, front_to_back, sweep, sweep_in_order,
};
use antumbra::map::{FaceKind, MapOptions, Mapper, Viewpoint};
use antumbra::scene::synth::{MazeParams, TriangleParams, floor, maze, random_triangles};
use antumbra::scene::{KdNode, Scene, SceneBuilder, SceneInput};

/// Times are medians of this many runs.
const RUNS: usize = 15;
const REACH: f64 = 250.0;

fn main() -> std::io::Result<()> {
    let rooms = built(maze(&MazeParams {
        rooms: 12,
        furniture: 9,
        seed: 1,
    }));
    let storey = built(floor(1).scene);
    let cloud = built(random_triangles(&TriangleParams {
        count: 10_000,
        area: 12.5,
        source_area: 200.0,
        seed: 1,
    }));
    println!(
        "| scene | polygons | kD nodes | view | total ms | tree ms | vertices | edges | faces | culled |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (name, scene, eyes) in [
        (
            "maze",
            &rooms,
            [[33.1, 33.2, 1.6], [3.1, 3.2, 1.6], [57.1, 45.2, 1.6]],
        ),
        (
            "floor",
            &storey,
            [[2.1, 3.7, 1.6], [10.1, 0.3, 1.6], [10.0, -20.0, 8.0]],
        ),
        (
            "random",
            &cloud,
            [[1.0, 2.0, 30.0], [-45.0, 30.0, 20.0], [-120.0, 30.0, 20.0]],
        ),
    ] {
        for (eye, view) in eyes.into_iter().zip(["I", "II", "III"]) {
            row(name, scene, view, eye);
        }
    }
    let path = "docs/figures/tree-growth.svg";
    std::fs::create_dir_all("docs/figures")?;
    let eye = [2.1, 3.7, 1.6];
    std::fs::write(path, curve::svg(&growth(&storey, eye)))?;
    println!("\n{path}");
    Ok(())
}

fn built(input: SceneInput) -> Scene {
    let (scene, _) = SceneBuilder::new(input)
        .cells_box(Some(([-REACH; 3], [REACH; 3])))
        .build()
        .expect("a generated scene is sound");
    scene
}

fn row(name: &str, scene: &Scene, view: &str, eye: [f64; 3]) {
    let mapper = Mapper::new(scene);
    let twins = Twins::of_scene(scene);
    let at = scene.grid().snap(eye).expect("the grid was made for it");
    let make = || {
        mapper
            .map(&Viewpoint::Sphere(eye), &MapOptions::default())
            .expect("a view")
    };
    let total = median(|| drop(make()));
    let tree = median(|| {
        drop(sweep(
            scene,
            &twins,
            PointView::sphere(at),
            &SweepOptions::default(),
        ));
    });
    let map = make();
    let work = map.work().sweep;
    let faces = map
        .faces()
        .iter()
        .filter(|f| matches!(f.kind, FaceKind::Polygon(_)));
    println!(
        "| {name} | {} | {} | {view} | {total:.1} | {tree:.1} | {} | {} | {} | {:.1} % |",
        scene.polygons().count(),
        scene.kd().nodes().len(),
        map.vertices().len(),
        map.edges().len(),
        faces.count(),
        100.0 * (1.0 - work.leaves_opened as f64 / leaves(scene) as f64)
    );
}

fn leaves(scene: &Scene) -> usize {
    let all = scene.kd().nodes().iter();
    all.filter(|n| matches!(n, KdNode::Leaf { .. })).count()
}

/// The median time of a job in milliseconds.
fn median(mut job: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            job();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

/// The size of the tree after some numbers of polygons, swept without tests of boxes.
fn growth(scene: &Scene, eye: [f64; 3]) -> Vec<(usize, usize)> {
    let at = scene.grid().snap(eye).expect("the grid was made for it");
    let order = front_to_back(scene, &PointView::sphere(at));
    let step = order.len().div_ceil(200);
    (0..=order.len())
        .step_by(step)
        .map(|n| {
            let swept = sweep_in_order(scene, PointView::sphere(at), &order[..n]);
            (n, swept.tree.nodes().len())
        })
        .collect()
}
