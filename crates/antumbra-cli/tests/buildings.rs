//! Whole measured buildings: baked to the end, everything decided, every certificate checked.

mod tool;

use antumbra_testkit::environment::{data, long, skip};
use tool::Folder;

fn bake_and_check(name: &str, cells: u64) {
    if !long() {
        return skip("minutes of work; set ANTUMBRA_LONG");
    }
    let path = data().map(|d| d.join(format!("walk/{name}.glb")));
    let Some(path) = path.filter(|p| p.is_file()) else {
        return skip(&format!("walk/{name}.glb is not at hand"));
    };
    let folder = Folder::new();
    folder.write("building.glb", std::fs::read(path).expect("readable"));
    let baked = folder
        .run("bake building.glb --cells grid:2 -o building.pvs --json")
        .json();
    assert_eq!(baked["unknown"], 0);
    assert_eq!(baked["cells"], cells);
    let checked = folder
        .run("pvs check building.pvs --scene building.glb --json")
        .json();
    assert_eq!(checked["failed"], 0);
    assert!(
        checked["hidden_checked"].as_u64() > Some(50_000),
        "{checked}"
    );
    let seconds = |run: &serde_json::Value| run["seconds"].as_f64().expect("a time");
    assert!(seconds(&checked) < seconds(&baked), "{checked} {baked}");
}

#[test]
fn a_twin_house() {
    bake_and_check("duplex", 350);
}

#[test]
fn an_institute() {
    bake_and_check("kit_institute", 1_760);
}
