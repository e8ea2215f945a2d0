//! Culling from the command line.

mod tool;

use std::fmt::Write;
use std::io::Write as _;

use antumbra_testkit::environment::{data, long, skip};
use antumbra_testkit::random::Random;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use tool::Folder;

/// A maze and a walk through it.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.run("gen maze --rooms 5 -o maze.glb").done();
    let line = |i: usize| format!("{} 7.5 1.6 1 0.2 0 0 0 1 60\n", 7.0 + 0.1 * i as f64);
    let path: String = (0..12).map(line).collect();
    folder.write("walk.path", format!("# a walk\n\n{path}"));
    folder
}

fn ids(frame: &Value) -> Vec<u64> {
    let list = frame["visible"].as_array().expect("a list");
    list.iter().map(|v| v.as_u64().expect("an id")).collect()
}

#[test]
fn frames_are_culled_verified_and_drawn() {
    let folder = folder();
    let line = "cull maze.glb --path walk.path --verify --size 320x180 --json --csv a.csv --svg a.svg \
                --top t.svg --frame 5 -o a.json";
    let result = folder.run(line).json();
    let frames = result["frames"].as_array().expect("frames");
    assert_eq!(frames.len(), 12);
    for frame in frames {
        let visible = ids(frame);
        assert!(!visible.is_empty() && visible.is_sorted());
        for key in ["seconds", "tests", "occluders"] {
            assert!(frame[key].is_number(), "{key}");
        }
    }
    for key in [
        "median_seconds",
        "p95_seconds",
        "load_seconds",
        "build_seconds",
    ] {
        assert!(result[key].is_number(), "{key}");
    }
    let verify = &result["verify"];
    assert_eq!(verify["wrong_culls"], serde_json::json!([]));
    assert!(verify["ratio"].as_f64().is_some_and(|r| r >= 1.0));
    let csv = String::from_utf8(folder.bytes("a.csv")).expect("text");
    assert_eq!(csv.lines().count(), 13);
    let columns = |line: &str| line.split(',').count();
    assert!(
        csv.lines()
            .all(|l| columns(l) == columns("a,b,c,d,e,f,g,h,i,j,k,l,m"))
    );
    for (name, part) in [("a.svg", "in the item buffer"), ("t.svg", "#1e3a70")] {
        let svg = String::from_utf8(folder.bytes(name)).expect("text");
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains(part));
    }
}

#[test]
fn no_method_is_wrong_and_threads_change_nothing() {
    let folder = folder();
    let run = |options: &str| {
        let line =
            format!("cull maze.glb --path walk.path --json --verify --size 160x90 {options}");
        let result = folder.run(&line).json();
        assert_eq!(
            result["verify"]["wrong_culls"],
            serde_json::json!([]),
            "{options}"
        );
        let frames = result["frames"].as_array().expect("frames");
        frames.iter().map(ids).collect::<Vec<_>>()
    };
    assert_eq!(run("--threads 1"), run("--threads 2"));
    let everything = run("--preset paper --method f");
    for options in [
        "--preset tight",
        "--preset paper --method fse --best 16",
        "--preset paper --method fme --best 16 --within 9",
        "--preset paper --method fmc",
        "--preset paper --method inner",
        "--select region --region-best 40",
        "--select region-only --region-best 40",
        "--order autopartition",
        "--minimum-cost auto --object-cost 0 --skip auto --propagate auto --reuse-tree",
        "--no-updating --no-polygons",
    ] {
        let called = run(options);
        let count = |frames: &[Vec<u64>]| frames.iter().map(Vec::len).sum::<usize>();
        assert!(
            count(&called) < count(&everything),
            "{options} culls nothing more"
        );
    }
}

#[test]
fn damaged_paths_are_refused_by_line() {
    let folder = folder();
    for (text, part) in [
        ("", "no camera found"),
        ("1 2 3\n", "line 1: 3 values found, ten expected"),
        (
            "0 0 0 1 0 0 0 0 1 60\n0 0 0 1 0 0 0 0 one 60\n",
            "line 2: `one` is not a number",
        ),
        (
            "nan 0 0 1 0 0 0 0 1 60\n",
            "line 1: the camera's eye is not finite",
        ),
        ("0 0 0 1 0 0 0 0 1 0\n", "line 1: a view 0 degrees high"),
        ("0 0 0 0 0 0 0 0 1 60\n", "looks nowhere"),
        ("0 0 0 0 0 1 0 0 1 60\n", "up direction"),
    ] {
        folder.write("bad.path", text);
        let run = folder.run("cull maze.glb --path bad.path --csv out.csv");
        assert!(run.failure(3).contains(part), "{text}: {run:?}");
    }
    folder.write("bad.path", b"\x1f\x8bnothing");
    let run = folder.run("cull maze.glb --path bad.path");
    assert!(
        run.failure(3).contains("the gzip data is damaged"),
        "{run:?}"
    );
    folder.write("bad.path", b"\xff\xfe\x00");
    folder.run("cull maze.glb --path bad.path").failure(3);
    folder
        .run("cull maze.glb --path walk.path --verify --size 100x100")
        .failure(2);
    folder.run("cull maze.glb --path gone.path").failure(4);
    folder.run("cull gone.glb --path walk.path").failure(4);
    folder
        .run("cull maze.glb --path walk.path --top t.svg --frame 12")
        .failure(2);
    folder
        .run("cull maze.glb --path walk.path --doors portcullis")
        .failure(2);
    folder
        .run("cull maze.glb --path walk.path -o walk.path")
        .failure(2);
    assert!(
        !folder
            .names()
            .iter()
            .any(|n| n == "out.csv" || n == "t.svg")
    );
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let folder = folder();
    for (options, part) in [
        ("--aspect 16/9", "16:9"),
        ("--aspect 1e300:1e-300", "1000 times"),
        ("--top a.svg --svg a.svg", "two results"),
        ("--csv a.out", "is .csv"),
        ("--frame 3", "--top"),
        ("--skip 1.5", "from 0 to 1"),
        ("--minimum-cost much", "a number of polygons, or auto"),
        ("--open 3", "--doors"),
    ] {
        let run = folder.run(&format!("cull maze.glb --path walk.path {options}"));
        assert!(run.failure(2).contains(part), "{options}: {run:?}");
    }
    assert!(!folder.names().iter().any(|n| n.starts_with("a.")));
}

