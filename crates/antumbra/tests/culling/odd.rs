//! Odd input, doors, moving things, coherence.

use antumbra::cull::{
    Camera, CellState, Coherence, CullOptions, Culler, NotADoor, Probability, Selection,
};
use antumbra::scene::synth::{MazeParams, maze};
use antumbra::scene::{Faces, ObjectId, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};

fn wall(x: f64, half: f64) -> ObjectInput {
    let mut faces = Faces::default();
    faces.push(&[0, 1, 2, 3]);
    ObjectInput {
        name: None,
        parts: vec![PartInput {
            vertices: vec![
                [x, -half, -half],
                [x, half, -half],
                [x, half, half],
                [x, -half, half],
            ],
            faces,
            ..PartInput::default()
        }],
    }
}

/// Three walls one behind the other along x; the middle one hides the last.
fn row() -> Scene {
    let objects = vec![wall(1.0, 0.1), wall(2.0, 5.0), wall(9.0, 2.0)];
    let input = SceneInput {
        objects,
        source_name: "row".into(),
    };
    SceneBuilder::new(input).build().expect("a scene").0
}

fn look(eye: [f64; 3], direction: [f64; 3]) -> Camera {
    Camera::new(eye, direction, [0.0, 0.0, 1.0], 60.0, 1.0).expect("a camera")
}

const X: [f64; 3] = [1.0, 0.0, 0.0];

fn ids(culler: &mut Culler, camera: &Camera) -> Vec<u32> {
    culler.cull(camera).objects().iter().map(|o| o.0).collect()
}

#[test]
fn a_wall_hides_what_is_behind_it() {
    let mut culler = Culler::new(&row());
    assert_eq!(ids(&mut culler, &look([0.0; 3], X)), [0, 1]);
    assert_eq!(
        ids(&mut culler, &look([14.0, 0.0, 0.0], [-1.0, 0.0, 0.0])),
        [1, 2]
    );
    assert_eq!(
        ids(&mut culler, &look([0.0; 3], [-1.0, 0.0, 0.0])),
        [0_u32; 0]
    );
    assert!(culler.visible().objects().is_empty() && !culler.visible().contains(ObjectId(0)));
}

#[test]
fn an_eye_in_a_wall_outside_or_far_away_gets_an_answer() {
    let mut culler = Culler::new(&row());
    // In the plane of the middle wall, which then hides nothing.
    let seen = ids(&mut culler, &look([2.0, 0.0, 0.0], X));
    assert!(seen.contains(&1) && seen.contains(&2));
    for far in [1e3, 1e7, 1e12, 1e200, 1e308] {
        let seen = ids(&mut culler, &look([-far, 0.0, 0.0], X));
        assert!(seen.contains(&0) && seen.contains(&1), "{far}: {seen:?}");
    }
}

#[test]
fn an_empty_selection_culls_by_the_frustum_alone() {
    let options = CullOptions {
        potential: 0,
        ..CullOptions::default()
    };
    let mut culler = Culler::with_options(&row(), options);
    assert_eq!(culler.potential_occluders(), 0);
    assert_eq!(ids(&mut culler, &look([0.0; 3], X)), [0, 1, 2]);
    let options = CullOptions {
        max_occluders: 0,
        selection: Selection::Region {
            occluders: 64,
            sweep: true,
        },
        ..CullOptions::default()
    };
    let mut culler = Culler::with_options(&row(), options);
    assert_eq!(ids(&mut culler, &look([0.0; 3], X)), [0, 1, 2]);
}

/// A frame that is no longer calm takes only large occluders: that costs less, and hides no more.
#[test]
fn what_insertion_costs_is_weighed() {
    let input = maze(&MazeParams {
        rooms: 9,
        furniture: 6,
        seed: 5,
    });
    let (scene, _) = SceneBuilder::new(input).build().expect("a maze");
    let sums = |calm_visits| {
        let options = CullOptions {
            calm_visits,
            max_visits: u64::MAX,
            ..CullOptions::default()
        };
        let mut culler = Culler::with_options(&scene, options);
        let (mut visits, mut seen) = (0, 0);
        for i in 0..40 {
            let angle = f64::from(i) * 0.3;
            let eye = [3.0 + f64::from(i) * 0.4, 4.5, 1.6];
            let visible = culler.cull(&look(eye, [angle.cos(), angle.sin(), 0.0]));
            visits += visible.work().tree_visits;
            seen += visible.objects().len();
        }
        (visits, seen)
    };
    let (dear, few) = sums(u64::MAX);
    let (cheap, many) = sums(1);
    assert!(cheap * 2 < dear, "{cheap} visits of {dear}");
    assert!(few <= many, "{few} seen, {many} in haste");
}

