//! Small buildings and random soups through the whole builder, every invariant checked.

use std::collections::BTreeSet;

use antumbra_scene::{
    BuildError, BuildReport, Faces, KdHeuristic, ObjectInput, OccluderPolicy, PartInput, Scene,
    SceneBuilder, SceneInput,
};
use proptest::prelude::*;

fn part(vertices: Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> PartInput {
    PartInput {
        vertices,
        faces: triangles.iter().copied().collect(),
        ..PartInput::default()
    }
}

fn input(objects: Vec<Vec<PartInput>>) -> SceneInput {
    let objects = objects
        .into_iter()
        .map(|parts| ObjectInput { name: None, parts })
        .collect();
    SceneInput {
        objects,
        source_name: "test".into(),
    }
}

fn build(input: SceneInput) -> (Scene, BuildReport) {
    let (scene, report) = SceneBuilder::new(input).build().expect("a valid scene");
    assert_eq!(scene.sanity_check(), Ok(()));
    (scene, report)
}

/// A triangulated wall in the plane y = 0 from unit squares, without some of them.
fn wall_of_squares(width: u32, height: u32, holes: &[[u32; 2]]) -> PartInput {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for (x, z) in (0..width).flat_map(|x| (0..height).map(move |z| (x, z))) {
        if holes.contains(&[x, z]) {
            continue;
        }
        let first = vertices.len() as u32;
        for [i, j] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
            vertices.push([f64::from(x + i), 0.0, f64::from(z + j)]);
        }
        // Alternating diagonals and orientations, as exporters write them.
        if (x + z) % 2 == 0 {
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        } else {
            triangles.extend([
                [first + 1, first + 3, first + 2],
                [first, first + 1, first + 3],
            ]);
        }
    }
    part(vertices, &triangles)
}

/// Twice the area of all polygons in a plane, in grid steps, counting overlaps twice.
fn doubled_area(scene: &Scene, drop_axis: usize) -> i64 {
    let (u, v) = ((drop_axis + 1) % 3, (drop_axis + 2) % 3);
    scene
        .polygons()
        .map(|polygon| {
            let n = polygon.corners.len();
            let at = |i: usize| polygon.corners[i % n].to_i64();
            (0..n)
                .map(|i| at(i)[u] * at(i + 1)[v] - at(i)[v] * at(i + 1)[u])
                .sum::<i64>()
                .abs()
        })
        .sum()
}

#[test]
fn a_full_wall_is_one_rectangle() {
    let (scene, report) = build(input(vec![vec![wall_of_squares(7, 3, &[])]]));
    assert_eq!((report.faces, scene.polygon_count()), (42, 1));
    assert_eq!(scene.polygons().next().map(|p| p.corners.len()), Some(4));
    assert!(report.repairs.is_empty());
}

#[test]
fn a_wall_with_door_and_window_keeps_its_area_in_few_pieces() {
    // A door from the ground, and a window of two squares.
    let holes = [[2, 0], [2, 1], [5, 1], [6, 1]];
    let (scene, report) = build(input(vec![vec![wall_of_squares(9, 3, &holes)]]));
    let unit = 1.0 / report.grid_step;
    let area = 2.0 * (27.0 - 4.0) * unit * unit;
    assert_eq!(doubled_area(&scene, 1) as f64, area);
    // 2 reflex corners at the door and 4 at the window: 7 pieces with one cut each, less if cuts
    // serve two corners.
    assert!(
        scene.polygon_count() <= 7,
        "{} pieces",
        scene.polygon_count()
    );
}

#[test]
fn an_l_shaped_wall_is_two_pieces() {
    let (scene, _) = build(input(vec![vec![wall_of_squares(
        4,
        4,
        &[[2, 2], [3, 2], [2, 3], [3, 3]],
    )]]));
    assert_eq!(scene.polygon_count(), 2);
}

#[test]
fn a_tessellated_disc_on_a_coarse_grid_stays_one_patch() {
    let n = 64_u32;
    let mut vertices: Vec<[f64; 3]> = (0..n)
        .map(|i| {
            let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            [angle.cos(), angle.sin(), 0.5]
        })
        .collect();
    vertices.push([0.0, 0.0, 0.5]);
    let triangles: Vec<[u32; 3]> = (0..n).map(|i| [n, i, (i + 1) % n]).collect();
    let (scene, _) = build(input(vec![vec![part(vertices, &triangles)]]));
    assert_eq!(scene.polygon_count(), 1);
    assert_eq!(scene.polygons().next().map(|p| p.corners.len()), Some(64));
}