#[test]
fn paths_are_read_compressed_or_with_a_mark_before_them() {
    let folder = folder();
    let plain = folder.bytes("walk.path");
    let visible = |path: &str| {
        let result = folder
            .run(&format!("cull maze.glb --path {path} --json"))
            .json();
        let frames = result["frames"].as_array().expect("frames");
        frames.iter().map(ids).collect::<Vec<_>>()
    };
    let expected = visible("walk.path");
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&plain).expect("memory");
    folder.write("walk.path.gz", packed.finish().expect("memory"));
    assert_eq!(visible("walk.path.gz"), expected);
    folder.write("marked.path", [b"\xef\xbb\xbf".as_slice(), &plain].concat());
    assert_eq!(visible("marked.path"), expected);
}

#[test]
fn eyes_in_walls_outside_and_far_away_get_an_answer() {
    let folder = folder();
    let (ahead, back) = ("1 0 0 0 0 1 60", "-1 0 0 0 0 1 60");
    let mut path = String::new();
    for eye in [
        "0 7.5 1.6",
        "7.5 0 0",
        "7.5 7.5 0",
        "-40 7.5 1.6",
        "7.5 7.5 90",
        "-1e7 7.5 1.6",
        "1e300 0 0",
    ] {
        writeln!(path, "{eye} {ahead}\n{eye} {back}").expect("a string");
    }
    // The narrowest and the widest view.
    writeln!(
        path,
        "7 7.5 1.6 1 0 0 0 0 1 0.001\n7 7.5 1.6 1 0 0 0 0 1 179.9"
    )
    .expect("a string");
    folder.write("odd.path", path);
    for preset in ["fast", "tight", "paper"] {
        let line = format!(
            "cull maze.glb --path odd.path --preset {preset} --verify --size 160x90 --json"
        );
        let result = folder.run(&line).json();
        assert_eq!(
            result["verify"]["wrong_culls"],
            serde_json::json!([]),
            "{preset}"
        );
        assert_eq!(result["frames"].as_array().map(Vec::len), Some(16));
    }
}

/// 100,000 random views of real scenes, inside, in walls and outside, against item buffers of 320 x 180
/// pixels; a few hundred of them in the short run.
#[test]
fn random_views_of_measured_scenes_cull_nothing_that_has_a_pixel() {
    let count = if long() { 25_000 } else { 50 };
    for (seed, name) in ["duplex", "kit_institute", "quake_e1m1", "delft_block"]
        .iter()
        .enumerate()
    {
        let Some(walk) = data().map(|d| d.join("walk")).filter(|d| d.is_dir()) else {
            skip("no measured walks");
            return;
        };
        // Around the eyes of the walk, which are in rooms and streets.
        let path = std::fs::read_to_string(walk.join(format!("{name}.path"))).expect("a path");
        let eyes: Vec<[f64; 3]> = path
            .lines()
            .filter(|l| !l.starts_with('#'))
            .map(|l| {
                let mut words = l.split_whitespace().map(|w| w.parse().expect("a number"));
                [(); 3].map(|()| words.next().expect("an eye"))
            })
            .collect();
        let mut random = Random::new(seed as u64 + 1);
        let mut views = String::new();
        for _ in 0..count {
            let eye = eyes[random.index(eyes.len())];
            let reach = [0.5, 3.0, 30.0][random.index(3)];
            let mut around = |size: f64| size * (2.0 * random.unit() - 1.0);
            let (x, y, z) = (
                eye[0] + around(reach),
                eye[1] + around(reach),
                eye[2] + around(reach / 3.0),
            );
            let (dx, dy, dz) = (around(1.0), around(1.0), around(0.5));
            let angle = 60.0 + around(40.0);
            writeln!(views, "{x} {y} {z} {dx} {dy} {dz} 0.01 0.02 1 {angle}").expect("a string");
        }
        let folder = Folder::new();
        folder.write("views.path", views);
        let scene = walk.join(format!("{name}.glb"));
        for preset in ["fast", "tight"] {
            let line = format!(
                "cull {} --path views.path --verify --size 320x180 --preset {preset} --json --quiet",
                scene.display()
            );
            let result = folder.run(&line).json();
            assert_eq!(
                result["verify"]["wrong_culls"],
                serde_json::json!([]),
                "{name}, {preset}"
            );
        }
    }
}
