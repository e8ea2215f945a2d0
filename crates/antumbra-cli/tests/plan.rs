//! Plans from the command line.

mod tool;

use serde_json::Value;
use tool::plans::{folder, fragments, plan};
use tool::{Folder, Run};

/// Neither of two cells sees through a wall along the side of the other, whichever is asked first.
#[test]
fn walls_along_cells_hide_both_ways() {
    let folder = folder();
    let square = |x: f64, y: f64, size: f64| {
        let (u, v) = (x + size, y + size);
        serde_json::json!({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon",
            "coordinates": [[[x, y], [u, y], [u, v], [x, v], [x, y]]]}})
    };
    let (room, outside) = (square(0.0, 0.0, 10.0), square(20.0, 3.0, 2.0));
    for features in [[&room, &outside], [&outside, &room]] {
        let cells = serde_json::json!({"type": "FeatureCollection", "features": features});
        folder.write("cells.json", cells.to_string());
        let found = folder.run("plan room.seg --cells cells.json --matrix --json -q");
        assert_eq!(found.json()["pairs"], 0);
    }
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

/// Witnesses meet what they see where its fragment is, also where they come from crossings and numbers are long.
#[test]
fn witnesses_end_within_their_fragments() {
    let folder = Folder::new();
    folder.write(
        "far.seg",
        "-8388000 -8388000 -8388000 -8387999\n-1 0 -1 1\n-2796000 0 1 1\n-8388000 -1 1 8387999\n",
    );
    let more = ["--grid", "1", "--witnesses"];
    let seen = plan(&folder, "far.seg", "0,8388000 0,2396571", &more).json();
    let low = fragments(&seen, 1)[0][0].as_f64().expect("a number");
    let lines = seen["witnesses"].as_array().expect("a list");
    let line = lines.iter().find(|w| w["ids"][0] == 1).expect("a witness");
    let to = [0, 1].map(|k| line["to"][k].as_f64().expect("a number"));
    assert_eq!(to[0], -1.0);
    assert!(low < to[1] && to[1] < 1.0, "{low} {to:?}");
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
    let batch = folder.run("plan room.seg --cells cells.json --json -q --svg a.svg --geojson g.json -o f.json --isovist").json();
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
    // A point is drawn as a mark that can be seen.
    let pictures = ["--svg", "p.svg", "--line-space", "l.svg"];
    plan(&folder, "room.seg", "5,5", &pictures).done();
    let svg = String::from_utf8(folder.bytes("p.svg")).expect("text");
    let mark = svg.split("id=\"cell\"").nth(1).expect("a cell");
    assert_eq!(mark.matches(" L").count(), 3, "{mark}");
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

/// A house of 111 x 74 m by longitude and latitude, and what is asked of it in degrees.
#[test]
fn degrees_are_projected_and_come_back_as_degrees() {
    let folder = Folder::new();
    let house = [
        [14.30, 48.30],
        [14.301, 48.30],
        [14.301, 48.301],
        [14.30, 48.301],
        [14.30, 48.30],
    ];
    folder.write(
        "house.geojson",
        serde_json::json!({"type": "LineString", "coordinates": house}).to_string(),
    );
    let cell = serde_json::json!({"type": "Point", "coordinates": [14.3005, 48.3004]});
    folder.write("cells.geojson", cell.to_string());
    let run = folder.run("plan house.geojson --cell 14.3005,48.3004 --to 14.3,48.3002 --json");
    assert!(
        run.stderr
            .contains("projected to metres around (14.3005, 48.3005)")
    );
    assert_eq!(run.json()["verdict"], "visible");
    let seen = folder
        .run("plan house.geojson --cell 14.3005,48.3004 --isovist --geojson seen.geojson --json -q")
        .json();
    assert_eq!(
        seen["projected_around"],
        serde_json::json!([14.3005, 48.3005])
    );
    assert_eq!(seen["visible"].as_array().map(Vec::len), Some(4));
    let area = seen["isovist"]["area"].as_f64().expect("a number");
    assert!((area / (74.18 * 111.2) - 1.0).abs() < 1e-3, "{area}");
    assert_eq!(seen["isovist"]["open"], false);
    let drawn: Value = serde_json::from_slice(&folder.bytes("seen.geojson")).expect("JSON");
    let features = drawn["features"].as_array().expect("a list");
    for (i, feature) in features[..4].iter().enumerate() {
        let line = &feature["geometry"]["coordinates"][0];
        for (k, end) in house[i..i + 2].iter().enumerate() {
            for axis in 0..2 {
                let found = line[k][axis].as_f64().expect("a number");
                assert!((found - end[axis]).abs() < 1e-9, "{line}");
            }
        }
    }
    let corner = &features[4]["geometry"]["coordinates"][0][0][0];
    assert!((corner[0].as_f64().expect("a number") - 14.3005).abs() < 0.001);
    let cells = folder.run("plan house.geojson --cells cells.geojson --json -q");
    assert_eq!(cells.json()["cells"][0]["visible"], seen["visible"]);
    // Lengths, if that is said.
    let planar = folder.run("plan house.geojson --crs planar --cell 14.3005,48.3004 --json -q");
    assert_eq!(planar.json()["projected_around"], Value::Null);
}

/// A cell in the shape of an L sees what its parts see together.
#[test]
fn a_cell_that_is_not_convex_sees_what_its_parts_see() {
    let folder = Folder::new();
    folder
        .run("gen random-segments --count 300 --seed 5 -o a.seg")
        .done();
    let ids = |cell: &str| -> Vec<u64> {
        let seen = plan(&folder, "a.seg", cell, &["--check"]).json();
        let list = seen["visible"].as_array().expect("a list");
        list.iter().filter_map(|v| v["id"].as_u64()).collect()
    };
    let whole = ids("20,20 60,20 60,24 24,24 24,70 20,70");
    let mut parts = ids("20,20 60,20 60,24 20,24");
    parts.extend(ids("20,20 24,20 24,70 20,70"));
    parts.sort_unstable();
    parts.dedup();
    assert_eq!(whole, parts);
}

/// Files of a batch are equal byte for byte, whatever the threads.
#[test]
fn batches_do_not_depend_on_threads() {
    let Some(data) = antumbra_testkit::environment::data() else {
        antumbra_testkit::environment::skip("no measured data");
        return;
    };
    let folder = Folder::new();
    let city = data.join("city/linz_1km2.geojson.gz").display().to_string();
    let cells = std::fs::read_to_string(data.join("city/linz_8km2_viewcells.geojson"));
    let mut cells: Value = serde_json::from_str(&cells.expect("cells")).expect("JSON");
    let features = cells["features"].as_array_mut().expect("a list");
    features.truncate(24);
    folder.write("cells.json", cells.to_string());
    let bytes = |threads: &str| -> Vec<Vec<u8>> {
        let run = folder.run_args(
            &[
                "plan",
                &city,
                "--cells",
                "cells.json",
                "--threads",
                threads,
                "--geojson",
                "g.json",
                "-o",
                "f.json",
                "--svg",
                "a.svg",
                "--json",
                "-q",
            ],
            b"",
        );
        let mut said = run.json();
        assert_eq!(said["cells"].as_array().map(Vec::len), Some(24));
        for key in ["seconds", "load_seconds", "build_seconds", "write_seconds"] {
            said[key] = Value::Null;
        }
        let names = ["g.json", "f.json", "a.svg"];
        let files = names.map(|name| folder.bytes(name)).into_iter();
        files.chain([said.to_string().into_bytes()]).collect()
    };
    assert!(bytes("1") == bytes("3"));
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
    folder.write(
        "nan.geojson",
        r#"{"type":"LineString","coordinates":[[0,0],["a",1]]}"#,
    );
    folder.write("unit.svg", "<svg>\n<line x2=\"5mm\"/>\n</svg>");
    folder.write("open.svg", "<svg>\n<g>");
    folder.write(
        "none.dxf",
        "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nnone\n0\nENDSEC\n0\nEOF\n",
    );
    folder.write("five.seg", "0 0 1 1 wall\n0 0 1 1 2\n");
    folder.write("empty.seg", "");
    folder.write("bytes.seg", b"\xff\xfe\x00\x01");
    for (file, code, says) in [
        (
            "missing.seg",
            4,
            "cannot be read (no such file or directory);",
        ),
        ("five.seg", 3, "line 2: a fifth number, `2`, follows"),
        ("cut.geojson", 3, "JSON line 1"),
        ("word.seg", 3, "line 2: `one` is not a number"),
        ("path.svg", 3, "line 2: the path data is damaged"),
        ("half.dxf", 3, "line 6: the drawing stops before its end"),
        ("nan.geojson", 3, "JSON line 1, column 46: invalid type"),
        ("unit.svg", 3, "line 2: `5mm` is not a number of user units"),
        (
            "open.svg",
            3,
            "line 1: the root node was opened but never closed",
        ),
        ("none.dxf", 3, "there is no block `none` for the insert "),
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
    assert!(run.failure(3).contains("feature 0: the cell has 1 hole;"));
    let run = folder.run("plan room.seg --cells missing.json -q");
    let text = run.failure(4);
    assert!(text.contains("missing.json: cannot be read (no such file or directory);"));
    folder.write("empty.json", " \n");
    let run = folder.run("plan room.seg --cells empty.json -q");
    assert!(run.failure(3).starts_with("empty.json: the file is empty;"));
    let run = folder.run_args(
        &["plan", "room.seg", "--cell", "0,0", "--grid", "1e-9", "-q"],
        b"",
    );
    assert!(run.failure(3).contains("use a step of"));
    assert!(!folder.names().iter().any(|n| n.starts_with("out")));
}
