//! Rebuilds Figures 4.11 to 4.14 of [Bittner02]: node tests and times of the coherence methods over the speed
//! of a walk, and over the probability to skip. Two measured walks are slowed down or sped up.
//!
//! Drawing is not measured, it is counted: [`DRAW`] says what it costs.
#![allow(clippy::print_stdout, reason = "prints tables")]

mod chart;
mod walk;

use std::error::Error;
use std::time::Instant;

use antumbra::cull::{Coherence, CullOptions, Culler, Probability};
use antumbra_testkit::environment::data;

use chart::{Axes, Curve, Panel, svg};
use walk::Walk;

/// Meters a frame at relative speed one: 1.4 m/s, at the ten frames a second of the thesis' machine.
const WALKING: f64 = 0.14;
const SPEEDS: [f64; 6] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0];
const SKIPS: [f64; 7] = [0.0, 0.2, 0.4, 0.5, 0.6, 0.8, 0.9];
/// Milliseconds to draw an object, and a triangle: a draw call of WebGL or a phone, 100 million triangles a second.
const DRAW: [f64; 2] = [0.02, 1e-5];
/// Frames of a run, spread over the walk in pieces.
const FRAMES: usize = 900;
const RUNS: usize = 5;

const SCENES: [&str; 2] = ["duplex", "kit_institute"];
const COLORS: [&str; 4] = ["#222222", "#2563a8", "#308040", "#c2410c"];

/// Means over the frames.
#[derive(Default)]
struct Measured {
    tests: f64,
    objects: f64,
    /// Milliseconds.
    culling: f64,
    drawing: f64,
}

impl Measured {
    fn frame(&self) -> f64 {
        self.culling + self.drawing
    }

