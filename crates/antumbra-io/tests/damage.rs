//! Small valid files of each format, cut and changed at random: errors are fine, panics are not.

use std::io::Write;

use antumbra_io::{GlbOptions, ReadOptions, Up, parse_scene, write_glb, write_obj};
use antumbra_scene::{Faces, ObjectInput, PartInput, SceneInput};

/// Numbers that look random and are the same each time (SplitMix64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) % n.max(1) as u64) as usize
    }
}

fn scene() -> SceneInput {
    let part = PartInput {
        class: Some("wall".into()),
        vertices: vec![
            [0.0, 0.0, 0.5],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ],
        faces: Faces::from_iter([[0, 1, 2], [0, 2, 3]]),
        ..PartInput::default()
    };
    let object = ObjectInput {
        name: Some("a".into()),
        parts: vec![part],
    };
    SceneInput {
        objects: vec![object.clone(), object],
        source_name: String::new(),
    }
}

fn gltf_with_data_uri() -> Vec<u8> {
    br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"scale":[1,2,3]},{"mesh":0,"extras":{"class":"a"}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5,"material":0}]}],"materials":[{"alphaMode":"BLEND"}],
"accessors":[{"bufferView":0,"componentType":5121,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}],
"bufferViews":[{"buffer":0,"byteLength":12}],"buffers":[{"byteLength":12,"uri":"data:;base64,AAECAwABAgMAAQID"}]}"#
        .to_vec()
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

fn binary_ply(big: bool) -> Vec<u8> {
    let name = if big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let header = PLY
        .split("0 0 0")
        .next()
        .unwrap_or_default()
        .replace("ascii", name);
    let mut out = header.into_bytes();
    let order = |mut bytes: [u8; 4]| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    for c in [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32] {
        out.extend(order(c.to_le_bytes()));
    }
    out.push(3);
    for i in 0..3_i32 {
        out.extend(order(i.to_le_bytes()));
    }
    out
}

fn binary_stl() -> Vec<u8> {
    let mut out = vec![0; 80];
    out.extend(2_u32.to_le_bytes());
    for _ in 0..2 {
        out.extend([0; 12]);
        out.extend(
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32]
                .iter()
                .flat_map(|c| c.to_le_bytes()),
        );
        out.extend([0; 2]);
    }
    out
}

const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("memory");
    encoder.finish().expect("memory")
}

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.glb", write_glb(&scene(), &GlbOptions::default())),
        ("a.gltf", gltf_with_data_uri()),
        ("a.obj", write_obj(&scene()).into_bytes()),
        ("a.ply", PLY.as_bytes().to_vec()),
        ("little.ply", binary_ply(false)),
        ("big.ply", binary_ply(true)),
        ("a.stl", STL.as_bytes().to_vec()),
        ("binary.stl", binary_stl()),
        ("a.obj.gz", gzip(write_obj(&scene()).as_bytes())),
        (
            "a.glb.gz",
            gzip(&write_glb(&scene(), &GlbOptions::default())),
        ),
    ]
}

/// Reads bytes and checks that an error is one sentence that begins with the file's name.
fn try_reading(name: &str, bytes: &[u8]) {
    let options = ReadOptions { up: Up::Y };
    let result = parse_scene(bytes, name, &options, &mut |_| {
        Err(std::io::Error::other("none"))
    });
    if let Err(error) = result {
        let text = error.to_string();
        assert!(
            text.starts_with(&format!("{name}: ")) && text.contains("; "),
            "{text}"
        );
    }
}

#[test]
fn the_samples_are_valid() {
    for (name, bytes) in samples() {
        let scene = parse_scene(&bytes, name, &ReadOptions::default(), &mut |_| {
            Err(std::io::Error::other("none"))
        });
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        assert!(scene.objects.iter().any(|o| !o.parts.is_empty()), "{name}");
    }
}

#[test]
fn cut_files_never_panic() {
    for (name, bytes) in samples() {
        for length in 0..bytes.len() {
            try_reading(name, &bytes[..length]);
        }
    }
}

#[test]
fn changed_files_never_panic() {
    for (name, bytes) in samples() {
        let mut random = Random(name.len() as u64);
        for _ in 0..5_000 {
            let mut changed = bytes.clone();
            for _ in 0..=random.below(4) {
                if changed.is_empty() {
                    break;
                }
                let at = random.below(changed.len());
                match random.below(6) {
                    0 => changed[at] = random.below(256) as u8,
                    1 => changed[at] ^= 1 << random.below(8),
                    2 => changed[at] = b"0123456789-.e,[]{}\" \n"[random.below(21)],
                    3 => drop(changed.remove(at)),
                    4 => changed.insert(at, b"0123456789-\0\xff\n"[random.below(14)]),
                    _ => changed.truncate(at.max(1)),
                }
            }
            try_reading(name, &changed);
        }
    }
}

#[test]
fn compressed_and_plain_files_are_the_same_scene() {
    let text = write_obj(&scene());
    let read = |bytes: &[u8]| {
        let mut none = |_: &str| Err(std::io::Error::other("none"));
        parse_scene(bytes, "a.obj", &ReadOptions::default(), &mut none).expect("valid")
    };
    assert_eq!(read(&gzip(text.as_bytes())), read(text.as_bytes()));
}
