//! glTF and GLB: what is read, and what is said of damage, case by case.

use std::collections::BTreeMap;
use std::io;

use antumbra_io::{
    GlbOptions, Instancing, ReadError, ReadOptions, parse_scene, read_scene, write_glb,
};
use antumbra_scene::{Faces, ObjectInput, PartInput, SceneInput};

/// A GLB file from its JSON text and binary chunk.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", json), (b"BIN\0", binary)] {
        out.extend((data.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(data);
    }
    out
}

fn parse(bytes: &[u8]) -> Result<SceneInput, ReadError> {
    parse_scene(bytes, "t.glb", &ReadOptions::default(), &mut |uri| {
        Err(io::Error::new(io::ErrorKind::NotFound, format!("no {uri}")))
    })
}

fn message(bytes: &[u8]) -> String {
    let error = parse(bytes).expect_err("damaged");
    assert!(!error.is_path_error());
    error.to_string()
}

/// Four vertices of a unit square in the plane y = 0, then indices 0 1 2 0 2 3 as u8, u16, u32.
fn square() -> Vec<u8> {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0_f32],
    ];
    let mut out: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|c| c.to_le_bytes())
        .collect();
    let order = [0_u8, 1, 2, 0, 2, 3];
    out.extend(order);
    out.extend(order.iter().flat_map(|i| u16::from(*i).to_le_bytes()));
    out.extend(order.iter().flat_map(|i| u32::from(*i).to_le_bytes()));
    out
}

const VIEWS: &str = r#""buffers":[{"byteLength":90}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6},
{"buffer":0,"byteOffset":54,"byteLength":12},{"buffer":0,"byteOffset":66,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"},
{"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"},
{"bufferView":3,"componentType":5125,"count":6,"type":"SCALAR"}]"#;

/// A document with the square's buffers and whatever else is given.
fn document(rest: &str) -> Vec<u8> {
    glb(
        &format!(r#"{{"asset":{{"version":"2.0"}},{VIEWS},{rest}}}"#),
        &square(),
    )
}

/// One node with one primitive.
fn primitive(text: &str) -> Vec<u8> {
    document(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{text}]}}]"#
    ))
}

fn faces(scene: &SceneInput) -> Vec<Vec<u32>> {
    let parts = scene.objects.iter().flat_map(|object| &object.parts);
    parts
        .flat_map(|part| part.faces.iter().map(<[u32]>::to_vec))
        .collect()
}

#[test]
fn all_index_types_and_modes_are_read() {
    let quad = vec![vec![0, 1, 2], vec![0, 2, 3]];
    for indices in 1..=3 {
        let text = format!(r#"{{"attributes":{{"POSITION":0}},"indices":{indices}}}"#);
        assert_eq!(faces(&parse(&primitive(&text)).expect("valid")), quad);
    }
    let strip = r#"{"attributes":{"POSITION":0},"mode":5}"#;
    assert_eq!(
        faces(&parse(&primitive(strip)).expect("valid")),
        [[0, 1, 2], [2, 1, 3]]
    );
    let fan = r#"{"attributes":{"POSITION":0},"mode":6}"#;
    assert_eq!(faces(&parse(&primitive(fan)).expect("valid")), quad);
    let lines = r#"{"attributes":{"POSITION":0},"mode":1}"#;
    assert!(message(&primitive(lines)).contains("there are no triangles in this GLB file"));
}

#[test]
fn vertices_are_turned_to_z_up() {
    let scene = parse(&primitive(r#"{"attributes":{"POSITION":0},"indices":1}"#)).expect("valid");
    let expected = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, -1.0, 0.0],
        [0.0, -1.0, 0.0],
    ];
    assert_eq!(scene.objects[0].parts[0].vertices, expected);
}

const SQUARE_MESH: &str =
    r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]"#;

