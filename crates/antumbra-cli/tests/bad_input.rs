//! Bad input gets its exit code and one clear sentence, and leaves no file under the final name.

mod tool;

use tool::Folder;

/// A unit square as OBJ.
const SQUARE: &str = "o square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

#[test]
fn scenes_that_cannot_be_read() {
    let folder = Folder::new();
    folder.run("gen office -o good.glb").done();
    let glb = folder.bytes("good.glb");
    folder.write("cut.glb", &glb[..glb.len() / 2]);
    folder.write("empty.glb", b"");
    folder.write("picture.glb", b"\x89PNG\r\n\x1a\n....");
    folder.write("text.glb", b"hello");
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
    folder.write("nan.obj", SQUARE.replace("v 1 1 0", "v 1 nan 0"));
    folder.write("infinite.obj", SQUARE.replace("v 1 1 0", "v 1 1e999 0"));
    folder.write("index.obj", SQUARE.replace("f 1 2 3 4", "f 1 2 3 5"));
    folder.write(
        "buffer.gltf",
        r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"gone.bin","byteLength":4}]}"#,
    );
    folder.write("broken.gltf", "{\"asset\": ");
    folder.write("walk.path", "0 0 9 1 0 0 0 0 1 60\n");
    for (scene, code) in [
        ("missing.glb", 4),
        (".", 4),
        ("cut.glb", 3),
        ("empty.glb", 3),
        ("picture.glb", 3),
        ("text.glb", 3),
        ("points.obj", 3),
        ("nan.obj", 3),
        ("infinite.obj", 3),
        ("index.obj", 3),
        ("buffer.gltf", 3),
        ("broken.gltf", 3),
    ] {
        for line in [
            format!("bake {scene} -o out.pvs"),
            format!("pair {scene} --from 0 --to 1"),
            format!("ray {scene} --from 0,0,0 --to 1,1,1"),
            format!("map {scene} --eye 0,0,9 -o out.json"),
            format!("shadow {scene} --light 0,0,9 -o out.glb"),
            format!("cull {scene} --path walk.path -o out.json"),
        ] {
            let run = folder.run(&line);
            let text = run.failure(code);
            assert!(text.starts_with(scene), "{line}: {text}");
            assert_eq!(run.stdout, "");
        }
    }
    assert!(
        !folder.names().iter().any(|n| n.starts_with("out")),
        "{:?}",
        folder.names()
    );
}

