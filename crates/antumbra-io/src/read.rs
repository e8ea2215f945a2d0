//! From a path or from bytes to a scene: recognizes the format, unpacks gzip, calls the reader.

use std::fs;
use std::io;
use std::path::Path;

use antumbra_scene::SceneInput;

use crate::error::{Damage, Place, ReadError};
use crate::format::{Format, unknown};

/// Which axis of a file points up. glTF says so itself and is not asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Up {
    /// Y is up: (x, y, z) becomes (x, -z, y).
    Y,
    /// Z is up, as in Antumbra: coordinates stay.
    #[default]
    Z,
}

impl Up {
    /// The point in Z-up coordinates. Exact.
    #[must_use]
    pub fn turn(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Y => [x, -z, y],
            Self::Z => [x, y, z],
        }
    }
}

/// How to read a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct ReadOptions {
    /// Which axis is up in formats that do not say (all but glTF).
    pub up: Up,
}

/// Fetches a file that a scene refers to, by its relative URI.
pub type Resolver<'a> = dyn FnMut(&str) -> io::Result<Vec<u8>> + 'a;

/// Reads a scene file with default options; see [`read_scene_with`].
///
/// # Errors
/// If the path cannot be read or the content is damaged; see [`ReadError`].
pub fn read_scene(path: &Path) -> Result<SceneInput, ReadError> {
    read_scene_with(path, &ReadOptions::default())
}

/// Reads a scene file. External buffers of a glTF file are looked up beside it.
///
/// The format is recognized by content first, by extension second; gzip'd files are unpacked.
///
/// # Errors
/// If the path cannot be read or the content is damaged; see [`ReadError`].
pub fn read_scene_with(path: &Path, options: &ReadOptions) -> Result<SceneInput, ReadError> {
    let file = path.display().to_string();
    let bytes = bytes_of(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    parse_scene(&bytes, &file, options, &mut |uri| {
        fs::read(folder.join(uri))
    })
}

/// The bytes of a text file that may be gzip'd: those of the text.
///
/// # Errors
/// If the path cannot be read or the gzip data is damaged.
pub fn read_unpacked(path: &Path) -> Result<Vec<u8>, ReadError> {
    let bytes = bytes_of(path)?;
    let unpacked = gunzip(&bytes).map_err(|damage| ReadError::Content {
        file: path.display().to_string(),
        damage,
    })?;
    Ok(unpacked.unwrap_or(bytes))
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    fs::read(path).map_err(|cause| ReadError::Path {
        file: path.display().to_string(),
        cause,
    })
}

/// Reads a scene from bytes. `file` names it in messages, and its extension helps where the
/// content does not tell the format; `resolve` fetches external buffers.
///
/// # Errors
/// If the content is damaged; never a [`ReadError::Path`].
pub fn parse_scene(
    bytes: &[u8],
    file: &str,
    options: &ReadOptions,
    resolve: &mut Resolver<'_>,
) -> Result<SceneInput, ReadError> {
    let content = |damage| ReadError::Content {
        file: file.to_owned(),
        damage,
    };
    let unpacked = gunzip(bytes).map_err(content)?;
    let bytes = unpacked.as_deref().unwrap_or(bytes);
    let mut scene = parse(bytes, file, options.up, resolve).map_err(content)?;
    scene.source_name = file.to_owned();
    Ok(scene)
}

fn parse(
    bytes: &[u8],
    file: &str,
    up: Up,
    resolve: &mut Resolver<'_>,
) -> Result<SceneInput, Damage> {
    if bytes.is_empty() {
        return Err(Damage::new(
            Place::Whole,
            "the file is empty",
            "give a scene file",
        ));
    }
    let format = Format::recognize(bytes, file).ok_or_else(|| unknown(bytes))?;
    let scene = read_as(format, bytes, up, resolve)?;
    let has_faces = |part: &antumbra_scene::PartInput| !part.faces.is_empty();
    if !scene
        .objects
        .iter()
        .any(|object| object.parts.iter().any(has_faces))
    {
        return Err(Damage::new(
            Place::Whole,
            format!("there are no triangles in this {} file", format.name()),
            "export the scene with its faces (lines and points block no view)",
        ));
    }
    Ok(scene)
}

fn read_as(
    format: Format,
    bytes: &[u8],
    up: Up,
    resolve: &mut Resolver<'_>,
) -> Result<SceneInput, Damage> {
    match format {
        #[cfg(feature = "gltf")]
        Format::Glb => crate::gltf::read_glb(bytes, resolve),
        #[cfg(feature = "gltf")]
        Format::Gltf => crate::gltf::read_gltf(bytes, resolve),
        #[cfg(feature = "obj")]
        Format::Obj => crate::obj::read(bytes, up),
        #[cfg(feature = "ply")]
        Format::Ply => crate::ply::read(bytes, up),
        #[cfg(feature = "stl")]
        Format::Stl => crate::stl::read(bytes, up),
        #[allow(
            unreachable_patterns,
            reason = "reachable when a format's feature is off"
        )]
        _ => {
            let _ = (bytes, up, &resolve);
            let found = format!("this is {}, which this build cannot read", format.name());
            Err(Damage::new(
                Place::Whole,
                found,
                "enable the cargo feature of that format",
            ))
        }
    }
}

/// Most bytes that a compressed file may unpack to.
#[cfg(feature = "gzip")]
const MOST_UNPACKED: u64 = 1 << 32;

/// The unpacked content of gzip data; `None` if it is not gzip.
pub(crate) fn gunzip(bytes: &[u8]) -> Result<Option<Vec<u8>>, Damage> {
    if !bytes.starts_with(b"\x1f\x8b") {
        return Ok(None);
    }
    #[cfg(feature = "gzip")]
    {
        use std::io::Read;
        let mut out = Vec::new();
        let mut limited = flate2::read::MultiGzDecoder::new(bytes).take(MOST_UNPACKED + 1);
        limited.read_to_end(&mut out).map_err(|cause| {
            Damage::broken(Place::Whole, format!("the gzip data is damaged ({cause})"))
        })?;
        if out.len() as u64 > MOST_UNPACKED {
            let found = format!("the gzip data unpacks to more than {MOST_UNPACKED} bytes");
            return Err(Damage::new(Place::Whole, found, "split the scene"));
        }
        Ok(Some(out))
    }
    #[cfg(not(feature = "gzip"))]
    Err(Damage::new(
        Place::Whole,
        "this is gzip data, which this build cannot read",
        "unpack it, or enable the cargo feature `gzip`",
    ))
}
