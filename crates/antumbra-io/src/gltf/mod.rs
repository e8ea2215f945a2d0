//! glTF 2.0 and GLB: one object for each node with a mesh, in the order of `nodes`.
//!
//! The document is read by types of our own ([`document`]) and not by a glTF library, because
//! every fault has to come back as a sentence with its place, and none as a panic.

mod accessor;
mod buffers;
mod container;
mod document;
mod mesh;
mod nodes;
mod read;
mod write;

pub(crate) use read::{read_glb, read_gltf};
pub use write::{GlbOptions, Instancing, write_glb};
