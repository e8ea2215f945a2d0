//! What is kept from frame to frame, on measured walks.

use antumbra::cull::{Camera, Coherence, CullOptions, Culler, MinimumCost, Selection};
use antumbra::scene::{Faces, ObjectId, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};
use antumbra_io::read_scene;
use antumbra_testkit::environment::{data, long, skip};

/// A man walks 1.4 m/s; the machine of [Bittner02, 4.12] drew about ten frames a second.
const WALKING: f64 = 0.14;

/// A scene and the eyes and directions of its walk; none if it is absent.
fn measured(name: &str) -> Option<(Scene, Vec<[[f64; 3]; 2]>)> {
    let folder = data()?.join("walk");
    let input = read_scene(&folder.join(format!("{name}.glb"))).ok()?;
    let path = std::fs::read_to_string(folder.join(format!("{name}.path"))).ok()?;
    let (scene, _) = SceneBuilder::new(input).build().expect("a sound scene");
    let lines = path.lines().filter(|l| !l.starts_with('#'));
    let station = |line: &str| {
        let mut words = line
            .split_whitespace()
            .map(|w| w.parse().expect("a number"));
        let mut three = || [(); 3].map(|()| words.next().expect("ten numbers"));
        [three(), three()]
    };
    Some((scene, lines.map(station).collect()))
}

/// Cameras a step apart along the walk.
fn slowly(stations: &[[[f64; 3]; 2]], step: f64, count: usize) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for pair in stations.windows(2) {
        let [[a, u], [b, v]] = [pair[0], pair[1]];
        let length = (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
        let parts = (length / step).ceil();
        for i in 0..parts as u32 {
            let t = f64::from(i) / parts;
            let mix = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] {
                std::array::from_fn(|k| p[k] + t * (q[k] - p[k]))
            };
            let up = [0.0, 0.0, 1.0];
            cameras.extend(Camera::new(mix(a, b), mix(u, v), up, 60.0, 16.0 / 9.0).ok());
        }
    }
    cameras.truncate(count);
    cameras
}

#[test]
fn updating_saves_45_percent_of_node_tests_at_walking_speed_in_every_scene() {
    for name in ["duplex", "kit_institute", "quake_e1m1", "delft_block"] {
        let Some((scene, stations)) = measured(name) else {
            skip(&format!("walk/{name} is absent"));
            continue;
        };
        let cameras = slowly(&stations, WALKING, if long() { 4_000 } else { 200 });
        for options in [CullOptions::default(), CullOptions::tight()] {
            let tests = |updating| {
                let coherence = Coherence {
                    updating,
                    ..Coherence::NONE
                };
                let options = CullOptions {
                    coherence,
                    ..options.clone()
                };
                let mut culler = Culler::with_options(&scene, options);
                let count = |c: &Camera| culler.cull(c).work().node_tests;
                cameras.iter().map(count).sum::<u64>()
            };
            let (all, updated) = (tests(false), tests(true));
            assert!(
                updated as f64 <= 0.55 * all as f64,
                "{name}: {updated} of {all}"
            );
        }
    }
}

#[test]
fn occluders_of_regions_hide_nearly_as_much_as_those_found_on_the_way() {
    let Some((scene, stations)) = measured("duplex") else {
        skip("walk/duplex is absent");
        return;
    };
    let cameras = slowly(&stations, 0.4, 200);
    let called = |selection| {
        let options = CullOptions {
            selection,
            ..CullOptions::default()
        };
        let mut culler = Culler::with_options(&scene, options);
        let count = |c: &Camera| culler.cull(c).objects().len();
        cameras.iter().map(count).sum::<usize>()
    };
    let swept = called(Selection::Sweep);
    let region = |occluders, sweep| called(Selection::Region { occluders, sweep });
    let (alone, with_sweep) = (region(128, false), region(64, true));
    assert!(
        100 * alone <= 115 * swept && 100 * with_sweep <= 103 * swept,
        "{alone} and {with_sweep}, {swept} swept"
    );
}