#[test]
fn transforms_add_up_along_the_hierarchy() {
    // Parent: quarter turn about Y by matrix and a shift; child: scale and shift.
    let nodes = r#""scene":0,"scenes":[{"nodes":[1]}],"nodes":[
        {"mesh":0,"name":"child","scale":[2,2,2],"translation":[1,0,0]},
        {"matrix":[0,0,-1,0, 0,1,0,0, 1,0,0,0, 0,10,0,1],"children":[0,2]},
        {"mesh":0,"name":"turned","rotation":[0,0.7071068,0,0.7071068]},
        {"mesh":0,"name":"elsewhere"}],"#;
    let scene = parse(&document(&format!("{nodes}{SQUARE_MESH}"))).expect("valid");
    let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_deref()).collect();
    assert_eq!(names, [Some("child"), Some("turned"), Some("elsewhere")]);
    // (1,0,1) -> scaled and shifted (3,0,2) -> turned (2,0,-3) -> shifted (2,10,-3) -> Z-up.
    assert_eq!(scene.objects[0].parts[0].vertices[2], [2.0, 3.0, 10.0]);
    // Two quarter turns about Y are a half turn, exactly.
    assert_eq!(scene.objects[1].parts[0].vertices[2], [-1.0, 1.0, 10.0]);
    assert!(
        scene.objects[2].parts.is_empty(),
        "a node outside the scene keeps only its id"
    );
}

#[test]
fn classes_come_from_extras_or_else_materials() {
    let text = r#""nodes":[{"mesh":0,"extras":{"class":"wall"}},{"mesh":0},{"mesh":1},{"mesh":2}],
        "materials":[{"name":"glass","alphaMode":"BLEND"},{"name":"leaf","alphaMode":"MASK"},{"name":"brick","alphaMode":"OPAQUE"}],
        "meshes":[{"extras":{"class":"mesh"},"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":2}]},
        {"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0},{"attributes":{"POSITION":0},"indices":1,"material":2},{"attributes":{"POSITION":0},"indices":1}]},
        {"extras":7,"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}]"#;
    let scene = parse(&document(text)).expect("valid");
    let found: Vec<Vec<_>> = scene
        .objects
        .iter()
        .map(|o| {
            o.parts
                .iter()
                .map(|p| (p.class.as_deref(), p.translucent))
                .collect()
        })
        .collect();
    assert_eq!(found[0], [(Some("wall"), false)]);
    assert_eq!(found[1], [(Some("mesh"), false)]);
    assert_eq!(
        found[2],
        [(Some("glass"), true), (Some("brick"), false), (None, false)]
    );
    assert_eq!(found[3], [(Some("leaf"), true)]);
}

#[test]
fn sparse_and_quantized_accessors_are_read() {
    // Zeros, patched at vertices 1 and 2 by the square's vertices 0 and 1 (views at offsets).
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":44}],
        "bufferViews":[{"buffer":0,"byteLength":4},{"buffer":0,"byteOffset":4,"byteLength":24},{"buffer":0,"byteOffset":28,"byteLength":16,"byteStride":4}],
        "accessors":[{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,"indices":{"bufferView":0,"componentType":5123},"values":{"bufferView":1}}},
        {"bufferView":2,"componentType":5120,"normalized":true,"count":4,"type":"VEC3"}],
        "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"POSITION":1},"mode":6}]}]}"#;
    let mut binary: Vec<u8> = [1_u16, 2].iter().flat_map(|i| i.to_le_bytes()).collect();
    binary.extend(
        [5.0_f32, 0.0, 0.0, 0.0, 6.0, 0.0]
            .iter()
            .flat_map(|c| c.to_le_bytes()),
    );
    binary.extend([0, 0, 0, 9, 127, 0, 0, 9, 127, 127, 0, 9, 0x80, 127, 0, 9]);
    let scene = parse(&glb(json, &binary)).expect("valid");
    let [sparse, quantized] = &scene.objects[0].parts[..] else {
        panic!("two parts")
    };
    assert_eq!(
        sparse.vertices,
        [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 6.0]]
    );
    assert_eq!(quantized.vertices[2], [1.0, 0.0, 1.0]);
    assert_eq!(quantized.vertices[3], [-1.0, 0.0, 1.0]);
}

