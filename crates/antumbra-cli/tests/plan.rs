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

/// Three squares: in the room, above its screen, outside.
fn three_cells(folder: &Folder) {
    let square = |id: u32, x: f64, y: f64| {
        let (u, v) = (x + 1.0, y + 1.0);
        serde_json::json!({"type": "Feature", "properties": {"id": id}, "geometry": {"type": "Polygon",
            "coordinates": [[[x, y], [u, y], [u, v], [x, v], [x, y]]]}})
    };
    let features = [
        square(7, 1.0, 1.0),
        square(8, 4.5, 8.0),
        square(9, 20.0, 1.0),
    ];
    let cells = serde_json::json!({"type": "FeatureCollection", "features": features});
    folder.write("cells.json", cells.to_string());
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    let folder = folder();
    three_cells(&folder);
    let cell = "--cell 1,1";
    let cells = "--cells cells.json";
    for (options, says) in [
        ("", &["--cell \"", "--cells FILE"][..]),
        (&format!("{cell} --matrix"), &["--matrix", "--cells FILE"]),
        (
            &format!("{cell} --reach 3 --isovist"),
            &["--reach", "--isovist"],
        ),
        (&format!("{cell} --reach 3 --to 2,2"), &["--reach", "--to"]),
        (
            &format!("{cells} --reach 3 --matrix"),
            &["--reach", "--matrix"],
        ),
        (&format!("{cells} --to 2,2 --matrix"), &["--to", "--matrix"]),
        (
            &format!("{cell} --to 2,2 --svg out.svg"),
            &["--to", "--svg"],
        ),
        (
            &format!("{cells} --line-space out.svg"),
            &["--line-space", "there are 3"],
        ),
    ] {
        let run = folder.run(&format!("plan room.seg {options} -q"));
        let text = run.failure(2);
        assert!(says.iter().all(|s| text.contains(s)), "{options}: {text}");
    }
    assert!(!folder.names().iter().any(|n| n.starts_with("out")));
}

#[test]
fn each_cell_of_a_file_is_asked_about_another_one() {
    let folder = folder();
    three_cells(&folder);
    let run = folder.run("plan room.seg --cells cells.json --to 3,8 --json -q");
    let found = run.json();
    let verdict = |i: usize| {
        (
            found["cells"][i]["id"].clone(),
            found["cells"][i]["verdict"].clone(),
        )
    };
    for (i, (id, verdict_of)) in [(7, "visible"), (8, "visible"), (9, "hidden")]
        .iter()
        .enumerate()
    {
        assert_eq!(verdict(i), ((*id).into(), (*verdict_of).into()), "{found}");
    }
    assert!(found["cells"][0]["line"].is_array() && found["visible"] == 2);
    let text = folder
        .run("plan room.seg --cells cells.json --to 3,8 -q")
        .stdout;
    assert!(
        text.starts_with("2 of 3 cells see the other cell, in "),
        "{text}"
    );
}

/// A wall that starts within reach, and one beyond it that hides a part of the first.
#[test]
fn segments_within_reach_are_reported_whole_and_conservatively() {
    let folder = Folder::new();
    folder.write(
        "walls.seg",
        "5 -1 5 20\n3 8 4.9 8\n-9 2 2 -9 glass\n0 3 3 3 glass\n",
    );
    let glass = ["--transparent", "glass"];
    let all = plan(&folder, "walls.seg", "0,0", &glass).json();
    assert_eq!(all["accuracy"], "exact");
    assert_eq!(fragments(&all, 0).as_array().map(Vec::len), Some(2));
    let reach = |distance: &str| {
        let more = [&glass[..], &["--reach", distance]].concat();
        plan(&folder, "walls.seg", "0,0", &more).json()
    };
    let near = reach("6");
    assert_eq!(near["accuracy"], "conservative");
    assert_eq!(fragments(&near, 0), serde_json::json!([[0.0, 1.0]]));
    assert_eq!(fragments(&near, 1), Value::Null);
    // The line of the slanted pane is 7 / sqrt(2) = 4.95 away, the box around it holds the cell.
    assert_eq!(fragments(&reach("4.9"), 2), Value::Null);
    assert_ne!(fragments(&reach("5"), 2), Value::Null);
    let nearest = reach("4.5");
    assert_eq!(nearest["visible"].as_array().map(Vec::len), Some(1));
    assert_eq!(nearest["accuracy"], "exact");
}

#[test]
fn cells_too_far_for_the_grid_are_refused() {
    let folder = folder();
    for (cell, far) in [("1e300,10", "1.0e300"), ("1e9,10", "1.0e9")] {
        let run = plan(&folder, "room.seg", cell, &["--svg", "out.svg"]);
        let text = run.failure(3);
        let says = format!("--cell: the cell is {far} from the plan, too far for the grid: ");
        assert!(text.starts_with(&says) && text.contains("--grid"), "{text}");
    }
    let text = plan(&folder, "room.seg", "1,1", &["--to", "1e9,10"]);
    assert!(text.failure(3).starts_with("--to: the cell is 1.0e9 from "));
    let point = |x: f64| serde_json::json!({"type": "Feature", "geometry": {"type": "Point", "coordinates": [x, 1.0]}});
    let cells =
        serde_json::json!({"type": "FeatureCollection", "features": [point(1.0), point(-1e9)]});
    folder.write("cells.json", cells.to_string());
    let run = folder.run("plan room.seg --cells cells.json -q");
    assert!(
        run.failure(3)
            .starts_with("cells.json: feature 1: the cell is 1.0e9 from ")
    );
    assert_eq!(folder.names(), ["cells.json", "room.seg"]);
    // As far as all segments keep a length, and on a grid that was chosen, all is as ever.
    plan(&folder, "room.seg", "1e6,10", &[]).done();
    plan(&folder, "room.seg", "1e9,10", &["--grid", "1000"]).done();
    // One without a length is not lost to the cell.
    folder.write("point.seg", "3 3 3 3\n0 0 10 0\n");
    plan(&folder, "point.seg", "1e6,10", &[]).done();
}