    fn rest(&self) -> String {
        format!(
            "{:.1}; {:.3}, {:.3}",
            self.objects, self.culling, self.drawing
        )
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = data().map(|d| d.join("walk")).filter(|d| d.is_dir()) else {
        println!(
            "skipped: the measured walks are absent, docs/figures/cull-*.svg stay as they are"
        );
        return Ok(());
    };
    let walks = SCENES.map(|name| Walk::read(&folder, name));
    let mut over_speed = Vec::new();
    let mut over_skip = Vec::new();
    for (walk, name) in walks.into_iter().zip(SCENES) {
        let walk = walk?;
        over_speed.push((name, speeds(name, &walk)));
        over_skip.push((name, skips(name, &walk)));
    }
    let speed = "relative speed of the walk (1 is 0.14 m a frame)";
    let skip = "probability to skip";
    for (file, title, across, up, value) in [
        (
            "tests",
            "Node tests a frame, after Figure 4.11",
            speed,
            "node tests",
            (|m| m.tests) as fn(&Measured) -> f64,
        ),
        (
            "time",
            "Time of culling a frame, after Figure 4.12",
            speed,
            "ms",
            |m| m.culling,
        ),
        (
            "frame",
            "Culling and drawing a frame, after Figure 4.13",
            speed,
            "ms",
            Measured::frame,
        ),
        (
            "skip",
            "Culling and drawing a frame, after Figure 4.14",
            skip,
            "ms",
            Measured::frame,
        ),
    ] {
        let over = if file == "skip" {
            &over_skip
        } else {
            &over_speed
        };
        let panel = |(name, curves): &(&str, Vec<Measures>)| Panel {
            title: (*name).to_owned(),
            curves: curves.iter().map(|c| c.curve(value)).collect(),
        };
        let panels: Vec<Panel> = over.iter().map(panel).collect();
        let axes = Axes {
            across,
            up,
            logarithmic: across == speed,
        };
        let path = format!("docs/figures/cull-{file}.svg");
        std::fs::write(&path, svg(title, &axes, &panels))?;
        println!("{path}");
    }
    Ok(())
}

/// What was measured with one set of options.
struct Measures {
    name: String,
    color: &'static str,
    points: Vec<(f64, Measured)>,
}

impl Measures {
    fn new((name, color): (&str, &'static str)) -> Self {
        Self {
            name: name.to_owned(),
            color,
            points: Vec::new(),
        }
    }

    fn curve(&self, value: fn(&Measured) -> f64) -> Curve {
        Curve {
            name: self.name.clone(),
            color: self.color,
            points: self.points.iter().map(|(x, m)| [*x, value(m)]).collect(),
        }
    }
}

/// The methods of the thesis, named as there.
fn methods() -> [(&'static str, Coherence); 4] {
    let half = Some(Probability::Fixed(0.5));
    let updating = Coherence {
        updating: true,
        ..Coherence::NONE
    };
    let propagating = Coherence {
        propagation: half,
        ..updating
    };
    let skipping = Coherence {
        skip: half,
        ..propagating
    };
    [
        ("A: every node", Coherence::NONE),
        ("B: hierarchy updating", updating),
        ("C: B + propagation 0.5", propagating),
        ("D: C + skipping 0.5", skipping),
    ]
}

/// Figures 4.11 to 4.13.
fn speeds(name: &str, walk: &Walk) -> Vec<Measures> {
    println!("\n{name}: node tests, saved against A; objects; ms of culling, of drawing\n");
    let (names, ways): (Vec<&str>, Vec<Coherence>) = methods().into_iter().unzip();
    let mut all: Vec<Measures> = names.into_iter().zip(COLORS).map(Measures::new).collect();
    for speed in SPEEDS {
        for (one, m) in all.iter_mut().zip(measure(walk, speed, &ways)) {
            one.points.push((speed, m));
        }
    }
    for one in &all {
        let cells = one
            .points
            .iter()
            .zip(&all[0].points)
            .map(|((_, m), (_, a))| {
                let saved = 100.0 * (1.0 - m.tests / a.tests);
                format!("{:.0}, {saved:.0} %; {}", m.tests, m.rest())
            });
        println!(
            "| {} | {} |",
            one.name,
            cells.collect::<Vec<_>>().join(" | ")
        );
    }
    all
}

/// Figure 4.14: over the probability to skip, at three speeds.
fn skips(name: &str, walk: &Walk) -> Vec<Measures> {
    println!("\n{name}, skipping {SKIPS:?}: node tests; objects; ms of culling, of drawing\n");
    let ways = SKIPS.map(|skip| Coherence {
        updating: true,
        skip: Some(Probability::Fixed(skip)),
        ..Coherence::NONE
    });
    let mut all = Vec::new();
    for (speed, color) in [0.125, 0.5, 2.0].into_iter().zip(&COLORS[1..]) {
        let mut one = Measures::new((&format!("speed {speed}"), color));
        one.points = SKIPS.into_iter().zip(measure(walk, speed, &ways)).collect();
        let cells = one
            .points
            .iter()
            .map(|(_, m)| format!("{:.0}; {}", m.tests, m.rest()));
        println!("| {speed} | {} |", cells.collect::<Vec<_>>().join(" | "));
        all.push(one);
    }
    all
}

/// The means of a walk at some speed, for several methods. A frame's time is the least of its runs, and the methods
/// take turns: the machine may be busy.
fn measure(walk: &Walk, speed: f64, ways: &[Coherence]) -> Vec<Measured> {
    let cameras = walk.cameras(WALKING * speed, FRAMES);
    let mut times = vec![vec![f64::INFINITY; cameras.len()]; ways.len()];
    let mut all: Vec<Measured> = ways.iter().map(|_| Measured::default()).collect();
    let share = 1.0 / cameras.len().max(1) as f64;
    for run in 0..RUNS {
        for ((&coherence, times), mean) in ways.iter().zip(&mut times).zip(&mut all) {
            let options = CullOptions {
                coherence,
                ..CullOptions::default()
            };
            let mut culler = Culler::with_options(&walk.scene, options);
            for (camera, time) in cameras.iter().zip(times) {
                let start = Instant::now();
                let visible = culler.cull(camera);
                *time = time.min(start.elapsed().as_secs_f64() * 1e3);
                if run == 0 {
                    let triangles: f64 = visible.objects().iter().map(|o| walk.triangles(*o)).sum();
                    let objects = visible.objects().len() as f64;
                    mean.tests += share * visible.work().node_tests as f64;
                    mean.objects += share * objects;
                    mean.drawing += share * (DRAW[0] * objects + DRAW[1] * triangles);
                }
            }
        }
    }
    for (mean, times) in all.iter_mut().zip(times) {
        mean.culling = share * times.iter().sum::<f64>();
    }
    all
}