#[test]
fn an_empty_scene_shows_nothing() {
    for objects in [vec![], vec![ObjectInput::default()]] {
        let input = SceneInput {
            objects,
            source_name: "empty".into(),
        };
        let Ok((scene, _)) = SceneBuilder::new(input).build() else {
            continue;
        };
        let region = CullOptions {
            selection: Selection::Region {
                occluders: 64,
                sweep: true,
            },
            ..CullOptions::default()
        };
        for options in [CullOptions::default(), CullOptions::tight(), region] {
            let mut culler = Culler::with_options(&scene, options);
            assert_eq!(ids(&mut culler, &look([0.0; 3], X)), [0_u32; 0]);
            assert!(culler.may_see_box([1.0; 3], [2.0; 3]));
        }
    }
}

#[test]
fn doors_open_and_close() {
    let options = CullOptions {
        doors: vec![ObjectId(1)],
        ..CullOptions::default()
    };
    let mut culler = Culler::with_options(&row(), options);
    let camera = look([0.0; 3], X);
    assert_eq!(ids(&mut culler, &camera), [0, 1]);
    culler.set_open(ObjectId(1), true).expect("a door");
    assert_eq!(ids(&mut culler, &camera), [0, 1, 2]);
    culler.set_open(ObjectId(1), false).expect("a door");
    assert_eq!(ids(&mut culler, &camera), [0, 1]);
    assert_eq!(
        culler.set_open(ObjectId(2), true),
        Err(NotADoor(ObjectId(2)))
    );
    assert_eq!(
        culler.set_open(ObjectId(99), true),
        Err(NotADoor(ObjectId(99)))
    );
}

#[test]
fn a_moving_box_is_tested_against_the_tree() {
    let mut culler = Culler::new(&row());
    assert!(
        culler.may_see_box([5.0; 3], [6.0; 3]),
        "before the first frame"
    );
    culler.cull(&look([0.0; 3], X));
    assert!(
        !culler.may_see_box([4.0, -0.5, -0.5], [5.0, 0.5, 0.5]),
        "behind the wall"
    );
    assert!(
        culler.may_see_box([1.5, -0.5, -0.5], [1.8, 0.5, 0.5]),
        "before the wall"
    );
    assert!(
        culler.may_see_box([1.5, -0.5, -0.5], [5.0, 0.5, 0.5]),
        "through the wall"
    );
    assert!(
        !culler.may_see_box([-5.0, -0.5, -0.5], [-4.0, 0.5, 0.5]),
        "behind the eye"
    );
    assert!(culler.may_see_box([-1.0; 3], [1.0; 3]), "around the eye");
    assert!(culler.may_see_box([f64::NAN; 3], [1.0; 3]), "no box");
    assert!(culler.may_see_box([4.0; 3], [f64::INFINITY; 3]), "no box");
}

fn rooms() -> Scene {
    let input = maze(&MazeParams {
        rooms: 8,
        furniture: 6,
        seed: 2,
    });
    SceneBuilder::new(input).build().expect("a scene").0
}

/// Walking speed: 1.5 m/s at 60 frames a second.
const STEP: f64 = 0.025;

/// A walk through a room and a door.
fn walk(culler: &mut Culler) -> (Vec<Vec<u32>>, u64) {
    let mut tests = 0;
    let frames = (0..240).map(|i| {
        let t = f64::from(i) * STEP;
        let camera = look([4.0 + t, 4.5, 1.6], [1.0, (t * 0.7).sin(), 0.0]);
        let seen = ids(culler, &camera);
        tests += culler.visible().work().node_tests;
        seen
    });
    (frames.collect(), tests)
}

#[test]
fn updating_gives_the_same_answer_for_nearly_half_the_tests() {
    let scene = rooms();
    let with = |coherence| {
        let options = CullOptions {
            coherence,
            thorough: true,
            ..CullOptions::default()
        };
        walk(&mut Culler::with_options(&scene, options))
    };
    let (plain, tests) = with(Coherence::NONE);
    let (updated, fewer) = with(Coherence {
        updating: true,
        ..Coherence::NONE
    });
    assert_eq!(plain, updated);
    assert!(fewer as f64 <= 0.55 * tests as f64, "{fewer} of {tests}");
    // Skipping leaves saves more, and shows more.
    let skip = Some(Probability::Fixed(0.5));
    let (skipped, fewest) = with(Coherence {
        updating: true,
        skip,
        ..Coherence::NONE
    });
    assert!(fewest < fewer);
    for (some, more) in plain.iter().zip(&skipped) {
        assert!(some.iter().filter(|o| !more.contains(o)).count() == 0);
    }
}

#[test]
fn cells_tell_what_was_found() {
    let scene = rooms();
    let mut culler = Culler::new(&scene);
    walk(&mut culler);
    for state in [CellState::Outside, CellState::Invisible, CellState::Partial] {
        assert!(culler.cells().any(|c| c.state == state), "{state:?}");
    }
}

#[test]
fn the_same_frames_give_the_same_answers() {
    let scene = rooms();
    let run = || walk(&mut Culler::new(&scene));
    assert_eq!(run(), run());
}
