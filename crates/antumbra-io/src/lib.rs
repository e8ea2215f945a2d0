//! *Files.* The edge of Antumbra where bytes become scenes and results become bytes: one module
//! and one cargo feature a format, all on by default.
//!
//! | feature | reads | writes |
//! |---|---|---|
//! | `gltf` | glTF 2.0 and GLB | [`write_glb`] |
//! | `obj` | Wavefront OBJ | [`write_obj`] |
//! | `ply`, `stl` | PLY and STL, text and binary | |
//! | `gzip` | any of these, compressed | |
//! | `drawing` | | SVG and DXF of lines: [`drawing`] |
//! | `plan` | plans: GeoJSON, SVG, DXF, text: [`plan`] | |
//! | `pvs` | [`PvsFile`], [`ProofFile`] | [`PvsWriter`], and JSON by [`export`] |
//!
//! Readers take bytes and hand over a [`SceneInput`](antumbra_scene::SceneInput): float
//! vertices, Z-up, nothing snapped. Only [`read_scene`], [`PvsFile::open`], [`ProofFile::open`]
//! and [`PvsWriter`] touch the file system. No input, however damaged, makes a reader panic.
//!
//! ```
//! use antumbra_io::{ReadOptions, parse_scene};
//! let text = b"o table\nusemtl wood\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 0 1 1\nf 1 2 3 4\n";
//! let scene = parse_scene(text, "table.obj", &ReadOptions::default(), &mut |uri| {
//!     Err(std::io::Error::other(format!("{uri}: a text scene has no other files")))
//! })?;
//! assert_eq!(scene.objects[0].name.as_deref(), Some("table"));
//! assert_eq!(scene.objects[0].parts[0].class.as_deref(), Some("wood"));
//! assert_eq!(scene.objects[0].parts[0].faces.len(), 1);
//! # Ok::<(), antumbra_io::ReadError>(())
//! ```

// With few formats some of the checks have no user.
#[cfg_attr(not(all(feature = "gltf", feature = "stl")), allow(dead_code))]
mod bytes;
#[cfg_attr(not(all(feature = "gltf", feature = "stl")), allow(dead_code))]
mod error;
mod format;
mod read;

#[cfg(feature = "gltf")]
mod gltf;
#[cfg(feature = "obj")]
mod obj;
#[cfg(feature = "ply")]
mod ply;
#[cfg(feature = "stl")]
mod stl;

#[cfg(feature = "pvs")]
pub mod compare;
#[cfg(feature = "drawing")]
pub mod drawing;
#[cfg(feature = "pvs")]
pub mod export;
#[cfg(feature = "plan")]
pub mod plan;
#[cfg(feature = "pvs")]
mod proof;
#[cfg(feature = "pvs")]
pub mod pvs;

pub use error::{Damage, Place, ReadError, said};
pub use format::Format;
#[cfg(feature = "gltf")]
pub use gltf::{GlbOptions, Instancing, write_glb};
#[cfg(feature = "obj")]
pub use obj::write_obj;
#[cfg(feature = "pvs")]
pub use proof::ProofFile;
#[cfg(feature = "pvs")]
pub use pvs::{PvsError, PvsFile, PvsWriter};
pub use read::{
    ReadOptions, Resolver, Up, parse_scene, read_scene, read_scene_with, read_unpacked,
};
