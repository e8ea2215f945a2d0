//! Small scenes on a coarse grid, where nearly everything touches, crosses or coincides.

use std::collections::BTreeMap;

use antumbra::map::{
    Dissolve, EdgeClass, FaceKind, MapOptions, Mapper, Viewpoint, VisibilityMap, occlusion,
};
use antumbra::scene::{Faces, ObjectInput, PartInput, PolygonId, Scene, SceneBuilder, SceneInput};
use antumbra_testkit::random::Random;

use crate::oracle::{FirstHits, check_beside};

const HALF: f64 = 4.0;

/// Random triangles and axis-parallel rectangles with corners in [-4, 4]^3, an object each.
fn scene(random: &mut Random, count: usize) -> Scene {
    scene_on(random, count, 1.0)
}

/// The same on a grid of any step.
pub(crate) fn scene_on(random: &mut Random, count: usize, step: f64) -> Scene {
    let coordinate = |random: &mut Random| random.index(9) as f64 - HALF;
    let objects = (0..count)
        .map(|i| {
            let mut point = || -> [f64; 3] { std::array::from_fn(|_| coordinate(random)) };
            let (p, q, mut r, choice) = (point(), point(), point(), point());
            if i == 0 {
                // At least one polygon has an area.
                r = [
                    p[0] + 1.0,
                    p[1] + 2.0 * (q[1] - p[1]) + 1.0,
                    p[2] - q[2] - 9.0,
                ];
            }
            let mut faces = Faces::default();
            let vertices = if i == 0 || choice[0] > 0.0 {
                faces.push(&[0, 1, 2]);
                vec![p, q, r]
            } else {
                // Flat along one axis; may have no area, which the builder drops.
                let k = (choice[1] + HALF) as usize % 3;
                let (u, v) = ((k + 1) % 3, (k + 2) % 3);
                let mut corners = [p; 4];
                corners[1][u] = q[u];
                corners[2][u] = q[u];
                corners[2][v] = q[v];
                corners[3][v] = q[v];
                faces.push(&[0, 1, 2, 3]);
                corners.to_vec()
            };
            let parts = vec![PartInput {
                vertices,
                faces,
                ..PartInput::default()
            }];
            ObjectInput { name: None, parts }
        })
        .collect();
    let input = SceneInput {
        objects,
        source_name: "small".into(),
    };
    let reach = ([-6.0; 3], [6.0; 3]);
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(step))
        .cells_box(Some(reach))
        .build()
        .expect("a scene");
    scene
}

fn undissolved() -> MapOptions {
    MapOptions {
        dissolve: Dissolve::Nothing,
        ..MapOptions::default()
    }
}

/// Everything about a map that may not depend on how it was made.
fn essence(map: &VisibilityMap) -> BTreeMap<String, usize> {
    let mut lines = BTreeMap::new();
    let mut add = |line: String| *lines.entry(line).or_insert(0) += 1;
    let at: Vec<String> = (0..map.vertices().len() as u32)
        .map(|v| map.exact_direction(v).join(" "))
        .collect();
    for (vertex, at) in map.vertices().iter().zip(&at) {
        add(format!("vertex {:?} {at}", vertex.kind));
    }
    for edge in map.edges() {
        let mut ends = edge.ends.map(|v| at[v as usize].clone());
        let mut sides = edge
            .faces
            .map(|f| format!("{:?}", map.faces()[f as usize].kind));
        if ends[0] > ends[1] {
            ends.reverse();
            sides.reverse();
        }
        add(format!(
            "edge {:?} {ends:?} {sides:?} {:?}",
            edge.class, edge.near
        ));
    }
    for face in map.faces() {
        let size = (face.measure * 1e8).round();
        add(format!(
            "face {:?} {:?} {:?} {size} {}",
            face.kind,
            face.joined,
            face.coincident,
            face.borders.len()
        ));
    }
    lines
}

/// What is in one map only.
fn difference(a: &VisibilityMap, b: &VisibilityMap) -> Vec<String> {
    let (a, b) = (essence(a), essence(b));
    let only = |x: &BTreeMap<String, usize>, y: &BTreeMap<String, usize>, sign: &str| {
        let lines = x.iter().filter(|(line, n)| y.get(*line) != Some(n));
        lines
            .map(|(line, n)| format!("{sign}{n} {line}"))
            .collect::<Vec<_>>()
    };
    [only(&a, &b, "-"), only(&b, &a, "+")].concat()
}

