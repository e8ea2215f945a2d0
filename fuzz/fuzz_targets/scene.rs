//! What all scene targets do: read bytes as the format that a file name promises.

/// Reads bytes as a scene. External buffers are the bytes themselves.
pub fn read(bytes: &[u8], file: &str) {
    let options = antumbra_io::ReadOptions {
        up: antumbra_io::Up::Y,
    };
    let result = antumbra_io::parse_scene(bytes, file, &options, &mut |_| Ok(bytes.to_vec()));
    match result {
        Ok(scene) => {
            for part in scene.objects.iter().flat_map(|object| &object.parts) {
                assert!(part.vertices.iter().flatten().all(|c| c.is_finite()));
                let exists = |corner: &u32| (*corner as usize) < part.vertices.len();
                assert!(
                    part.faces
                        .iter()
                        .all(|face| face.len() >= 3 && face.iter().all(exists))
                );
            }
        }
        Err(error) => assert!(error.to_string().starts_with(file) && !error.is_path_error()),
    }
}