#[test]
fn a_box_whose_lid_has_t_junctions_is_closed() {
    // The lid's oblique edge is one edge on the lid and three on the side; on a coarse grid the two
    // vertices between leave it.
    let (a, b) = ([0.0, 0.0, 10.0], [100.0, 37.0, 10.0]);
    let on = |t: f64| [a[0] + t * b[0], a[1] + t * b[1], 10.0];
    let vertices = vec![
        a,
        b,
        [0.0, 60.0, 10.0],
        on(0.3),
        on(0.71),
        [0.0, 0.0, 0.0],
        [100.0, 37.0, 0.0],
    ];
    let triangles = [[0, 1, 2], [0, 5, 3], [3, 5, 4], [4, 5, 6], [4, 6, 1]];
    let object = vec![part(vertices, &triangles)];
    let builder = SceneBuilder::new(input(vec![object])).grid(Some(1.0));
    let (scene, report) = builder.build().expect("valid");
    assert_eq!(scene.sanity_check(), Ok(()));
    let counts = report.totals();
    assert!(counts.inserted >= 1 && counts.sealing >= 1, "{counts}");
    // Every edge of the surface but its outer border is met by another one exactly: vertices of
    // odd degree in the mod-2 boundary would betray a slit.
    let border = boundary(&scene);
    let inner = |p: [i32; 3]| border.iter().filter(|e| e[0] == p || e[1] == p).count();
    for e in &border {
        assert!(e.iter().all(|&p| inner(p) % 2 == 0), "{border:?}");
    }
    assert_eq!(
        border.len(),
        5,
        "the lid's two free edges, two sides and the bottom: {border:?}"
    );
}

/// The edges that an odd number of polygons share.
fn boundary(scene: &Scene) -> BTreeSet<[[i32; 3]; 2]> {
    let mut odd = BTreeSet::new();
    for polygon in scene.polygons() {
        let n = polygon.corners.len();
        for i in 0..n {
            let mut edge = [
                polygon.corners[i].to_array(),
                polygon.corners[(i + 1) % n].to_array(),
            ];
            edge.sort_unstable();
            if !odd.remove(&edge) {
                odd.insert(edge);
            }
        }
    }
    odd
}

#[test]
fn objects_keep_ids_names_and_flags() {
    let glass = PartInput {
        translucent: true,
        class: Some("Glass".into()),
        ..wall_of_squares(2, 2, &[])
    };
    let frame = PartInput {
        class: Some("Frame".into()),
        ..wall_of_squares(5, 1, &[])
    };
    let objects = vec![
        ObjectInput {
            name: Some("window".into()),
            parts: vec![glass, frame],
        },
        ObjectInput::default(),
        ObjectInput {
            name: None,
            parts: vec![wall_of_squares(1, 1, &[])],
        },
    ];
    let scene_input = SceneInput {
        objects,
        source_name: "test".into(),
    };
    let (scene, _) = build(scene_input.clone());
    let names: Vec<&str> = scene.objects().iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["window", "1", "2"]);
    assert_eq!(scene.objects()[0].class.as_deref(), Some("Glass"));
    let flags: Vec<bool> = scene.polygons().map(|p| p.occludes).collect();
    assert_eq!(flags, [false, true, true]);
    let only = OccluderPolicy::Only(vec!["glass".into()]);
    let (scene, report) = SceneBuilder::new(scene_input)
        .policy(only)
        .build()
        .expect("valid");
    assert_eq!(
        scene.polygons().map(|p| p.occludes).collect::<Vec<_>>(),
        [true, false, false]
    );
    assert_eq!(report.occluders, 1);
}

