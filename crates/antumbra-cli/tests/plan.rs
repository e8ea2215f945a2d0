//! Plans from the command line.

mod tool;

use serde_json::Value;
use tool::{Folder, Run};

/// A square room with a gap in a wall inside.
const ROOM: &str = "# a room\n0 0 10 0\n10 0 10 10\n10 10 0 10\n0 10 0 0\n4 4 6 4 screen\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("room.seg", ROOM);
    folder
}

fn plan(folder: &Folder, file: &str, cell: &str, more: &[&str]) -> Run {
    let mut args = vec!["plan", file, "--cell", cell, "--json", "--quiet"];
    args.extend(more);
    folder.run_args(&args, b"")
}

fn fragments(result: &Value, id: u64) -> Value {
    let list = result["visible"].as_array().expect("a list");
    let found = list.iter().find(|v| v["id"] == id);
    found.map_or(Value::Null, |v| v["fragments"].clone())
}

#[test]
fn a_screen_hides_a_part_of_a_wall() {
    let folder = folder();
    let seen = plan(
        &folder,
        "room.seg",
        "1,1 2,1 2,2 1,2",
        &["--isovist", "--check"],
    )
    .json();
    assert_eq!(seen["segments"], 5);
    assert_eq!(seen["accuracy"], "exact");
    assert_eq!(
        fragments(&seen, 1),
        serde_json::json!([[0.0, 0.7], [0.8, 1.0]])
    );
    assert_eq!(fragments(&seen, 4), serde_json::json!([[0.0, 1.0]]));
    assert!(seen["tree_nodes"].as_u64().is_some_and(|n| n > 0));
    let area = seen["isovist"]["area"].as_f64().expect("a number");
    assert!((area - 94.0).abs() < 1e-9, "{area}");
    assert_eq!(seen["isovist"]["open"], false);
    assert_eq!(seen["check"]["hidden_checked"], 5);
    let glass = plan(
        &folder,
        "room.seg",
        "1,1 2,1 2,2 1,2",
        &["--transparent", "Screen"],
    )
    .json();
    assert_eq!(fragments(&glass, 1), serde_json::json!([[0.0, 1.0]]));
    assert_eq!(fragments(&glass, 4), serde_json::json!([[0.0, 1.0]]));
    let near = plan(&folder, "room.seg", "1,1", &["--reach", "2"]).json();
    assert_eq!(fragments(&near, 1), Value::Null);
}

#[test]
fn cells_that_are_no_convex_regions() {
    let folder = folder();
    for (cell, all) in [
        // A point, a segment, a cell with a wall in it, one outside, one in the shape of an L.
        ("1,1", 5),
        ("1,1 1,3", 5),
        ("3,3 7,3 7,5 3,5", 5),
        ("20,20 21,20 21,21 20,21", 2),
        ("1,1 8,1 8,2 2,2 2,8 1,8", 5),
    ] {
        let seen = plan(&folder, "room.seg", cell, &[]).json();
        let count = seen["visible"].as_array().expect("a list").len();
        assert_eq!(count, all, "{cell}: {seen}");
    }
    let entered = plan(&folder, "room.seg", "3,3 7,3 7,5 3,5", &[]).json();
    assert_eq!(entered["accuracy"], "conservative");
    // A room flush with its walls does not see through them.
    let flush = plan(&folder, "room.seg", "0,0 10,0 10,10 0,10", &[]).json();
    assert_eq!(flush["visible"].as_array().expect("a list").len(), 5);
    assert_eq!(flush["tree_nodes"], 0);
}

#[test]
fn owners_of_shared_and_pointlike_segments_are_all_named() {
    let folder = Folder::new();
    folder.write("wall.seg", "0 5 4 5\n6 5 0 5\n2 5 2 5\n-9 9 9 9\n0 0 0 0\n");
    let seen = plan(&folder, "wall.seg", "0,0 6,0 6,1 0,1", &[]).json();
    assert_eq!(fragments(&seen, 0), serde_json::json!([[0.0, 1.0]]));
    assert_eq!(fragments(&seen, 1), serde_json::json!([[0.0, 1.0]]));
    assert_eq!(fragments(&seen, 2), Value::Null);
    assert_eq!(fragments(&seen, 4), serde_json::json!([[0.0, 1.0]]));
    let first = fragments(&seen, 3);
    assert_eq!(first.as_array().map(Vec::len), Some(2), "{first}");
}

#[test]
fn no_result_depends_on_options_or_threads() {
    let folder = Folder::new();
    folder
        .run("gen random-segments --count 400 --seed 3 -o a.seg")
        .done();
    let strip = |run: Run| {
        let mut value = run.json();
        let keep = value["visible"].take();
        keep.to_string()
    };
    let cell = "40,40 52,41 50,50 41,49";
    let usual = strip(plan(&folder, "a.seg", cell, &["--threads", "1"]));
    for more in [
        &["--threads", "3"][..],
        &["--one-tree", "--sweep", "depth-first"],
        &["--test", "conservative"],
        &["--test", "none", "--check"],
    ] {
        assert_eq!(usual, strip(plan(&folder, "a.seg", cell, more)), "{more:?}");
    }
}