#[test]
fn buffers_may_be_files_or_data_uris() {
    let json =
        format!(r#"{{"asset":{{"version":"2.0"}},{VIEWS},"nodes":[{{"mesh":0}}],{SQUARE_MESH}}}"#);
    let with_uri = |uri: &str| {
        json.replace(
            "{\"byteLength\":90",
            &format!("{{\"uri\":{uri:?},\"byteLength\":90"),
        )
    };
    let mut asked = Vec::new();
    let text = with_uri("a%20b.bin");
    let scene = parse_scene(
        text.as_bytes(),
        "t.gltf",
        &ReadOptions::default(),
        &mut |uri| {
            asked.push(uri.to_owned());
            Ok(square())
        },
    );
    assert_eq!(scene.expect("valid").objects.len(), 1);
    assert_eq!(asked, ["a b.bin"]);
    let base64 = "data:application/octet-stream;base64,".to_owned() + &base64(&square());
    assert_eq!(
        parse(with_uri(&base64).as_bytes())
            .expect("valid")
            .objects
            .len(),
        1
    );

    let missing = message(text.as_bytes());
    assert!(
        missing.starts_with(
            "t.glb: buffer 0: the file \"a%20b.bin\" beside it cannot be read (no a b.bin)"
        ),
        "{missing}"
    );
    let remote = message(with_uri("https://example.org/a.bin").as_bytes());
    assert!(
        remote.contains("buffer 0: its data lies at \"https://example.org/a.bin\"; download it"),
        "{remote}"
    );
    let none = message(json.as_bytes());
    assert!(none.contains("buffer 0: it has no URI"), "{none}");
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digit = |n: u32| char::from(DIGITS[(n & 63) as usize]);
    assert_eq!(bytes.len() % 3, 0, "no padding needed here");
    let groups = bytes
        .chunks(3)
        .map(|c| u32::from(c[0]) << 16 | u32::from(c[1]) << 8 | u32::from(c[2]));
    groups
        .flat_map(|n| [digit(n >> 18), digit(n >> 12), digit(n >> 6), digit(n)])
        .collect()
}

#[test]
fn every_truncation_is_an_error_with_a_place() {
    let whole = primitive(r#"{"attributes":{"POSITION":0},"indices":1}"#);
    parse(&whole).expect("valid");
    for length in 0..whole.len() {
        let text = message(&whole[..length]);
        assert!(
            text.starts_with("t.glb: ") && text.contains("; "),
            "{length}: {text}"
        );
    }
}

#[test]
fn damage_is_named_with_its_place() {
    let good = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let cases: BTreeMap<&str, (Vec<u8>, &str)> = BTreeMap::from([
        (
            "no accessor",
            (
                primitive(r#"{"attributes":{"POSITION":9}}"#),
                "mesh 0, primitive 0: accessor 9 does not exist, there are 4",
            ),
        ),
        (
            "no mode",
            (
                primitive(r#"{"attributes":{"POSITION":0},"mode":7}"#),
                "mesh 0, primitive 0: mode 7 does not exist",
            ),
        ),
        (
            "scalar positions",
            (
                primitive(r#"{"attributes":{"POSITION":1}}"#),
                "accessor 1: positions of type \"SCALAR\"",
            ),
        ),
        (
            "vector indices",
            (
                primitive(r#"{"attributes":{"POSITION":0},"indices":0}"#),
                "accessor 0: indices of type \"VEC3\"",
            ),
        ),
        (
            "four corners",
            (
                primitive(r#"{"attributes":{"POSITION":0}}"#),
                "mesh 0, primitive 0: a list of triangles with 4 corners",
            ),
        ),
        (
            "no material",
            (
                primitive(r#"{"attributes":{"POSITION":0},"indices":1,"material":3}"#),
                "mesh 0, primitive 0: material 3 does not exist, there are 0",
            ),
        ),
        (
            "no mesh",
            (
                document(r#""nodes":[{"mesh":2}]"#),
                "node 0: mesh 2 does not exist, there are 0",
            ),
        ),
        (
            "no node",
            (
                document(r#""scenes":[{"nodes":[4]}],"nodes":[{}]"#),
                "scene 0: node 4 does not exist, there are 1",
            ),
        ),
        (
            "no scene",
            (
                document(r#""scene":3,"nodes":[{}]"#),
                "scene 3 does not exist, there are 0",
            ),
        ),
        (
            "own ancestor",
            (
                document(r#""scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]"#),
                "node 0: it is reached twice",
            ),
        ),
        (
            "huge transform",
            (
                document(&format!(
                    r#""nodes":[{{"mesh":0,"scale":[1e308,1,1],"children":[]}},{{"children":[2],"scale":[1e308,1,1]}},{{"scale":[1e308,1,1]}}],{SQUARE_MESH}"#
                )),
                "node 2: its transform is not finite",
            ),
        ),
        (
            "compressed",
            (
                document(r#""extensionsRequired":["KHR_draco_mesh_compression"]"#),
                "the geometry needs the extension KHR_draco_mesh_compression",
            ),
        ),
        (
            "wrong type",
            (document(r#""nodes":[{"mesh":"a"}]"#), "JSON line 7, column"),
        ),
    ]);
    for (name, (bytes, expected)) in cases {
        let text = message(&bytes);
        assert!(
            text.starts_with(&format!("t.glb: {expected}")),
            "{name}: {text}"
        );
    }
    let with = |from: &str, to: &str| {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},{VIEWS},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{good}]}}]}}"#
        );
        assert!(json.contains(from), "{from}");
        message(&glb(&json.replace(from, to), &square()))
    };
    let cases = [
        (
            "\"count\":4",
            "\"count\":5",
            "accessor 0: 5 elements, but its bufferView has room for 4 at most",
        ),
        (
            "\"count\":4",
            "\"byteOffset\":4,\"count\":4",
            "accessor 0: 4 elements from byte 4 on do not fit its bufferView of 48 bytes",
        ),
        (
            "\"count\":4",
            "\"count\":2",
            "accessor 1: entry 2 is vertex 2, but there are 2 in accessor 0",
        ),
        (
            "\"bufferView\":1,",
            "\"bufferView\":8,",
            "accessor 1: bufferView 8 does not exist, there are 4",
        ),
        (
            "\"componentType\":5121",
            "\"componentType\":7",
            "accessor 1: componentType 7 does not exist",
        ),
        (
            "\"componentType\":5121",
            "\"componentType\":5120",
            "accessor 1: indices that are not unsigned integers",
        ),
        (
            "\"byteLength\":48",
            "\"byteLength\":480",
            "bufferView 0: 480 bytes from byte 0 on do not fit buffer 0 of 92 bytes",
        ),
        (
            "\"byteLength\":48",
            "\"byteStride\":8,\"byteLength\":48",
            "accessor 0: elements of 12 bytes, but a byteStride of 8",
        ),
        (
            "\"byteLength\":90",
            "\"byteLength\":900",
            "buffer 0: 900 bytes are promised, but there are 92",
        ),
        (
            "{\"buffer\":0,\"byteLength\":48}",
            "{\"buffer\":3,\"byteLength\":48}",
            "bufferView 0: buffer 3 does not exist, there are 1",
        ),
        (
            "\"bufferView\":0,\"componentType\":5126,\"count\":4",
            "\"componentType\":5126,\"count\":99999999999",
            "accessor 0: 99999999999 elements",
        ),
        (
            "\"version\":\"2.0\"",
            "\"version\":\"1.0\"",
            "this is glTF version \"1.0\"; convert it to glTF 2.0",
        ),
        (
            "\"asset\":{\"version\":\"2.0\"},",
            "",
            "this is JSON, but not glTF: it has no \"asset\" entry",
        ),
    ];
    for (from, to, expected) in cases {
        let text = with(from, to);
        assert!(text.starts_with(&format!("t.glb: {expected}")), "{text}");
    }
    let mut nan = square();
    nan[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},{VIEWS},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{good}]}}]}}"#
    );
    let text = message(&glb(&json, &nan));
    assert!(
        text.starts_with("t.glb: accessor 0: vertex 1 is (NaN, 0, 0), which is not finite"),
        "{text}"
    );
}