#[test]
fn repairs_are_counted_by_object() {
    let good = wall_of_squares(1, 1, &[]);
    let mut bad = wall_of_squares(1, 1, &[]);
    bad.vertices.extend([[0.5, 0.0, 0.5], [0.0, 0.7, 3.0]]);
    bad.faces.push(&[0, 0, 1]);
    bad.faces.push(&[0, 4, 2]);
    bad.faces.push(&[2, 0, 1]);
    bad.faces.push(&[0, 1, 2, 5]);
    let (_, report) = build(input(vec![vec![good], vec![bad]]));
    assert_eq!(report.repairs.len(), 1);
    let repairs = &report.repairs[0];
    assert_eq!((repairs.object.0, repairs.name.as_str()), (1, "1"));
    assert_eq!(
        (
            repairs.counts.degenerate,
            repairs.counts.duplicate,
            repairs.counts.triangulated
        ),
        (2, 1, 1)
    );
}

#[test]
fn bad_input_is_refused_by_name_and_place() {
    let message = |input: SceneInput, step| {
        SceneBuilder::new(input)
            .grid(step)
            .build()
            .map(|_| ())
            .expect_err("bad")
            .to_string()
    };
    let mut nan = wall_of_squares(1, 1, &[]);
    nan.vertices[2][1] = f64::NAN;
    let text = message(input(vec![vec![], vec![nan]]), None);
    assert!(
        text.contains("test: object 1: vertex 2 is (1, NaN, 1)"),
        "{text}"
    );
    let mut far = wall_of_squares(1, 1, &[]);
    far.faces.push(&[0, 1, 99]);
    let text = message(input(vec![vec![far]]), None);
    assert!(
        text.contains("face 2 refers to vertex 99, but there are only 4"),
        "{text}"
    );
    assert!(message(input(vec![]), None).contains("no triangles"));
    let speck = wall_of_squares(1, 1, &[]);
    assert!(message(input(vec![vec![speck.clone()]]), Some(100.0)).contains("no triangles"));
    let text = message(input(vec![vec![speck.clone()]]), Some(1e-9));
    assert!(text.contains("use a step of"), "{text}");
    let far_cells = Some(([0.0; 3], [f64::INFINITY; 3]));
    let result = SceneBuilder::new(input(vec![vec![speck]]))
        .cells_box(far_cells)
        .build();
    assert!(matches!(result, Err(BuildError::BadCellsBox { .. })));
}

#[test]
fn huge_and_tiny_coordinates_do_not_panic() {
    for scale in [1e-300, 1e-30, 1e30, 1e300, 8e307] {
        let mut wall = wall_of_squares(2, 2, &[]);
        wall.vertices.iter_mut().flatten().for_each(|c| *c *= scale);
        match SceneBuilder::new(input(vec![vec![wall]])).build() {
            Ok((scene, _)) => assert_eq!(scene.sanity_check(), Ok(())),
            Err(error) => assert!(
                matches!(error, BuildError::NoTriangles { .. }),
                "{scale}: {error}"
            ),
        }
    }
}

#[test]
fn the_scene_is_the_same_for_any_number_of_threads() {
    let objects = (0..40)
        .map(|i| vec![wall_of_squares(3 + i % 5, 2, &[[1, 1]])])
        .collect();
    let input = input(objects);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let (scene, report) = pool.install(|| build(input.clone()));
        let corners: Vec<_> = scene.polygons().flat_map(|p| p.corners.to_vec()).collect();
        (corners, scene.kd().nodes().to_vec(), report)
    };
    assert_eq!(run(1), run(4));
}

/// A soup of triangles and quads on a coarse grid: full of shared edges, overlaps and degeneracy.
fn soup(
    limit: i32,
    corners: std::ops::Range<usize>,
    faces: usize,
) -> impl Strategy<Value = PartInput> {
    let vertex = prop::array::uniform3(-limit..=limit).prop_map(|p| p.map(f64::from));
    let face = prop::collection::vec(0..24_u32, corners);
    let lists = (
        prop::collection::vec(vertex, 24),
        prop::collection::vec(face, 1..faces),
    );
    lists.prop_map(|(vertices, lists)| {
        let mut faces = Faces::default();
        lists.iter().for_each(|list| faces.push(list));
        PartInput {
            vertices,
            faces,
            ..PartInput::default()
        }
    })
}