#[test]
fn cells_and_names_that_make_no_sense() {
    let folder = Folder::new();
    folder.write("a.obj", SQUARE);
    folder.write(
        "flat.json",
        r#"[{"name":"flat","min":[0,0,0],"max":[1,1,0]}]"#,
    );
    folder.write("odd.json", r#"[{"name":"odd","min":[0,0],"max":[1,1,0]}]"#);
    folder.write("bad.json", "[{");
    folder.write("none.json", "[]");
    folder.write(
        "far.json",
        r#"[{"name":"far","min":[1e9,0,0],"max":[2e9,1,1]}]"#,
    );
    for (line, code, part) in [
        ("bake a.obj --cells object:lamp", 3, "a.obj: there is no"),
        ("bake a.obj -o a.obj", 2, "replace its own input"),
        ("bake a.obj -o ./a.obj", 2, "replace its own input"),
        ("bake a.obj --grid 1000", 3, "on a grid of step 1000"),
        ("bake a.obj --cells boxes:gone.json", 4, "gone.json"),
        ("bake a.obj --cells boxes:flat.json", 3, "no extent along z"),
        (
            "bake a.obj --cells boxes:odd.json",
            3,
            "'min' is not three numbers",
        ),
        ("bake a.obj --cells boxes:bad.json", 3, "not JSON"),
        ("bake a.obj --cells boxes:none.json", 3, "empty"),
        (
            "bake a.obj --cells boxes:far.json --grid 0.001",
            3,
            "use a step of",
        ),
        ("bake a.obj --grid 1e-9", 3, "use a step of"),
        ("bake a.obj --cells grid:1e-9", 3, ""),
        ("bake a.obj -o gone/a.pvs", 4, "gone/a.pvs"),
        ("bake a.obj -o .", 4, "cannot be written"),
        ("pair a.obj --from lamp --to square", 3, "lamp"),
        (
            "pair a.obj --from 7 --to square",
            3,
            "object 7 does not exist",
        ),
        ("pair a.obj --from square:9 --to 0", 3, "numbered from 0"),
        ("shadow a.obj --light lamp --approximate", 3, "lamp"),
        ("shadow a.obj --light square", 2, "--approximate"),
        ("shadow a.obj --light 0,0,9 -o gone/a.glb", 4, "gone/a.glb"),
        ("shadow a.obj --light 1e9,0,3 --grid 0.01", 3, "grid"),
        ("gen walls -o gone/walls.glb", 4, "gone/walls.glb"),
        ("demo -o a.obj/x", 4, "a.obj"),
    ] {
        let run = folder.run(line);
        let text = run.failure(code);
        assert!(text.contains(part), "{line}: {text}");
        assert_eq!(run.stdout, "", "{line}");
    }
    let names = folder.names();
    assert_eq!(names.len(), 6, "{names:?}");
}

#[test]
fn results_that_cannot_be_used() {
    let folder = Folder::new();
    folder.write("a.obj", SQUARE);
    folder.write("b.obj", SQUARE.replace("v 1 1 0", "v 1 2 0"));
    folder.write("empty.pvs", b"");
    folder
        .run("bake a.obj --cells grid:1 -o a.pvs --json")
        .json();
    folder
        .run("bake a.obj --cells grid:1 -o bare.pvs --no-proofs")
        .done();
    let mut bytes = folder.bytes("a.pvs");
    folder.write("cut.pvs", &bytes[..bytes.len() - 5]);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    folder.write("altered.pvs", &bytes);
    for (line, code, part) in [
        ("pvs info gone.pvs", 4, "gone.pvs"),
        ("pvs info .", 4, "folder"),
        ("pvs info a.obj", 3, "no .pvs file"),
        ("pvs info empty.pvs", 3, "empty"),
        ("pvs info cut.pvs", 3, "cut.pvs"),
        ("pvs export altered.pvs --json --witnesses", 3, "altered"),
        ("pvs query a.pvs --at 100,0,0", 3, "no cell contains"),
        ("pvs check bare.pvs --scene a.obj", 2, "--no-proofs"),
        ("pvs check a.pvs --scene b.obj", 3, "not the scene"),
        ("pvs check a.pvs --scene gone.obj", 4, "gone.obj"),
        (
            "pvs render a.pvs --scene a.obj --cell 99 -o a.png",
            3,
            "no cell '99'",
        ),
        (
            "pvs render a.pvs --scene b.obj --cell 0 -o a.png",
            3,
            "not the scene",
        ),
        (
            "pvs render a.pvs --scene a.obj --cell 0 -o gone/a.png",
            4,
            "gone/a.png",
        ),
    ] {
        let run = folder.run(line);
        let text = run.failure(code);
        assert!(text.contains(part), "{line}: {text}");
        assert_eq!(run.stdout, "", "{line}");
    }
    std::fs::remove_file(folder.path("a.proof")).expect("it is there");
    folder.run("pvs check a.pvs --scene a.obj").failure(4);
    assert!(!folder.names().iter().any(|n| n.ends_with(".png")));
}

#[test]
fn pairs_on_stdin_name_the_line() {
    let folder = Folder::new();
    folder.write("a.obj", SQUARE);
    let run = folder.run_args(&["pair", "a.obj", "--all"], b"# a comment\n\n0 lamp\n");
    assert!(run.failure(3).starts_with("stdin, line 3: "));
    let run = folder.run_args(&["pair", "a.obj", "--all"], b"0\n");
    assert!(
        run.failure(3)
            .starts_with("stdin, line 1: expected two ends")
    );
}
