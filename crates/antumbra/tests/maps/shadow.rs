//! Lit and shadowed fragments against first hits in big integers, and meshes known by hand.

use std::collections::BTreeMap;

use antumbra::map::Mapper;
use antumbra::scene::synth::{TriangleParams, random_triangles};
use antumbra::scene::{Faces, ObjectInput, PartInput, PolygonId, Scene, SceneBuilder, SceneInput};
use antumbra::shadow::{DiscontinuityMesh, Event, Fragment, Lighting, area_light, point_light};
use antumbra_testkit::environment::{data, long, skip};
use antumbra_testkit::random::Random;
use dashu_int::IBig;

use crate::oracle::FirstHits;
use crate::small;

/// Points of polygons are multiples of this share of two of their edges.
const SHARE: i64 = 1 << 24;

/// Checks `points` points of fragments against first hits, and the areas of all polygons.
fn check(scene: &Scene, light: [f64; 3], points: usize, random: &mut Random) -> [usize; 2] {
    let mapper = Mapper::new(scene);
    let shadows = point_light(&mapper, light).expect("a light");
    let hits = FirstHits::new(scene, scene.grid().snap(light).expect("on the grid"));
    let mut of: BTreeMap<PolygonId, Vec<&Fragment>> = BTreeMap::new();
    for fragment in shadows.fragments() {
        of.entry(fragment.polygon).or_default().push(fragment);
    }
    assert_eq!(of.len(), scene.polygons().count(), "every polygon is there");
    for polygon in scene.polygons() {
        let corners = polygon.corners.iter().map(|&c| scene.grid().to_scene(c));
        let whole = Fragment {
            polygon: polygon.id,
            lighting: Lighting::Lit,
            corners: corners.collect(),
        };
        let parts: f64 = of[&polygon.id].iter().map(|f| f.area()).sum();
        let error = (parts - whole.area()).abs();
        assert!(error <= 1e-9 * whole.area(), "{:?}: {parts}", polygon.id);
    }
    let all = shadows.fragments();
    let mut counts = [0; 2];
    for _ in 0..points {
        let fragment = &all[random.index(all.len())];
        if fragment.lighting == Lighting::EdgeOn {
            continue;
        }
        let Some(direction) = inner_direction(scene, light, fragment, random) else {
            continue;
        };
        let first = hits.along(&direction);
        let owner = scene.polygon(first[0]);
        let lit = first.contains(&fragment.polygon);
        let expected = fragment.lighting == Lighting::Lit;
        assert_eq!(lit, expected, "{fragment:?}: first is {:?}", owner.id);
        counts[usize::from(lit)] += 1;
    }
    counts
}

/// The direction from the light to a point inside a fragment: exactly on its polygon, and off the
/// fragment's border by more than rounding.
fn inner_direction(
    scene: &Scene,
    light: [f64; 3],
    fragment: &Fragment,
    random: &mut Random,
) -> Option<[IBig; 3]> {
    let minus = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let cross = |a: [f64; 3], b: [f64; 3]| {
        let m = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
        [m(1, 2), m(2, 0), m(0, 1)]
    };
    let grid = scene.grid();
    let corners: Vec<[f64; 3]> = fragment
        .corners
        .iter()
        .map(|&c| grid.to_grid_f64(c))
        .collect();
    // Weights that often favor a corner or an edge.
    let weights: Vec<f64> = corners.iter().map(|_| random.unit().powi(6)).collect();
    let sum: f64 = weights.iter().sum();
    let target: [f64; 3] = std::array::from_fn(|k| {
        corners
            .iter()
            .zip(&weights)
            .map(|(c, w)| c[k] * w)
            .sum::<f64>()
            / sum
    });
    let polygon = scene.polygon(fragment.polygon);
    let [a, b, c] = [0, 1, 2].map(|i| polygon.corners[i].to_f64());
    let (u, v, w) = (minus(b, a), minus(c, a), minus(target, a));
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let det = uu * vv - uv * uv;
    let share = |x: f64| (x / det * SHARE as f64).round();
    let s = share(dot(w, u) * vv - dot(w, v) * uv);
    let t = share(dot(w, v) * uu - dot(w, u) * uv);
    let at: [f64; 3] = std::array::from_fn(|k| a[k] + (s * u[k] + t * v[k]) / SHARE as f64);
    let normal = cross(u, v);
    let n = corners.len();
    let turn = (0..n)
        .map(|i| {
            dot(
                normal,
                cross(minus(corners[i], at), minus(corners[(i + 1) % n], at)),
            )
        })
        .sum::<f64>();
    let inside = (0..n).all(|i| {
        let (p, q) = (corners[i], corners[(i + 1) % n]);
        let along = minus(q, p);
        let off = dot(normal, cross(along, minus(at, p))) * turn.signum();
        let unit = (dot(along, along) * dot(normal, normal)).sqrt();
        off > unit * 1e-3
    });
    let light = grid.snap(light).expect("on the grid");
    inside.then(|| {
        std::array::from_fn(|k| {
            let [a, b, c] = [0, 1, 2].map(|i| i128::from(polygon.corners[i].to_i64()[k]));
            let e = i128::from(light.to_i64()[k]);
            let share = i128::from(SHARE);
            IBig::from((a - e) * share + (s as i128) * (b - a) + (t as i128) * (c - a))
        })
    })
}