fn rounds() -> u64 {
    if antumbra_testkit::environment::long() {
        4000
    } else {
        150
    }
}

#[test]
fn first_hits_agree_beside_every_edge_and_vertex() {
    let mut checked = 0;
    for seed in 0..rounds() {
        let mut random = Random::new(seed);
        let count = 2 + random.index(9);
        let scene = scene(&mut random, count);
        let eye: [f64; 3] = std::array::from_fn(|_| random.index(11) as f64 - 5.0);
        let mapper = Mapper::new(&scene);
        let map = mapper
            .map(&Viewpoint::Sphere(eye), &undissolved())
            .expect("a view");
        map.sanity_check()
            .unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let hits = FirstHits::new(&scene, scene.grid().snap(eye).expect("on the grid"));
        checked += check_beside(&map, &hits, usize::MAX);
    }
    assert!(checked > 10_000, "{checked}");
}

#[test]
fn dissolved_maps_do_not_depend_on_the_order_of_insertion() {
    for seed in 0..rounds() {
        let mut random = Random::new(1000 + seed);
        let count = 2 + random.index(9);
        let scene = scene(&mut random, count);
        let eye: [f64; 3] = std::array::from_fn(|_| random.index(11) as f64 - 5.0);
        let mapper = Mapper::new(&scene);
        let view = Viewpoint::Sphere(eye);
        for dissolve in [Dissolve::Bsp, Dissolve::Flat] {
            let mut options = MapOptions {
                dissolve,
                ..MapOptions::default()
            };
            let expected = mapper.map(&view, &options).expect("a view");
            let mut order: Vec<PolygonId> = scene.polygons().map(|p| p.id).collect();
            for _ in 0..3 {
                random.shuffle(&mut order);
                let map = mapper
                    .map_in_order(&view, &order, &options)
                    .expect("a view");
                map.sanity_check()
                    .unwrap_or_else(|e| panic!("seed {seed}: {e}"));
                let other = difference(&expected, &map);
                assert!(other.is_empty(), "seed {seed}, {order:?}: {other:#?}");
            }
            for test in [occlusion::BoxTest::Never, occlusion::BoxTest::Exact] {
                options.sweep.test = test;
                options.sweep.order = occlusion::SweepOrder::Priority;
                let map = mapper.map(&view, &options).expect("a view");
                let other = difference(&expected, &map);
                assert!(other.is_empty(), "seed {seed}, {test:?}: {other:#?}");
            }
        }
    }
}

/// Axis-parallel rectangles in a few planes, many on top of each other, an object each.
fn layers(random: &mut Random, count: usize) -> Scene {
    let objects = (0..count).map(|_| {
        let k = random.index(3);
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        let (mut low, mut size) = ([0.0; 3], [0.0; 3]);
        low[k] = [-16.0, -13.0, 14.0, 16.0][random.index(4)];
        for i in [u, v] {
            low[i] = random.index(32) as f64 - 16.0;
            size[i] = 1.0 + random.index(9) as f64;
        }
        let at = |a: f64, b: f64| {
            let mut p = low;
            p[u] += a * size[u];
            p[v] += b * size[v];
            p
        };
        let mut faces = Faces::default();
        faces.push(&[0, 1, 2, 3]);
        let parts = vec![PartInput {
            vertices: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
            faces,
            ..PartInput::default()
        }];
        ObjectInput { name: None, parts }
    });
    let input = SceneInput {
        objects: objects.collect(),
        source_name: "layers".into(),
    };
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0))
        .build()
        .expect("a sound scene");
    scene
}

