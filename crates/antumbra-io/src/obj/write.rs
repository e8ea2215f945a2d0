//! Writes Wavefront OBJ text.

use std::fmt::Write;

use antumbra_scene::SceneInput;

/// A scene as OBJ text, Z-up, one `o` for each object and one `usemtl` for each part.
///
/// Coordinates are written in the shortest form that reads back as the same double. Parts
/// without a class get an empty `usemtl`; OBJ has no place for transparency. A nameless object is
/// written with its decimal id.
///
/// ```
/// # use antumbra_scene::{Faces, ObjectInput, PartInput, SceneInput};
/// let part = PartInput {
///     vertices: vec![[0.0, 0.0, 0.1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     faces: Faces::from_iter([[0, 1, 2]]),
///     ..PartInput::default()
/// };
/// let object = ObjectInput { name: Some("a".into()), parts: vec![part] };
/// let scene = SceneInput { objects: vec![object], ..SceneInput::default() };
/// assert_eq!(
///     antumbra_io::write_obj(&scene),
///     "o a\nusemtl\nv 0 0 0.1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
/// );
/// ```
#[must_use]
pub fn write_obj(scene: &SceneInput) -> String {
    let mut out = String::new();
    let mut first = 1_u64;
    for (id, object) in scene.objects.iter().enumerate() {
        match &object.name {
            Some(name) => line(&mut out, &format!("o {}", one_line(name))),
            None => line(&mut out, &format!("o {id}")),
        }
        for part in &object.parts {
            let class = part.class.as_deref().map(one_line).unwrap_or_default();
            line(&mut out, format!("usemtl {class}").trim_end());
            for [x, y, z] in &part.vertices {
                // Writing to a string cannot fail.
                let _ = writeln!(out, "v {x} {y} {z}");
            }
            for face in part.faces.iter() {
                out.push('f');
                for corner in face {
                    let _ = write!(out, " {}", first + u64::from(*corner));
                }
                out.push('\n');
            }
            first += part.vertices.len() as u64;
        }
    }
    out
}

fn line(out: &mut String, text: &str) {
    out.push_str(text);
    out.push('\n');
}

/// Names may hold anything; a line break or comment sign would change the meaning of the file.
fn one_line(name: &str) -> String {
    name.replace(['\n', '\r', '#', '\\'], " ")
}