#[test]
fn fragments_of_small_scenes_agree_with_first_hits() {
    let rounds = if long() { 2000 } else { 150 };
    let mut counts = [0; 2];
    for seed in 0..rounds {
        let mut random = Random::new(5000 + seed);
        let count = 2 + random.index(9);
        // The margin of a point is a share of a grid step: the grid is finer than the lattice.
        let scene = small::scene_on(&mut random, count, 1.0 / 1024.0);
        let light: [f64; 3] = std::array::from_fn(|_| random.index(11) as f64 - 5.0);
        let [shadowed, lit] = check(&scene, light, 100, &mut random);
        counts = [counts[0] + shadowed, counts[1] + lit];
    }
    assert!(counts.iter().all(|&n| n > 2000), "{counts:?}");
}

#[test]
fn fragments_of_crossing_triangles_agree_with_first_hits() {
    let params = TriangleParams {
        count: 400,
        area: 200.0,
        source_area: 50.0,
        seed: 3,
    };
    let (scene, _) = SceneBuilder::new(random_triangles(&params))
        .cells_box(Some(([-99.0; 3], [99.0; 3])))
        .build()
        .expect("a scene");
    let counts = check(&scene, [70.0, -80.0, 60.0], 5000, &mut Random::new(1));
    assert!(counts.iter().all(|&n| n > 500), "{counts:?}");
}

#[test]
fn fragments_of_a_house_agree_with_first_hits() {
    let path = data().map(|d| d.join("walk/duplex.glb"));
    let Some(input) = path.and_then(|p| antumbra_io::read_scene(&p).ok()) else {
        skip("duplex.glb is not at hand");
        return;
    };
    for light in [[1.9016, 6.026, 6.75], [20.0, -15.0, 9.0]] {
        let (scene, _) = SceneBuilder::new(input.clone())
            .cells_box(Some((light, light)))
            .build()
            .expect("a scene");
        let counts = check(&scene, light, 5000, &mut Random::new(2));
        assert!(counts[0] > 2000, "{counts:?}");
    }
}

fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> ObjectInput {
    let vertices = vec![
        [x[0], y[0], z],
        [x[1], y[0], z],
        [x[1], y[1], z],
        [x[0], y[1], z],
    ];
    let mut faces = Faces::default();
    faces.push(&[0, 1, 2, 3]);
    let parts = vec![PartInput {
        vertices,
        faces,
        ..PartInput::default()
    }];
    ObjectInput { name: None, parts }
}

fn built(objects: Vec<ObjectInput>) -> Scene {
    let input = SceneInput {
        objects,
        source_name: "rectangles".into(),
    };
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0 / 64.0))
        .cells_box(Some(([-20.0; 3], [20.0; 3])))
        .build()
        .expect("a scene");
    scene
}

#[test]
fn panes_are_shaded_and_cast_none_and_planes_with_the_light_are_edge_on() {
    let mut pane = rectangle([-1.0, 1.0], [-1.0, 1.0], 4.0);
    pane.parts[0].translucent = true;
    let mut shaded = rectangle([-1.0, 1.0], [-1.0, 1.0], 1.0);
    shaded.parts[0].translucent = true;
    let scene = built(vec![
        rectangle([-8.0, 8.0], [-8.0, 8.0], 0.0),
        rectangle([-2.0, 2.0], [-2.0, 2.0], 2.0),
        pane,
        shaded,
        rectangle([9.0, 10.0], [0.0, 1.0], 6.0),
        // Coincides with a quarter of the lid: both are lit.
        rectangle([0.0, 2.0], [0.0, 2.0], 2.0),
    ]);
    let shadows = point_light(&Mapper::new(&scene), [0.0, 0.0, 6.0]).expect("a light");
    let areas = |object: u32| {
        [Lighting::Lit, Lighting::Shadowed, Lighting::EdgeOn].map(|lighting| {
            let of = |f: &&Fragment| {
                f.lighting == lighting && scene.polygon(f.polygon).object.0 == object
            };
            shadows
                .fragments()
                .iter()
                .filter(of)
                .map(Fragment::area)
                .sum::<f64>()
        })
    };
    assert_eq!(areas(0), [256.0 - 36.0, 36.0, 0.0]);
    assert_eq!(areas(1), [16.0, 0.0, 0.0]);
    assert_eq!(areas(2), [4.0, 0.0, 0.0]);
    assert_eq!(areas(3), [0.0, 4.0, 0.0]);
    assert_eq!(areas(4), [0.0, 0.0, 1.0]);
    assert_eq!(areas(5), [4.0, 0.0, 0.0]);
}