#[test]
fn batches_matrices_and_pictures() {
    let folder = folder();
    let square = |id: u32, x: f64, y: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"id":{id}}},"geometry":{{"type":"Polygon","coordinates":[[[{x},{y}],[{},{y}],[{},{}],[{x},{}],[{x},{y}]]]}}}}"#,
            x + 1.0,
            x + 1.0,
            y + 1.0,
            y + 1.0
        )
    };
    let features = [
        square(7, 1.0, 1.0),
        square(8, 4.5, 8.0),
        square(9, 20.0, 1.0),
    ]
    .join(",");
    folder.write(
        "cells.json",
        format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#),
    );
    let batch = folder.run("plan room.seg --cells cells.json --json -q --svg a.svg --line-space l.svg --geojson g.json -o f.json --isovist").json();
    let cells = batch["cells"].as_array().expect("a list");
    assert_eq!(
        cells.iter().map(|c| c["id"].as_i64()).collect::<Vec<_>>(),
        [Some(7), Some(8), Some(9)]
    );
    assert_eq!(cells[2]["visible"].as_array().map(Vec::len), Some(1));
    let svg = String::from_utf8(folder.bytes("a.svg")).expect("text");
    for id in [
        "culled",
        "isovist",
        "extremal-lines",
        "walls",
        "visible",
        "cell",
    ] {
        assert!(svg.contains(&format!("id=\"{id}\"")), "{id}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let lines = String::from_utf8(folder.bytes("l.svg")).expect("text");
    assert!(lines.contains("funnel-0") && !lines.contains("NaN"));
    let drawn: Value = serde_json::from_slice(&folder.bytes("g.json")).expect("JSON");
    assert!(drawn["features"].as_array().is_some_and(|f| f.len() > 10));
    let funnels: Value = serde_json::from_slice(&folder.bytes("f.json")).expect("JSON");
    let one = &funnels["cells"][0]["funnels"][0];
    assert!(
        one["extremal_lines"]
            .as_array()
            .is_some_and(|l| l.len() >= 3),
        "{one}"
    );
    let matrix = folder
        .run("plan room.seg --cells cells.json --matrix --json -q")
        .json();
    let expected = serde_json::json!([
        [true, true, false],
        [true, true, false],
        [false, false, true]
    ]);
    assert_eq!(matrix["matrix"], expected);
    let hidden = plan(
        &folder,
        "room.seg",
        "1,1 2,1 2,2",
        &["--to", "20,1 21,1 21,2"],
    )
    .json();
    assert_eq!(hidden["verdict"], "hidden");
    let seen = plan(&folder, "room.seg", "1,1 2,1 2,2", &["--to", "3,8"]).json();
    assert_eq!(seen["verdict"], "visible");
}

#[test]
fn bad_plans_and_cells_are_refused_with_their_place() {
    let folder = folder();
    folder.write(
        "cut.geojson",
        "{\"type\": \"FeatureCollection\", \"features\": [",
    );
    folder.write("word.seg", "0 0 1 1\n0 0 one 1\n");
    folder.write("path.svg", "<svg>\n<path d=\"M 0 0 L 4 x\"/>\n</svg>");
    folder.write("half.dxf", "0\nSECTION\n2\nENTITIES\n0\nLINE\n");
    folder.write("empty.seg", "");
    folder.write("bytes.seg", b"\xff\xfe\x00\x01");
    for (file, code, says) in [
        ("missing.seg", 4, "cannot be read"),
        ("cut.geojson", 3, "JSON line 1"),
        ("word.seg", 3, "line 2: `one` is not a number"),
        ("path.svg", 3, "line 2: the path data is damaged"),
        ("half.dxf", 3, "stops before its end"),
        ("empty.seg", 3, "the file is empty"),
        ("bytes.seg", 3, "byte 0: this is not text"),
    ] {
        let run = plan(&folder, file, "0,0 1,0 1,1", &["--svg", "out.svg"]);
        let text = run.failure(code);
        assert!(text.starts_with(file) && text.contains(says), "{text}");
    }
    for (cell, says) in [
        ("", "expected points"),
        ("1,2,3 4,5", "expected points"),
        ("0,0 4,4 4,0 0,4", "meets itself"),
    ] {
        let run = plan(&folder, "room.seg", cell, &["--svg", "out.svg"]);
        let text = run.failure(2);
        assert!(text.contains(says), "{text}");
    }
    folder.write(
        "hole.json",
        r#"{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,0]],[[3,1],[4,1],[4,2],[3,1]]]}"#,
    );
    let run = folder.run("plan room.seg --cells hole.json -q");
    assert!(run.failure(3).contains("feature 0: the cell has 1 holes"));
    let run = folder.run_args(
        &["plan", "room.seg", "--cell", "0,0", "--grid", "1e-9", "-q"],
        b"",
    );
    assert!(run.failure(3).contains("use a step of"));
    assert!(!folder.names().iter().any(|n| n.starts_with("out")));
}
