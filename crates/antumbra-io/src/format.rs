//! Which format a file has: its content decides, its name only where the content does not say.

use crate::error::{Damage, Place};

/// The scene formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// glTF 2.0 as JSON text.
    Gltf,
    /// glTF 2.0 in its binary container.
    Glb,
    /// Wavefront OBJ.
    Obj,
    /// PLY, text or binary.
    Ply,
    /// STL, text or binary.
    Stl,
}

impl Format {
    /// Recognizes a format by content first, by the extension of `file_name` second.
    ///
    /// ```
    /// use antumbra_io::Format;
    /// assert_eq!(Format::recognize(b"glTF\x02\0\0\0", "x.obj"), Some(Format::Glb));
    /// assert_eq!(Format::recognize(b"# made by hand\nv 0 0 0\n", "x.txt"), Some(Format::Obj));
    /// assert_eq!(Format::recognize(b"\x89PNG\r\n\x1a\n", "x.png"), None);
    /// ```
    #[must_use]
    pub fn recognize(bytes: &[u8], file_name: &str) -> Option<Self> {
        by_content(bytes).or_else(|| {
            if foreign(bytes).is_some() {
                None
            } else {
                by_extension(file_name)
            }
        })
    }

    /// The format's usual name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
        }
    }
}

/// What to say of a file whose format is not recognized.
pub(crate) fn unknown(bytes: &[u8]) -> Damage {
    let found = match foreign(bytes) {
        Some(what) => format!("this is {what}, not a scene"),
        None => "the format is not recognized".to_owned(),
    };
    Damage::new(
        Place::Whole,
        found,
        "give a glTF, GLB, OBJ, PLY or STL file",
    )
}

fn by_content(bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Some(Format::Ply);
    }
    if binary_stl_facets(bytes).is_some_and(|n| bytes.len() as u64 == 84 + 50 * n) {
        return Some(Format::Stl);
    }
    let text = bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(bytes)
        .trim_ascii_start();
    if text.first() == Some(&b'{') {
        return Some(Format::Gltf);
    }
    let head = &text[..text.len().min(4096)];
    if head.contains(&0) {
        return None;
    }
    let is_stl = |line: &[u8]| line.starts_with(b"facet") || line.starts_with(b"endsolid");
    if head.starts_with(b"solid") && lines(head).any(is_stl) {
        return Some(Format::Stl);
    }
    let obj_line = |line: &[u8]| {
        let keyword = line
            .split(u8::is_ascii_whitespace)
            .next()
            .unwrap_or_default();
        [
            &b"v"[..],
            b"vn",
            b"vt",
            b"f",
            b"o",
            b"g",
            b"mtllib",
            b"usemtl",
        ]
        .contains(&keyword)
    };
    let first = lines(head).find(|line| !line.is_empty() && line[0] != b'#');
    first.is_some_and(obj_line).then_some(Format::Obj)
}

fn lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|b| *b == b'\n' || *b == b'\r')
        .map(<[u8]>::trim_ascii)
}

/// The facet count that a binary STL file states, if there is room for its header.
pub(crate) fn binary_stl_facets(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..84)?;
    Some(u64::from(u32::from_le_bytes(count.try_into().ok()?)))
}

fn by_extension(file_name: &str) -> Option<Format> {
    let name = file_name.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let (_, extension) = name.rsplit_once('.')?;
    match extension {
        "glb" => Some(Format::Glb),
        "gltf" => Some(Format::Gltf),
        "obj" => Some(Format::Obj),
        "ply" => Some(Format::Ply),
        "stl" => Some(Format::Stl),
        _ => None,
    }
}

/// Well-known formats that are no scenes, so that the message can name them.
fn foreign(bytes: &[u8]) -> Option<&'static str> {
    const MARKS: [(&[u8], &str); 13] = [
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"GIF8", "a GIF picture"),
        (b"%PDF", "a PDF document"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "gzip data"),
        (b"\x7fELF", "a program"),
        (b"Kaydara FBX", "an FBX scene"),
        (b"BLENDER", "a Blender file"),
        (b"ISO-10303-21", "an IFC or STEP file"),
        (b"\x89PVS", "a .pvs file"),
        (b"\x89PRF", "a .proof file"),
        (b"<", "an XML or HTML text"),
    ];
    MARKS
        .iter()
        .find(|(mark, _)| bytes.starts_with(mark))
        .map(|(_, what)| *what)
}

#[cfg(test)]
mod tests {
    use super::Format;

    #[test]
    fn content_comes_before_the_extension() {
        let cases: [(&[u8], &str, Option<Format>); 9] = [
            (b"ply\nformat ascii 1.0\n", "a.obj", Some(Format::Ply)),
            (b"solid cube\nfacet normal 0 0 1\n", "a", Some(Format::Stl)),
            (b" \n{\"asset\":{}}", "a.stl", Some(Format::Gltf)),
            (b"\xef\xbb\xbfo cube\nv 0 0 0\n", "a", Some(Format::Obj)),
            (b"hello", "a.obj", Some(Format::Obj)),
            (b"hello", "a.stl.gz", Some(Format::Stl)),
            (b"hello", "a.txt", None),
            (b"\x89PNG\r\n", "a.obj", None),
            (b"", "obj", None),
        ];
        for (bytes, name, expected) in cases {
            assert_eq!(Format::recognize(bytes, name), expected, "{name}");
        }
    }

    #[test]
    fn a_binary_stl_may_begin_with_solid() {
        let mut bytes = vec![b' '; 84 + 50];
        bytes[..5].copy_from_slice(b"solid");
        bytes[80..84].copy_from_slice(&1_u32.to_le_bytes());
        assert_eq!(Format::recognize(&bytes, ""), Some(Format::Stl));
    }
}
