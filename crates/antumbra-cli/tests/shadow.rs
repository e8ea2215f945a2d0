//! Lit and shadowed fragments, and meshes, from the command line.

mod tool;

use serde_json::Value;
use tool::Folder;

/// A floor of 8 x 8, a lid of 2 x 2 above it, and a lamp over both.
const LID: &str = "\
o floor\nv -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3 4
o lid\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nf 5 6 7 8
o lamp\nv -1 -1 4\nv 1 -1 4\nv 1 1 4\nv -1 1 4\nf 9 10 11 12
";

fn area(corners: &Value) -> f64 {
    let at = |p: &Value, k: usize| p[k].as_f64().expect("a number");
    let points = corners.as_array().expect("corners");
    let next = points.iter().cycle().skip(1);
    let twice: f64 = points
        .iter()
        .zip(next)
        .map(|(p, q)| at(p, 0) * at(q, 1) - at(q, 0) * at(p, 1))
        .sum();
    twice.abs() / 2.0
}

#[test]
fn a_lid_throws_its_shadow_on_the_floor() {
    let folder = Folder::new();
    folder.write("lid.obj", LID);
    let line = "shadow lid.obj --light 0,0,3.5 --grid 0.125 -o a.json --json";
    let result = folder.run(line).json();
    // From 3.5 the lid at 2 throws 14/3 x 14/3; the lamp is lit from below.
    let shadow = (14.0_f64 / 3.0).powi(2);
    let areas = |key: &str| result["areas"][key].as_f64().expect("a number");
    assert!((areas("shadowed") - shadow).abs() < 1e-12);
    assert!((areas("lit") - (64.0 - shadow + 4.0 + 4.0)).abs() < 1e-12);
    let json: Value = serde_json::from_slice(&folder.bytes("a.json")).expect("json");
    let on_floor = |lighting: &str| -> f64 {
        let all = json["fragments"].as_array().expect("fragments").iter();
        let of = all.filter(|f| f["object"] == 0 && f["lighting"] == lighting);
        of.map(|f| area(&f["corners"])).sum()
    };
    assert!((on_floor("shadowed") - shadow).abs() < 1e-12);
    assert!((on_floor("lit") + shadow - 64.0).abs() < 1e-12);
}

#[test]
fn a_lit_scene_keeps_its_objects() {
    let folder = Folder::new();
    folder.run("gen office --kind office2 -o office.glb").done();
    let line = "shadow office.glb --light 2.5,2,2.3 -o a.glb --png a.png --eye 0.4,0.4,2.2 --to 3,3,0 --json";
    let result = folder.run(line).json();
    assert!(folder.bytes("a.png").starts_with(b"\x89PNG"));
    let scene = antumbra_io::read_scene(&folder.path("a.glb")).expect("a scene");
    let input = antumbra_io::read_scene(&folder.path("office.glb")).expect("a scene");
    let names = |s: &antumbra_scene::SceneInput| -> Vec<Option<String>> {
        s.objects.iter().map(|o| o.name.clone()).collect()
    };
    assert_eq!(names(&scene), names(&input));
    let parts = scene.objects.iter().flat_map(|o| &o.parts);
    let classes: std::collections::BTreeSet<&str> =
        parts.filter_map(|p| p.class.as_deref()).collect();
    assert!(
        classes.contains("lit") && classes.contains("shadowed"),
        "{classes:?}"
    );
    assert!(result["fragments"]["lit"].as_u64() > Some(100));
    // The same bytes with another number of threads.
    let again = line.replace("a.glb", "b.glb") + " --threads 2";
    folder.run(&again).done();
    assert_eq!(folder.bytes("a.glb"), folder.bytes("b.glb"));
}

#[test]
fn a_mesh_of_a_lamp_and_of_its_corners_are_the_same() {
    let folder = Folder::new();
    folder.write("lid.obj", LID);
    let line = "shadow lid.obj --light lamp --approximate --grid 0.125 -o a.json --json";
    let result = folder.run(line).json();
    assert_eq!(result["edges_by_event"]["light-corner"], 16);
    assert_eq!(result["edges_by_event"]["light-edge"], 16);
    assert_eq!(result["edges_by_event"]["three-edges"], 0);
    assert_eq!(result["accuracy"], "approximate");
    let corners = "-1,-1,4 1,-1,4 1,1,4 -1,1,4";
    let args = [
        "shadow",
        "lid.obj",
        "--light",
        corners,
        "--approximate",
        "--grid",
        "0.125",
        "-o",
        "b.json",
    ];
    folder.run_args(&args, b"").done();
    let read = |name: &str| -> Value { serde_json::from_slice(&folder.bytes(name)).expect("json") };
    assert_eq!(read("a.json")["edges"], read("b.json")["edges"]);
}

#[test]
fn a_light_on_a_polygon_is_said_so() {
    let folder = Folder::new();
    folder.write("lid.obj", LID);
    let run = folder.run("shadow lid.obj --light 0,0,2 --json");
    assert!(run.stderr.contains("lies on a polygon of `lid`"), "{run:?}");
    let result = run.json();
    assert_eq!(result["fragments"]["edge-on"], 1);
    assert_eq!(result["areas"]["shadowed"], 0.0);
}
