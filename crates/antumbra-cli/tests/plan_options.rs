//! Options of plans that belong together or do not, and what is said of them.

mod tool;

use serde_json::Value;
use tool::Folder;
use tool::plans::{folder, fragments, plan};

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

#[test]
fn classes_that_nothing_has_do_not_pass_in_silence() {
    let folder = Folder::new();
    folder.write("a.seg", "0 2 4 2 wall\n0 4 4 4 glass\n");
    let run = folder.run("plan a.seg --cell 2,1 --occluders wal");
    let text = run.failure(2);
    assert!(text.contains("the classes are glass, wall"), "{text}");
    let run = folder.run("plan a.seg --cell 2,1 --transparent glas");
    assert!(run.stderr.contains("nothing has the class glas"), "{run:?}");
    let run = folder.run("plan a.seg --cell 2,1 --svg a.svg --line-space a.svg");
    assert!(run.failure(2).contains("two results"), "{run:?}");
}
