//! Maps and drawings from the command line.

mod tool;

use serde_json::Value;
use tool::Folder;

/// A furnished office.
fn folder() -> Folder {
    let folder = Folder::new();
    folder
        .run("gen office --kind office2 -o office.glb --json")
        .done();
    folder
}

fn sum(angles: &Value) -> f64 {
    let object = angles.as_object().expect("an object");
    object.values().map(|v| v.as_f64().expect("a number")).sum()
}

#[test]
fn a_sphere_is_shared_out_among_the_objects() {
    let folder = folder();
    let map = folder.run("map office.glb --eye 2,2,1.5 --json").json();
    for key in ["vertices", "edges", "faces", "visible_polygons"] {
        assert!(map[key].as_u64().is_some_and(|n| n > 0), "{key}");
    }
    assert_eq!(map["edges_by_class"]["bsp"], 0);
    let background = map["background"].as_f64().expect("a number");
    let sphere = sum(&map["solid_angle_by_object"]) + background;
    assert!(
        (sphere - 4.0 * std::f64::consts::PI).abs() < 1e-9,
        "{sphere}"
    );
}

#[test]
fn drawings_have_layers_elements_and_no_empty_paths() {
    let folder = folder();
    let line = "map office.glb --eye -9,-8,7 --to 4,3,1 --svg a.svg --dxf a.dxf -o a.json --hidden";
    folder.run(line).done();
    let svg = String::from_utf8(folder.bytes("a.svg")).expect("text");
    for layer in ["hidden", "corner", "shadow", "silhouette"] {
        assert!(
            svg.contains(&format!("<g id=\"{layer}\" class=\"layer\">")),
            "{layer}"
        );
    }
    let paths: Vec<&str> = svg.lines().filter(|l| l.starts_with("<path")).collect();
    assert!(paths.len() > 20);
    for path in &paths {
        assert!(path.contains(" data-object=\""), "{path}");
        let d = path.split(" d=\"").nth(1).expect("a path");
        let points: Vec<&str> = d.trim_end_matches("\"/>").split(['M', 'L', 'Z']).collect();
        let points: Vec<&str> = points
            .iter()
            .map(|p| p.trim())
            .filter(|p| !p.is_empty())
            .collect();
        assert!(
            points.len() > 1 && points.windows(2).all(|w| w[0] != w[1]),
            "{path}"
        );
    }
    let dxf = String::from_utf8(folder.bytes("a.dxf")).expect("text");
    assert_eq!(dxf.matches("POLYLINE\n").count(), paths.len());
    let json: Value = serde_json::from_slice(&folder.bytes("a.json")).expect("json");
    let edges = json["edges"].as_array().expect("edges");
    for face in json["faces"].as_array().expect("faces") {
        for border in face["borders"].as_array().expect("borders") {
            for half in border.as_array().expect("half-edges") {
                assert!((half.as_u64().expect("a number") / 2) < edges.len() as u64);
            }
        }
    }
    // The same bytes again, with another number of threads.
    let again = line.replace("a.svg", "b.svg").replace("a.json", "b.json") + " --threads 2";
    folder.run(&again).done();
    assert_eq!(folder.bytes("a.svg"), folder.bytes("b.svg"));
    assert_eq!(folder.bytes("a.json"), folder.bytes("b.json"));
}

#[test]
fn a_parallel_view_has_areas() {
    let folder = folder();
    let map = folder
        .run("map office.glb --eye 0,0,9 --to 0,0,0 --up-is 0,1,0 --ortho --json --svg top.svg")
        .json();
    assert!(sum(&map["area_by_object"]) > 1.0);
    assert!(map["solid_angle_by_object"].is_null());
    assert!(!folder.bytes("top.svg").is_empty());
}

/// The largest and smallest of the numbers with a code in a DXF text.
fn extent(dxf: &str, code: &str) -> [f64; 2] {
    let lines: Vec<&str> = dxf.lines().collect();
    let pairs = lines.chunks_exact(2).filter(|pair| pair[0].trim() == code);
    let numbers = pairs.map(|pair| pair[1].parse::<f64>().expect("a number"));
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], n| {
        [low.min(n), high.max(n)]
    })
}