/// What coincides with what is seen is found through any number of others that coincide with both.
#[test]
fn chains_of_coincident_polygons_are_owned_by_the_smallest() {
    for seed in 0..rounds() / 4 {
        let mut random = Random::new(4000 + seed);
        let scene = layers(&mut random, 300);
        let eye: [f64; 3] = std::array::from_fn(|_| random.index(11) as f64 - 5.0);
        let mapper = Mapper::new(&scene);
        let view = Viewpoint::Sphere(eye);
        let mut options = MapOptions::default();
        options.sweep.test = occlusion::BoxTest::Never;
        let expected = mapper.map(&view, &options).expect("a view");
        for test in [occlusion::BoxTest::Conservative, occlusion::BoxTest::Exact] {
            options.sweep.test = test;
            let map = mapper.map(&view, &options).expect("a view");
            let other = difference(&expected, &map);
            assert!(other.is_empty(), "seed {seed}, {test:?}: {other:#?}");
        }
    }
}

#[test]
fn angles_add_up_and_classes_fit_their_faces() {
    for seed in 0..rounds() {
        let mut random = Random::new(2000 + seed);
        let scene = scene(&mut random, 8);
        let eye: [f64; 3] = std::array::from_fn(|_| random.index(11) as f64 - 5.0);
        let mapper = Mapper::new(&scene);
        let view = Viewpoint::Sphere(eye);
        let map = mapper.map(&view, &MapOptions::default()).expect("a view");
        let sum: f64 = map.faces().iter().map(|f| f.measure).sum();
        let sphere = 4.0 * std::f64::consts::PI;
        assert!((sum - sphere).abs() < 1e-9 * sphere, "seed {seed}: {sum}");
        for edge in map.edges() {
            let [a, b] = edge.faces.map(|f| map.faces()[f as usize].kind);
            let polygons = [a, b].map(|k| matches!(k, FaceKind::Polygon(_)));
            match edge.class {
                EdgeClass::Silhouette => assert_ne!(polygons[0], polygons[1], "seed {seed}"),
                EdgeClass::Bsp | EdgeClass::Frame => panic!("seed {seed}: {edge:?} is left"),
                _ => assert_eq!(polygons, [true; 2], "seed {seed}"),
            }
            let outline = matches!(edge.class, EdgeClass::Silhouette | EdgeClass::Shadow);
            let on_edge = edge.near.is_some_and(|e| e.edge.is_some());
            assert!(!outline || on_edge, "seed {seed}: {edge:?} is on no edge");
        }
    }
}

#[test]
fn parallel_and_framed_views_are_sound() {
    for seed in 0..rounds() {
        let mut random = Random::new(3000 + seed);
        let scene = scene(&mut random, 8);
        let mapper = Mapper::new(&scene);
        let direction: [f64; 3] = std::array::from_fn(|_| random.index(7) as f64 - 3.0);
        let view = Viewpoint::Parallel { direction };
        if direction == [0.0; 3] {
            assert!(mapper.map(&view, &undissolved()).is_err());
            continue;
        }
        for dissolve in [Dissolve::Nothing, Dissolve::Bsp, Dissolve::Flat] {
            let options = MapOptions {
                dissolve,
                ..MapOptions::default()
            };
            let map = mapper.map(&view, &options).expect("a view");
            map.sanity_check()
                .unwrap_or_else(|e| panic!("seed {seed}: {e}"));
            let order: Vec<PolygonId> = scene.polygons().map(|p| p.id).collect();
            let other = mapper
                .map_in_order(&view, &order, &options)
                .expect("a view");
            if dissolve != Dissolve::Nothing {
                let other = difference(&map, &other);
                assert!(other.is_empty(), "seed {seed}: {other:#?}");
            }
            let eye: [f64; 3] = std::array::from_fn(|k| -5.0 * direction[k].signum());
            let up = [0.25, 0.5, 1.0];
            let Ok(camera) = Viewpoint::camera(eye, [0.0; 3], up, 1.0, 1.5) else {
                continue;
            };
            let map = mapper.map(&camera, &options).expect("a view");
            map.sanity_check()
                .unwrap_or_else(|e| panic!("seed {seed}: {e}"));
            let sum: f64 = map.faces().iter().map(|f| f.measure).sum();
            // A pyramid of half angles a and b spans 4 asin(sin a sin b).
            let (b, t) = (0.5_f64, 0.5_f64.tan());
            let a = (1.5 * t).atan();
            let expected = 4.0 * (a.sin() * b.sin()).asin();
            assert!(
                (sum - expected).abs() < 1e-5,
                "seed {seed}: {sum}, not {expected}"
            );
        }
    }
}