#[test]
fn files_of_another_kind_are_named() {
    let cases: [(&[u8], &str); 6] = [
        (b"", "the file is empty"),
        (
            b"\x89PNG\r\n\x1a\n....",
            "this is a PNG picture, not a scene",
        ),
        (
            b"{\"type\":\"FeatureCollection\",\"features\":[]}",
            "this is JSON, but not glTF",
        ),
        (b"{\"nodes\":{\"a\":1}}", "this is JSON, but not glTF"),
        (
            b"{\"asset\":{\"version\":\"2.0\"",
            "JSON line 1, column 25: EOF while parsing",
        ),
        (
            b"glTF\x01\0\0\0\x20\0\0\0aaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
            "byte 4: GLB version 1, expected 2",
        ),
    ];
    for (bytes, expected) in cases {
        let text = message(bytes);
        assert!(text.starts_with(&format!("t.glb: {expected}")), "{text}");
    }
}

/// The same part at some offset.
fn part_at(x: f64, class: Option<&str>, translucent: bool) -> PartInput {
    PartInput {
        class: class.map(str::to_owned),
        translucent,
        vertices: vec![[x, 0.25, 1.0], [x + 1.5, 0.25, 1.0], [x, 8.0, 1.0]],
        faces: Faces::from_iter([[0, 1, 2]]),
    }
}

