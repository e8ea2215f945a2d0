//! Reads any bytes as glTF: as they are, and as the JSON and binary chunks of a GLB file.
#![no_main]

mod scene;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    scene::read(bytes, "fuzz.gltf");
    // A container around the bytes, so that the document is reached without guessing lengths.
    let cut = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (json, binary) = bytes.split_at(cut);
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + bytes.len() as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", json), (b"BIN\0", binary)] {
        file.extend((data.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(data);
    }
    scene::read(&file, "fuzz.glb");
});