#[test]
fn automatic_minimum_cost_gives_up_only_what_is_cheap_to_draw() {
    let Some((scene, stations)) = measured("duplex") else {
        skip("walk/duplex is absent");
        return;
    };
    let cameras = slowly(&stations, 0.4, 200);
    let mut triangles = vec![0_u64; scene.objects().len()];
    for polygon in scene.polygons() {
        triangles[polygon.object.index()] += polygon.corners.len() as u64 - 2;
    }
    let run = |minimum_cost| {
        let options = CullOptions {
            minimum_cost,
            ..CullOptions::default()
        };
        let mut culler = Culler::with_options(&scene, options);
        let (mut drawn, mut tests) = (0, 0);
        for camera in &cameras {
            let visible = culler.cull(camera);
            let drawn_now = visible.objects().iter().map(|o| triangles[o.index()]);
            drawn += drawn_now.sum::<u64>();
            tests += visible.work().node_tests + visible.work().item_tests;
        }
        (drawn, tests)
    };
    let auto = |object, triangle| run(MinimumCost::Automatic { object, triangle });
    let (drawn, tests) = run(MinimumCost::None);
    // Draw calls are dear: every test pays.
    assert_eq!(auto(1e6, 2.0), (drawn, tests));
    let (more, fewer) = auto(0.0, 2.0);
    assert!(fewer < tests && drawn <= more && 10 * more < 12 * drawn);
    // If triangles cost next to nothing, so do objects.
    let (most, fewest) = auto(0.0, 0.1);
    assert!(fewest < fewer && more < most);
}

/// Three walls one behind the other along x; the middle one, a door, hides the last.
fn row(reuse_tree: bool) -> Culler {
    let wall = |x: f64, half: f64| {
        let mut faces = Faces::default();
        faces.push(&[0, 1, 2, 3]);
        let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
        let part = PartInput {
            vertices: corners.map(|(y, z)| [x, y, z]).to_vec(),
            faces,
            ..PartInput::default()
        };
        ObjectInput {
            name: None,
            parts: vec![part],
        }
    };
    let input = SceneInput {
        objects: vec![wall(1.0, 0.1), wall(2.0, 5.0), wall(9.0, 2.0)],
        source_name: "row".into(),
    };
    let (scene, _) = SceneBuilder::new(input).build().expect("a scene");
    let coherence = Coherence {
        updating: true,
        reuse_tree,
        ..Coherence::NONE
    };
    let options = CullOptions {
        coherence,
        doors: vec![ObjectId(1)],
        ..CullOptions::default()
    };
    Culler::with_options(&scene, options)
}

fn look(culler: &mut Culler, x: f64, degrees: f64) -> (Vec<u32>, bool) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let camera = Camera::new([x, 0.0, 0.0], [cos, sin, 0.0], [0.0, 0.0, 1.0], 60.0, 1.0);
    let visible = culler.cull(&camera.expect("a camera"));
    let ids = visible.objects().iter().map(|o| o.0).collect();
    (ids, visible.work().tree_reused)
}

#[test]
fn a_turning_head_keeps_its_tree_and_a_resting_one_its_answer() {
    let mut culler = row(true);
    assert_eq!(look(&mut culler, 0.0, 0.0), (vec![0, 1], false));
    assert_eq!(look(&mut culler, 0.0, 0.0), (vec![0, 1], true));
    assert_eq!(culler.visible().work().node_tests, 0);
    // All around, what is outside the frustum is not called visible, and what is behind is hidden.
    for degrees in 1..=360 {
        let (seen, reused) = look(&mut culler, 0.0, f64::from(degrees));
        let from_anew = look(&mut row(false), 0.0, f64::from(degrees)).0;
        assert!(
            reused && seen == from_anew,
            "{degrees}: {seen:?}, {from_anew:?}"
        );
    }
    assert_eq!(look(&mut culler, 0.5, 0.0), (vec![0, 1], false));
}

#[test]
fn a_door_ends_the_use_of_the_tree_and_a_moving_box_does_not() {
    let mut culler = row(true);
    look(&mut culler, 0.0, 0.0);
    assert!(!culler.may_see_box([4.0, -0.5, -0.5], [5.0, 0.5, 0.5]));
    assert!(culler.may_see_box([1.4, -0.5, -0.5], [1.6, 0.5, 0.5]));
    assert!(look(&mut culler, 0.0, 1.0).1);
    culler.set_open(ObjectId(1), true).expect("a door");
    assert_eq!(look(&mut culler, 0.0, 1.0), (vec![0, 1, 2], false));
    assert!(culler.may_see_box([4.0, -0.5, -0.5], [5.0, 0.5, 0.5]));
    // Said again, it changes nothing.
    culler.set_open(ObjectId(1), true).expect("a door");
    assert_eq!(look(&mut culler, 0.0, 2.0), (vec![0, 1, 2], true));
    culler.set_open(ObjectId(1), false).expect("a door");
    assert_eq!(look(&mut culler, 0.0, 2.0), (vec![0, 1], false));
}