fn count(mesh: &DiscontinuityMesh, event: Event, polygon: u32) -> usize {
    let on = |p: &&antumbra::shadow::Discontinuity| p.event == event && p.polygon.0 == polygon;
    mesh.pieces.iter().filter(on).count()
}

#[test]
fn the_mesh_under_a_lid_is_known() {
    let scene = built(vec![
        rectangle([-8.0, 8.0], [-8.0, 8.0], 0.0),
        rectangle([-1.0, 1.0], [-1.0, 1.0], 2.0),
    ]);
    let light = [
        [-1.0, -1.0, 4.0],
        [1.0, -1.0, 4.0],
        [1.0, 1.0, 4.0],
        [-1.0, 1.0, 4.0],
    ];
    let mesh = area_light(&Mapper::new(&scene), light).expect("a mesh");
    // Four corners of the light and four edges of the lid; as many the other way round.
    assert_eq!(count(&mesh, Event::LightCorner, 0), 16);
    assert_eq!(count(&mesh, Event::LightEdge, 0), 16);
    assert_eq!(mesh.pieces.len(), 32);
    // From the corner (-1, -1, 4) the lid's corner (1, 1, 2) throws its shadow to (3, 3, 0).
    for piece in &mesh.pieces {
        for end in piece.ends {
            let known = |c: f64| c == 1.0 || c == 3.0;
            assert!(
                end[2] == 0.0 && known(end[0].abs()) && known(end[1].abs()),
                "{end:?}"
            );
        }
    }
    // Where the penumbra ends at x = 3: two corners of the light and the lid's edge x = 1, and the
    // light's edge x = -1 with both ends of that edge.
    let outer = mesh
        .pieces
        .iter()
        .filter(|p| p.ends.iter().all(|e| e[0] == 3.0));
    assert_eq!(outer.count(), 4);
}

#[test]
fn two_bars_that_seem_to_cross_make_chords_of_conics() {
    let scene = built(vec![
        rectangle([-8.0, 8.0], [-8.0, 8.0], 0.0),
        rectangle([-4.0, 4.0], [-0.25, 0.25], 1.0),
        rectangle([-0.25, 0.25], [-4.0, 4.0], 2.0),
    ]);
    let light = [
        [-1.0, -1.0, 4.0],
        [1.0, -1.0, 4.0],
        [1.0, 1.0, 4.0],
        [-1.0, 1.0, 4.0],
    ];
    let mesh = area_light(&Mapper::new(&scene), light).expect("a mesh");
    // Four crossings of the bars' edges for each of four edges of the light.
    assert_eq!(count(&mesh, Event::ThreeEdges, 0), 16);
    for piece in mesh
        .pieces
        .iter()
        .filter(|p| p.event == Event::ThreeEdges && p.polygon.0 == 0)
    {
        for (end, corner) in piece.ends.iter().zip(&piece.light) {
            // The edge x = +-1/4 at height 2 doubles its distance from the light's corner, the edge
            // y = +-1/4 at height 1 makes 4/3 of it.
            let [x, y, _] = light[*corner as usize];
            let (at_x, at_y) = (x + (end[0] - x) / 2.0, y + (end[1] - y) * 0.75);
            assert!((at_x.abs() - 0.25).abs() < 1e-12, "{end:?}");
            assert!((at_y.abs() - 0.25).abs() < 1e-12, "{end:?}");
        }
        assert_eq!(piece.cast_by.len(), 2);
    }
}

#[test]
fn lights_without_area_are_refused() {
    let scene = built(vec![rectangle([-8.0, 8.0], [-8.0, 8.0], 0.0)]);
    let mapper = Mapper::new(&scene);
    let p = [0.0, 0.0, 4.0];
    let error = area_light(&mapper, [p, p, [1.0, 1.0, 4.0], [0.0, 1.0, 4.0]]).expect_err("no area");
    assert!(error.to_string().contains("no area"), "{error}");
    let [a, b, c, d] = [
        [0.0, 0.0, 4.0],
        [1.0, 0.0, 4.0],
        [1.0, 1.0, 4.0],
        [0.0, 1.0, 4.0],
    ];
    for crossed in [[a, c, b, d], [a, b, d, c], [a, b, c, [0.75, 0.25, 4.0]]] {
        let error = area_light(&mapper, crossed).expect_err("crossed");
        assert!(error.to_string().contains("in order"), "{error}");
    }
    // Both ways round, a corner that is none, one off the plane.
    for light in [
        [a, b, c, d],
        [d, c, b, a],
        [a, b, c, [0.5, 0.5, 4.0]],
        [a, b, c, [0.0, 1.0, 4.25]],
    ] {
        assert!(area_light(&mapper, light).is_ok(), "{light:?}");
    }
    assert!(point_light(&mapper, [f64::NAN, 0.0, 0.0]).is_err());
}
