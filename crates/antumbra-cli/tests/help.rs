//! What the binary says of itself.

mod tool;

use tool::{Folder, assert_snapshot};

const COMMANDS: [&str; 23] = [
    "",
    "bake",
    "pvs",
    "pvs info",
    "pvs query",
    "pvs export",
    "pvs check",
    "pvs compare",
    "pvs render",
    "pair",
    "ray",
    "map",
    "shadow",
    "cull",
    "plan",
    "gen",
    "gen random-segments",
    "gen random-triangles",
    "gen walls",
    "gen office",
    "demo",
    "completions",
    "man",
];

#[test]
fn help_texts() {
    let folder = Folder::new();
    for command in COMMANDS {
        let run = folder.run(&format!("{command} --help"));
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{command}");
        let name = if command.is_empty() {
            "antumbra"
        } else {
            command
        }
        .replace(' ', "-");
        assert_snapshot(&format!("{name}.txt"), &run.stdout);
    }
}

#[test]
fn version_completions_and_man() {
    let folder = Folder::new();
    assert!(folder.run("--version").stdout.starts_with("antumbra 0."));
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let run = folder.run(&format!("completions {shell}"));
        assert!(
            run.code == 0 && run.stdout.contains("ignore-below"),
            "{shell}"
        );
    }
    for page in ["", "bake", "pvs query"] {
        let run = folder.run(&format!("man {page}"));
        assert!(run.code == 0 && run.stdout.contains(".SH NAME"), "{page}");
    }
    assert!(
        folder
            .run("man bark")
            .failure(2)
            .contains("no command 'bark'")
    );
}

#[test]
fn wrong_usage_is_one_sentence() {
    let folder = Folder::new();
    for (line, part) in [
        ("", "a command is missing"),
        ("bark", "unrecognized subcommand 'bark'"),
        ("bake", "required arguments were not provided: <SCENE>"),
        ("bake a.glb --grid 0", "expected a positive number"),
        ("bake a.glb --grid nan", "expected a positive number"),
        ("bake a.glb --threads many", "invalid value 'many'"),
        ("bake a.glb --threads 0", "0 is not in 1..=1024"),
        ("bake a.glb --ignore-below 5", "an angle with its unit"),
        (
            "bake a.glb --occluders a --transparent b",
            "cannot be used with",
        ),
        ("bake a.glb --cells rooms", "rooms"),
        ("bake a.glb --cells grid:-1", "grid:-1"),
        ("pvs query a.pvs --at 1,2", "three numbers"),
        ("pvs query a.pvs", "see `antumbra pvs query --help`"),
        ("pair a.glb --from 1", "--to"),
        ("ray a.glb --from 1,2,3 --to 1,2,inf", "three numbers"),
        ("map a.glb", "--eye"),
        ("map a.glb --eye 0,0,0 --svg a.svg", "--to"),
        ("map a.glb --eye 0,0,0 --to 0,0,0", "no direction"),
        ("map a.glb --eye 0,0,0 --to 0,0,5", "up direction"),
        (
            "map a.glb --eye 0,0,0 --to 1,0,0 --fov 180",
            "to 179 degrees",
        ),
        (
            "map a.glb --eye 0,0,0 --to 1,0,0 --fov -5",
            "'-5' for '--fov <DEG>'",
        ),
        ("map a.glb --eye 0,0,0 --hidden", "add --svg FILE"),
        ("map a.glb --eye 0,0,0 --to 1,0,0 --svg a.png", "is .svg"),
        (
            "map a.glb --eye 0,0,0 --to 1,0,0 --svg a --dxf a",
            "two results",
        ),
        ("map a.glb --eye 0,0,0 --crease 181", "--crease"),
        ("shadow a.glb", "--light"),
        ("shadow a.glb --light 1,2", "three numbers"),
        ("shadow a.glb --light 1,2,3 --approximate", "area lights"),
        ("shadow a.glb --light 1,2,3 -o a.obj", ".glb or .json"),
        ("shadow a.glb --light 1,2,3 --png a.png", "--eye"),
        (
            "shadow a.glb --light 1,2,3 --png a.png --eye 0,0,0 --to 0,0,0",
            "no direction",
        ),
        ("cull a.glb", "--path"),
        ("cull a.glb --path a.path --aspect 16", "16:9"),
        ("cull a.glb --path a.path --size 64x64", "--verify"),
        (
            "cull a.glb --path a.path --verify --size 64x64",
            "the aspect of the view",
        ),
        ("cull a.glb --path a.path --skip 2", "from 0 to 1"),
        ("cull a.glb --path a.path --minimum-cost few", "a number"),
        ("cull a.glb --path a.path --open a", "--doors"),
        ("gen walls", "-o FILE.glb"),
        ("gen walls -o walls.stl", ".glb or .obj"),
        ("gen maze --rooms 0 -o m.glb", "0 is not in 1..=500"),
        (
            "pvs render a.pvs --scene a.glb --cell 0 -o a.gif",
            ".png or .svg",
        ),
    ] {
        let run = folder.run(line);
        let text = run.failure(2);
        assert!(text.contains(part), "{line}: {text}");
        assert_eq!(run.stdout, "", "{line}");
    }
    assert!(folder.names().is_empty());
}