#[test]
fn fragments_keep_the_coordinate_system_of_the_plan() {
    let folder = Folder::new();
    let crs =
        serde_json::json!({"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32633"}});
    let line =
        serde_json::json!({"type": "LineString", "coordinates": [[4e5, 5e6], [400_010.0, 5e6]]});
    let drawn = |file: &Value| -> Value {
        folder.write("plan.geojson", file.to_string());
        plan(
            &folder,
            "plan.geojson",
            "400005,5000005",
            &["--geojson", "seen.geojson"],
        )
        .done();
        serde_json::from_slice(&folder.bytes("seen.geojson")).expect("JSON")
    };
    let plain = drawn(&line);
    assert!(plain.get("crs").is_none());
    let mut with = line.clone();
    with["crs"] = crs.clone();
    let named = drawn(&with);
    assert_eq!(named["crs"], crs);
    assert_eq!(named["features"], plain["features"]);
}

/// What one cell sees is not gray because another one does not.
#[test]
fn boxes_are_gray_if_no_cell_sees_into_them() {
    let folder = Folder::new();
    folder
        .run("gen random-segments --count 400 --seed 3 -o a.seg")
        .done();
    let outlines = [
        "[[[20,20],[22,20],[22,22],[20,20]]]",
        "[[[80,80],[82,80],[82,82],[80,80]]]",
    ];
    let gray = |outlines: &[&str]| -> usize {
        let feature = |o: &&str| {
            format!(r#"{{"type":"Feature","geometry":{{"type":"Polygon","coordinates":{o}}}}}"#)
        };
        let features = outlines.iter().map(feature).collect::<Vec<_>>().join(",");
        folder.write(
            "cells.json",
            format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#),
        );
        folder
            .run("plan a.seg --cells cells.json --second-pass --svg a.svg --json -q")
            .done();
        let svg = String::from_utf8(folder.bytes("a.svg")).expect("text");
        let path = svg
            .split("id=\"culled\"")
            .nth(1)
            .and_then(|t| t.split("/>").next());
        path.expect("a path").matches('M').count()
    };
    let (one, other, both) = (gray(&outlines[..1]), gray(&outlines[1..]), gray(&outlines));
    assert!(both < one && both < other, "{one} {other} {both}");
}

#[test]
fn the_sentence_tells_what_was_asked_for() {
    let folder = folder();
    three_cells(&folder);
    let more = "--check --isovist --witnesses --second-pass";
    let text = folder
        .run(&format!("plan room.seg --cells cells.json {more} -q"))
        .stdout;
    assert!(
        text.starts_with("3 cells see 3.7 of 5 segments on average; 3 isovists; "),
        "{text}"
    );
    assert!(
        text.contains(" witnesses; ") && text.contains("; checked: all "),
        "{text}"
    );
    let mut run = vec!["plan", "room.seg", "--cell", "1,1 2,1 2,2 1,2", "-q"];
    run.extend(more.split(' '));
    let text = folder.run_args(&run, b"").stdout;
    assert!(
        text.contains("; isovist of area 94.000 and perimeter "),
        "{text}"
    );
    assert!(
        text.contains("hidden after all; checked: all 11 verdicts hold, in "),
        "{text}"
    );
    let text = folder.run("plan room.seg --cell 1,1 --check -q").stdout;
    assert!(
        text.contains("; 1 point has no certificate to check, in "),
        "{text}"
    );
    let seen = plan(&folder, "room.seg", "1,1 2,1 2,2 1,2", &["--check"]).json();
    assert_eq!(seen["check"]["failed"], 0);
    assert_eq!(seen["check"]["failures"], serde_json::json!([]));
    folder.write("wall.seg", "0 5 10 5\n");
    let point = serde_json::json!({"type": "Point", "coordinates": [1, 1]});
    folder.write("cell.json", point.to_string());
    let text = folder.run("plan wall.seg --cells cell.json -q").stdout;
    assert!(
        text.starts_with("1 cell sees 1.0 of 1 segment on average, in "),
        "{text}"
    );
    let text = folder.run("plan wall.seg --cell 1,1 -q").stdout;
    assert!(
        text.starts_with("1 of 1 segment visible in 1 fragment (exact), "),
        "{text}"
    );
}

#[test]
fn its_own_pictures_are_plans() {
    let folder = folder();
    plan(&folder, "room.seg", "1,1 2,1 2,2", &["--svg", "a.svg"]).done();
    let run = folder.run("plan a.svg --cell 300,300");
    run.done();
    let says = "note: 1 rectangle as large as the drawing is left out";
    assert!(run.stderr.contains(says), "{}", run.stderr);
}

#[test]
fn random_segments_have_lengths_in_reason() {
    let folder = Folder::new();
    for length in ["1e-300", "0.009", "1001", "1e300", "x"] {
        let run = folder.run(&format!("gen random-segments --length {length} -o a.seg"));
        assert!(
            run.failure(2)
                .contains("expected a length from 0.01 to 1000 metres")
        );
    }
    let run = folder.run("gen random-segments");
    assert!(run.failure(2).contains("-o FILE.seg"));
    assert!(folder.names().is_empty());
    folder
        .run("gen random-segments --length 0.01 -o a.seg")
        .done();
}
