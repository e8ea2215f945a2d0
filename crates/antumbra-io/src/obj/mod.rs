//! Wavefront OBJ: a reader of vertices, faces, objects or groups and material names, and a writer.

mod read;
mod write;

pub(crate) use read::read;
pub use write::write_obj;