#[test]
fn a_parallel_drawing_is_true_to_scale() {
    let folder = Folder::new();
    folder.write(
        "plate.obj",
        "o Türblatt\nv 2 3 0\nv 7 3 0\nv 7 4 0\nv 2 4 0\nf 1 2 3 4\n",
    );
    let run = "map plate.obj --eye 0,0,9 --to 0,0,0 --up-is 0,1,0 --ortho --svg a.svg --dxf a.dxf";
    folder.run(run).done();
    let dxf = String::from_utf8(folder.bytes("a.dxf")).expect("text");
    assert_eq!(extent(&dxf, "10"), [2.0, 7.0]);
    assert_eq!(extent(&dxf, "20"), [3.0, 4.0]);
    assert!(dxf.contains("1071\n0\n1000\nT\\U+00FCrblatt\n"), "{dxf}");
    let svg = String::from_utf8(folder.bytes("a.svg")).expect("text");
    let scale = svg.split("data-scale=\"").nth(1).expect("a scale");
    let scale: f64 = scale
        .split('"')
        .next()
        .and_then(|s| s.parse().ok())
        .expect("a number");
    assert!((scale - 0.96 * 1200.0 / 5.0).abs() < 1e-9, "{scale}");
}

/// The dashed lines of a drawing.
fn dashed(folder: &Folder, view: &str) -> Vec<String> {
    folder
        .run(&format!("map {view} --hidden --svg hidden.svg"))
        .done();
    let svg = String::from_utf8(folder.bytes("hidden.svg")).expect("text");
    let paths = svg
        .lines()
        .filter(|l| l.starts_with("<path class=\"hidden"));
    paths.map(str::to_owned).collect()
}

#[test]
fn hidden_lines_are_drawn_once_and_not_inside_flat_faces() {
    let folder = Folder::new();
    let cross = "o cross\nv 0 1 0\nv 3 1 0\nv 3 2 0\nv 0 2 0\nv 1 0 0\nv 2 0 0\nv 2 3 0\nv 1 3 0\n\
        f 1 2 3 4\nf 5 6 7 8\n";
    let screen = "o screen\nv -1 -1 1\nv 4 -1 1\nv 4 4 1\nv -1 4 1\nf 9 10 11 12\n";
    let decal = "o wall\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4\n\
        o decal\nv 1 1 0\nv 3 1 0\nv 3 3 0\nv 1 3 0\nf 5 6 7 8\n";
    let cube = "o cube\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n\
        f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    folder.write("cross.obj", cross);
    folder.write("screened.obj", format!("{cross}{screen}"));
    folder.write("decal.obj", decal);
    folder.write("cube.obj", cube);
    let above = "--eye 1.5,1.4,6 --to 1.5,1.5,0 --up-is 0,1,0";
    for name in ["cross", "decal"] {
        assert!(dashed(&folder, &format!("{name}.obj {above}")).is_empty());
        assert!(dashed(&folder, &format!("{name}.obj {above} --dissolve flat")).is_empty());
    }
    // The outline of a cross has twelve edges, here on eight lines.
    assert_eq!(dashed(&folder, &format!("screened.obj {above}")).len(), 12);
    // The back lies under the front.
    assert!(dashed(&folder, "cube.obj --eye 1,-5,1 --to 1,0,1 --ortho").is_empty());
    assert_eq!(dashed(&folder, "cube.obj --eye 9,7,5 --to 1,1,1").len(), 3);
}

#[test]
fn unknown_classes_do_not_pass_in_silence() {
    let folder = folder();
    let run = folder.run("map office.glb --eye 2,2,1.5 --occluders wal --json");
    let text = run.failure(2);
    assert!(
        text.contains("the classes are") && text.contains("wall"),
        "{text}"
    );
    let run = folder.run("map office.glb --eye 2,2,1.5 --transparent glas --json");
    assert!(run.stderr.contains("nothing has the class glas"), "{run:?}");
    let all = folder.run("map office.glb --eye 2,2,1.5 --json").json();
    assert_eq!(run.json()["faces"], all["faces"]);
}

#[test]
fn odd_viewpoints_are_answered() {
    let folder = Folder::new();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    folder.write("square.obj", square);
    // Behind everything.
    let map = folder
        .run("map square.obj --eye 3,3,3 --to 9,9,9 --json --svg away.svg")
        .json();
    assert_eq!(map["visible_polygons"], 0);
    assert_eq!(map["faces"], 2);
    assert!(!folder.bytes("away.svg").is_empty());
    // On the polygon.
    let run = folder.run("map square.obj --eye 0.5,0.5,0 --json");
    assert!(run.stderr.contains("seen edge-on"), "{run:?}");
    let map = run.json();
    assert_eq!(
        (&map["edges"], &map["faces"]),
        (&Value::from(0), &Value::from(1))
    );
    // Between the points of a coarse grid.
    let run = folder.run("map square.obj --eye 0.5,0.5,2.6 --grid 1 --json");
    assert!(run.stderr.contains("viewpoint was moved to"), "{run:?}");
    assert_eq!(run.json()["eye"][2], 3.0);
    // Off the grid.
    let far = folder.run("map square.obj --eye 1e9,0,3 --grid 0.01");
    assert!(far.failure(3).contains("grid"), "{far:?}");
}