/// A plane soup: unit triangles of a lattice, many adjacent, some twice.
fn flat_soup() -> impl Strategy<Value = PartInput> {
    let triangle = (0..6_i32, 0..6_i32, 0..4_usize);
    prop::collection::vec(triangle, 1..60).prop_map(|list| {
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for (x, y, which) in list {
            let square = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
            let first = vertices.len() as u32;
            // A skew plane, so that no axis is special.
            // Steps of 8, so that nothing is within a grid step of an edge.
            let lift = |[x, y]: [i32; 2]| [x, y, 2 * x - 3 * y].map(|c| f64::from(8 * c));
            vertices.extend((0..4).filter(|k| *k != which).map(|k| lift(square[k])));
            triangles.push([first, first + 1, first + 2]);
        }
        part(vertices, &triangles)
    })
}

/// The 48 motions that map the grid onto itself: permutations with signs.
fn motions() -> impl Iterator<Item = impl Fn([f64; 3]) -> [f64; 3]> {
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    orders.into_iter().flat_map(|order| {
        (0..8).map(move |signs| {
            move |p: [f64; 3]| {
                std::array::from_fn(|k| {
                    if signs >> k & 1 == 1 {
                        -p[order[k]]
                    } else {
                        p[order[k]]
                    }
                })
            }
        })
    })
}

fn built(part: &PartInput) -> Option<(Scene, BuildReport)> {
    // A step of one and a symmetric box keep the raster fixed under all motions.
    SceneBuilder::new(input(vec![vec![part.clone()]]))
        .grid(Some(1.0))
        .cells_box(Some(([-256.0; 3], [256.0; 3])))
        .build()
        .ok()
}

/// Whether a point of a skew lattice plane, in quarters of its squares, lies in some polygon: by
/// exact signs in (x, y).
fn covered(scene: &Scene, x4: i64, y4: i64) -> bool {
    scene.polygons().any(|polygon| {
        let n = polygon.corners.len();
        let at = |i: usize| polygon.corners[i % n].to_i64();
        let sides: Vec<i64> = (0..n)
            .map(|i| {
                let (a, b) = (at(i), at(i + 1));
                ((b[0] - a[0]) * (8 * y4 - 4 * a[1]) - (b[1] - a[1]) * (8 * x4 - 4 * a[0])).signum()
            })
            .collect();
        sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn any_soup_becomes_a_sane_scene(soup in prop_oneof![soup(3, 3..6, 40), soup(30, 3..6, 40)], minimal: bool) {
        let heuristic = if minimal { KdHeuristic::MinimalSplit } else { KdHeuristic::SurfaceArea };
        let builder = SceneBuilder::new(input(vec![vec![soup.clone()], vec![soup]]));
        if let Ok((scene, _)) = builder.grid(Some(1.0)).heuristic(heuristic).build() {
            prop_assert_eq!(scene.sanity_check(), Ok(()));
        }
    }

    // Triangles only: a face that crosses itself has no triangulation that all motions agree on.
    #[test]
    fn grid_motions_keep_all_counts(soup in prop_oneof![soup(3, 3..4, 16), flat_soup()]) {
        let Some((scene, report)) = built(&soup) else { return Ok(()) };
        for motion in motions() {
            let mut moved = soup.clone();
            moved.vertices.iter_mut().for_each(|p| *p = motion(*p));
            let (other, moved_report) = built(&moved).expect("as valid as before");
            prop_assert_eq!(other.sanity_check(), Ok(()));
            prop_assert_eq!(&moved_report.totals(), &report.totals());
            prop_assert_eq!(other.polygon_count(), scene.polygon_count());
        }
    }

    #[test]
    fn merging_keeps_the_set_of_points(soup in flat_soup()) {
        let Some((scene, _)) = built(&soup) else { return Ok(()) };
        // Single triangles, each an object of its own, are not merged.
        let singles = soup.faces.iter().map(|face| {
            let mut one = Faces::default();
            one.push(face);
            vec![PartInput { faces: one, ..soup.clone() }]
        });
        let apart = SceneBuilder::new(input(singles.collect()))
            .grid(Some(1.0))
            .cells_box(Some(([-256.0; 3], [256.0; 3])))
            .build()
            .expect("valid")
            .0;
        prop_assert_eq!(scene.grid().origin(), apart.grid().origin());
        for (x4, y4) in (-1..26).flat_map(|x| (-1..26).map(move |y| (x, y))) {
            prop_assert_eq!(covered(&scene, x4, y4), covered(&apart, x4, y4), "at {}/4, {}/4", x4, y4);
        }
    }
}
