//! What is kept from frame to frame, on measured walks.

use antumbra::cull::{Camera, Coherence, CullOptions, Culler};
use antumbra::scene::{Scene, SceneBuilder};
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
