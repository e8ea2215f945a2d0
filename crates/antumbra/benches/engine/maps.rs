//! Visibility maps of real buildings and of crossing triangles, over the whole sphere.

use antumbra::map::{MapOptions, Mapper, Viewpoint};
use antumbra::scene::synth::{TriangleParams, random_triangles};
use antumbra::scene::{Scene, SceneBuilder, SceneInput};
use antumbra_io::read_scene;
use antumbra_testkit::environment::{data, skip};
use criterion::Criterion;

/// A scene whose grid holds the viewpoint, too.
fn build(input: SceneInput, eye: [f64; 3]) -> Scene {
    let (scene, _) = SceneBuilder::new(input)
        .cells_box(Some((eye, eye)))
        .build()
        .expect("a sound scene");
    scene
}

/// From a room, from outside, and from outside a cloud of 10,000 triangles.
pub(crate) fn views(c: &mut Criterion) {
    let views = [
        ("duplex", "a room", [1.9016, 6.026, 6.75]),
        ("duplex", "outside", [20.0, -15.0, 9.0]),
        ("kit_institute", "outside", [60.0, -40.0, 15.0]),
    ];
    for (name, place, eye) in views {
        let path = data().map(|d| d.join(format!("walk/{name}.glb")));
        match path.and_then(|p| read_scene(&p).ok()) {
            Some(input) => view(c, &format!("{name} from {place}"), &build(input, eye), eye),
            None => skip(&format!("walk/{name}.glb is absent")),
        }
    }
    let params = TriangleParams {
        count: 10_000,
        area: 12.5,
        source_area: 200.0,
        seed: 1,
    };
    let eye = [-120.0, 30.0, 20.0];
    let scene = build(random_triangles(&params), eye);
    view(c, "10000 triangles from outside", &scene, eye);
}

fn view(c: &mut Criterion, name: &str, scene: &Scene, eye: [f64; 3]) {
    let mapper = Mapper::new(scene);
    let make = || {
        mapper
            .map(&Viewpoint::Sphere(eye), &MapOptions::default())
            .expect("a view")
    };
    let map = make();
    map.sanity_check().expect("planar, by Euler's relation");
    let seen = map.faces().iter().filter(|f| f.polygon().is_some()).count();
    assert!(seen > 10, "{name}: something is seen");
    let sum: f64 = map.faces().iter().map(|f| f.measure).sum();
    let sphere = 4.0 * std::f64::consts::PI;
    assert!(
        (sum / sphere - 1.0).abs() < 1e-9,
        "{name}: {sum} is not 4 pi"
    );
    let mut group = c.benchmark_group("maps");
    group.bench_function(name, |b| b.iter(make));
    group.finish();
}
