//! The main job from end to end.

mod tool;

use serde_json::Value;
use tool::Folder;

#[test]
fn an_office_is_baked_checked_exported_and_drawn() {
    let folder = Folder::new();
    let made = folder
        .run("gen office --kind office2 -o office.glb --json")
        .json();
    assert_eq!(
        (made["polygons"].as_u64(), made["office"].as_str()),
        (Some(211), Some("office2"))
    );

    let baked = folder
        .run("bake office.glb --cells grid:2 -o office.pvs --json")
        .json();
    for key in ["cells", "objects", "unknown"] {
        assert!(baked[key].is_u64(), "{key}");
    }
    for key in [
        "visible_mean",
        "grid",
        "seconds",
        "load_seconds",
        "build_seconds",
        "write_seconds",
    ] {
        assert!(baked[key].is_f64(), "{key}");
    }
    assert!(baked["accuracy"].is_string());
    assert_eq!(baked["unknown"], 0);

    let info = folder.run("pvs info office.pvs --json").json();
    assert_eq!(
        (&info["cells"], &info["objects"]),
        (&baked["cells"], &baked["objects"])
    );
    assert_eq!(
        info["bytes"].as_u64(),
        Some(folder.bytes("office.pvs").len() as u64)
    );
    assert!(
        info["provenance"]["scene"]
            .as_str()
            .is_some_and(|s| s.len() == 64)
    );

    let export = folder
        .run("pvs export office.pvs --json --witnesses")
        .json();
    let cells = export["cells"].as_array().expect("cells");
    assert_eq!(Some(cells.len() as u64), baked["cells"].as_u64());
    for cell in cells {
        let list = |key: &str| cell[key].as_array().expect("a list").len();
        assert_eq!(list("visible"), list("touching") + list("witnesses"));
    }

    let query = folder
        .run("pvs query office.pvs --at 0.5,0.5,1 --json")
        .json();
    let cell = &cells[query["cell"].as_u64().expect("a number") as usize];
    let ids: Vec<&Value> = query["visible"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|o| &o["id"])
        .collect();
    assert_eq!(
        ids,
        cell["visible"]
            .as_array()
            .expect("a list")
            .iter()
            .collect::<Vec<_>>()
    );

    let checked = folder
        .run("pvs check office.pvs --scene office.glb --json")
        .json();
    assert_eq!(checked["failed"], 0);
    assert!(checked["visible_checked"].is_u64() && checked["hidden_checked"].is_u64());

    let same = folder
        .run("pvs compare office.pvs office.pvs --json")
        .json();
    assert_eq!(
        (&same["only_a"], &same["q_over"]),
        (&Value::from(0), &Value::from(0.0))
    );

    folder
        .run("pvs render office.pvs --scene office.glb --cell 0 -o 0.svg")
        .done();
    folder
        .run("pvs render office.pvs --scene office.glb --cell 0 -o 0.png --size 320x200")
        .done();
    assert!(folder.bytes("0.svg").starts_with(b"<svg "));
    assert!(folder.bytes("0.png").starts_with(b"\x89PNG"));
}

#[test]
fn threads_and_paths_do_not_change_a_byte() {
    let folder = Folder::new();
    folder.run("gen office --kind office3 -o office.glb").done();
    folder
        .run("bake office.glb --cells grid:2 -o one.pvs --threads 1")
        .done();
    std::fs::copy(folder.path("office.glb"), folder.path("copy.glb")).expect("a copy");
    folder
        .run("bake copy.glb --cells grid:2 -o two.pvs --threads 3 --quiet")
        .done();
    assert_eq!(folder.bytes("one.pvs"), folder.bytes("two.pvs"));
    assert_eq!(folder.bytes("one.proof"), folder.bytes("two.proof"));
    // The default name is the scene's, in this folder.
    folder.run("bake copy.glb --cells grid:2").done();
    assert_eq!(folder.bytes("one.pvs"), folder.bytes("copy.pvs"));
}

#[test]
fn only_the_first_wall_is_seen() {
    let folder = Folder::new();
    folder
        .run("gen walls --layers 3 --source-area 50 -o walls.glb")
        .done();
    let baked = folder
        .run("bake walls.glb --cells object:source --json")
        .json();
    assert_eq!(baked["unknown"], 0);
    assert_eq!(baked["visible_mean"], 400.0);
    let export = folder.run("pvs export walls.pvs --json").json();
    let visible = export["cells"][0]["visible"].as_array().expect("a list");
    let ids: Vec<u64> = visible.iter().filter_map(Value::as_u64).collect();
    assert_eq!(ids, (0..400).collect::<Vec<u64>>());
}

#[test]
fn negative_coordinates_are_no_options() {
    let folder = Folder::new();
    folder.write(
        "a.obj",
        "o a\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n",
    );
    folder
        .run("ray a.obj --from -2,-2,1 --to -1,0,-1 --json")
        .json();
    folder.run("pair a.obj --from -2,-2,1 --to a --json").json();
}

#[cfg(unix)]
#[test]
fn an_interrupted_bake_goes_on() {
    use std::time::{Duration, Instant};
    let folder = Folder::new();
    folder
        .run("gen maze --rooms 2 --furniture 2 -o maze.glb")
        .done();
    let args = [
        "bake",
        "maze.glb",
        "--cells",
        "grid:3",
        "-o",
        "maze.pvs",
        "--threads",
        "1",
    ];
    let mut child = folder
        .command(&args)
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    // Wait for a finished cell: the journal grows beyond its head.
    let start = Instant::now();
    let size = || std::fs::metadata(folder.path("maze.pvs.part")).map_or(0, |m| m.len());
    let mut head = 0;
    while start.elapsed() < Duration::from_secs(60) {
        if head == 0 {
            head = size();
        } else if size() > head {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let pid = child.id().to_string();
    std::process::Command::new("kill")
        .args(["-INT", &pid])
        .status()
        .expect("kill runs");
    let code = child.wait().expect("it ends").code();
    assert_eq!(code, Some(5));
    assert!(!folder.names().contains(&"maze.pvs".to_owned()));

    // Other options refuse to go on.
    folder
        .run("bake maze.glb --cells grid:3 -o maze.pvs --seed 9 --resume --quiet")
        .failure(3);
    folder
        .run("bake maze.glb --cells grid:3 -o maze.pvs --resume")
        .done();
    folder
        .run("bake maze.glb --cells grid:3 -o whole.pvs")
        .done();
    assert_eq!(folder.bytes("maze.pvs"), folder.bytes("whole.pvs"));
    assert_eq!(folder.bytes("maze.proof"), folder.bytes("whole.proof"));
    assert!(!folder.names().contains(&"maze.pvs.part".to_owned()));
}

#[test]
fn the_demo_writes_its_four_files() {
    let folder = Folder::new();
    let demo = folder.run("demo --json").json();
    assert_eq!(
        (&demo["unknown"], &demo["failed"]),
        (&Value::from(0), &Value::from(0))
    );
    assert_eq!(demo["accuracy"], "exact");
    for key in ["pvs", "proof", "top", "view"] {
        assert!(!folder.bytes(demo[key].as_str().expect("a path")).is_empty());
    }
}