fn mixed() -> SceneInput {
    let object = |name: Option<&str>, parts| ObjectInput {
        name: name.map(str::to_owned),
        parts,
    };
    SceneInput {
        objects: vec![
            object(Some("a"), vec![part_at(0.0, Some("wall"), false)]),
            object(Some("a"), vec![]),
            object(
                None,
                vec![part_at(7.0, None, true), part_at(9.0, None, false)],
            ),
            object(Some("far"), vec![part_at(1024.0, Some("wall"), false)]),
        ],
        source_name: "t.glb".to_owned(),
    }
}

#[test]
fn what_is_written_is_read_back() {
    for instancing in [Instancing::Never, Instancing::WhenExact, Instancing::Always] {
        let metadata = Some(serde_json::json!({"seed": 7}));
        let bytes = write_glb(
            &mixed(),
            &GlbOptions {
                instancing,
                metadata,
            },
        );
        assert_eq!(parse(&bytes).expect("own file"), mixed());
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("\"extras\":{\"seed\":7}"));
        let meshes = if instancing == Instancing::Never {
            4
        } else {
            3
        };
        assert_eq!(text.matches("\"primitives\"").count(), meshes);
    }
}

#[test]
#[allow(clippy::print_stderr, reason = "says that it did nothing")]
fn real_buildings_are_read() {
    let data = std::env::var_os("ANTUMBRA_DATA").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        Into::into,
    );
    for (name, objects) in [
        ("duplex", 215),
        ("kit_institute", 699),
        ("delft_block", 570),
        ("quake_e1m1", 1456),
    ] {
        let path = data.join(format!("walk/{name}.glb"));
        if !path.exists() {
            eprintln!("skipped: {} is absent", path.display());
            return;
        }
        let scene = read_scene(&path).expect("a good file");
        assert_eq!(scene.objects.len(), objects);
        assert!(
            scene
                .objects
                .iter()
                .flat_map(|o| &o.parts)
                .all(|p| p.class.is_some())
        );
        let again = write_glb(&scene, &GlbOptions::default());
        let mut again = parse(&again).expect("own file");
        again.source_name.clone_from(&scene.source_name);
        assert_eq!(again, scene);
    }
}
