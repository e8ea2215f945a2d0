//! Hidden-line drawings: outlines and creases, and never the diagonal of a flat face.

use antumbra::map::drawing::{Projection, strokes};
use antumbra::map::{EdgeClass, MapOptions, Mapper, Viewpoint};
use antumbra::scene::{Faces, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};
use antumbra_testkit::environment::{data, skip};
use antumbra_testkit::random::Random;

/// The classes that are drawn unless flat edges are asked for.
const DRAWN: [EdgeClass; 4] = [
    EdgeClass::Silhouette,
    EdgeClass::Shadow,
    EdgeClass::Corner,
    EdgeClass::Intersection,
];

/// A cube of side 4 around the origin, as one mesh: each side a lattice of 4 x 4 cells, the diagonals of which
/// turn at random.
fn cube(random: &mut Random) -> Scene {
    let (mut vertices, mut faces) = (Vec::new(), Faces::default());
    for side in 0..6 {
        let first = vertices.len() as u32;
        for i in 0..25 {
            let mut p = [0.0; 3];
            p[side / 2] = if side % 2 == 0 { 2.0 } else { -2.0 };
            p[(side / 2 + 1) % 3] = f64::from(i % 5) - 2.0;
            p[(side / 2 + 2) % 3] = f64::from(i / 5) - 2.0;
            vertices.push(p);
        }
        for i in 0..16 {
            let a = first + i / 4 * 5 + i % 4;
            let [a, b, c, d] = [a, a + 1, a + 6, a + 5];
            if random.index(2) == 0 {
                faces.push(&[a, b, c]);
                faces.push(&[a, c, d]);
            } else {
                faces.push(&[a, b, d]);
                faces.push(&[b, c, d]);
            }
        }
    }
    let parts = vec![PartInput {
        vertices,
        faces,
        ..PartInput::default()
    }];
    let objects = vec![ObjectInput { name: None, parts }];
    let input = SceneInput {
        objects,
        source_name: "cube".into(),
    };
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0 / 1024.0))
        .cells_box(Some(([-99.0; 3], [99.0; 3])))
        .build()
        .expect("a sound scene");
    scene
}

/// The straight pieces of a drawing between corners where it turns.
fn straight(points: &[[f64; 2]]) -> usize {
    let turns = points.windows(3).filter(|w| {
        let (u, v) = (
            [w[1][0] - w[0][0], w[1][1] - w[0][1]],
            [w[2][0] - w[1][0], w[2][1] - w[1][1]],
        );
        let sine = (u[0] * v[1] - u[1] * v[0]) / (u[0].hypot(u[1]) * v[0].hypot(v[1]));
        sine.abs() > 1e-3
    });
    turns.count() + 1
}

#[test]
fn a_cube_of_triangles_has_the_edges_of_a_cube() {
    let mut random = Random::new(11);
    for (eye, edges) in [
        ([9.0, 7.5, 5.5], 9),
        ([9.0, 7.5, 1.25], 7),
        ([9.0, 1.0, -1.5], 4),
    ] {
        let scene = cube(&mut random);
        let map = Mapper::new(&scene).map(&Viewpoint::Sphere(eye), &MapOptions::default());
        let map = map.expect("a view");
        let projection = Projection::new(eye, [0.0; 3], [0.0, 0.0, 1.0], false);
        let projection = projection.expect("a camera").on_paper(100.0, [50.0; 2]);
        let drawn = strokes(&map, &scene, &projection, &DRAWN, 1e-6);
        let count: usize = drawn.iter().map(|s| straight(&s.points)).sum();
        assert_eq!(count, edges, "from {eye:?}: {drawn:?}");
    }
}

#[test]
fn what_is_drawn_of_a_house_lies_in_no_flat_face() {
    let path = data().map(|d| d.join("walk/duplex.glb"));
    let Some(input) = path.and_then(|p| antumbra_io::read_scene(&p).ok()) else {
        skip("duplex.glb is not at hand");
        return;
    };
    let eyes = [
        [20.0, -15.0, 9.0],
        [-18.0, 22.0, 6.0],
        [1.9016, 6.026, 6.75],
    ];
    let (scene, _) = SceneBuilder::new(input)
        .cells_box(Some(([-30.0; 3], [30.0; 3])))
        .build()
        .expect("a scene");
    for eye in eyes {
        let map = Mapper::new(&scene).map(&Viewpoint::Sphere(eye), &MapOptions::default());
        let map = map.expect("a view");
        let mut drawn = 0;
        for edge in map.edges().iter().filter(|e| DRAWN.contains(&e.class)) {
            drawn += 1;
            let (Some(near), Some(far)) = (edge.near, edge.far) else {
                continue;
            };
            let [near, far] = [near, far].map(|e| scene.polygon(e.polygon));
            let flat = near.plane == far.plane && near.object == far.object;
            assert!(!flat, "from {eye:?}: {edge:?}");
        }
        assert!(drawn > 100, "from {eye:?}: {drawn} edges");
    }
}
