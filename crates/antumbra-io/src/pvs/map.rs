//! The bytes of a file: mapped into memory, or owned.
//!
//! The only `unsafe` of the library lives here.
#![allow(unsafe_code, reason = "mapping a file into memory; see SAFETY below")]

use std::fs::File;
use std::io;
use std::ops::Deref;
use std::path::Path;

use memmap2::Mmap;

/// Bytes that stay put for as long as they are used.
#[derive(Debug)]
pub(crate) enum Bytes {
    Owned(Vec<u8>),
    Mapped(Mmap),
}

impl Bytes {
    /// Maps a file read-only.
    pub(crate) fn map(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        // Empty files cannot be mapped everywhere, folders nowhere.
        let metadata = file.metadata()?;
        if metadata.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::IsADirectory,
                "it is a folder",
            ));
        }
        if metadata.len() == 0 {
            return Ok(Self::Owned(Vec::new()));
        }
        // SAFETY: the map is read-only and private to this type. It is undefined only if someone
        // changes the file in place while it is mapped. Antumbra never does: it writes a new file
        // and renames it over the old one, which leaves the mapped one as it is. Nothing read from
        // the map is trusted beyond its bounds-checked, checksummed bytes: no reference to a type
        // with invalid values is made from it.
        let map = unsafe { Mmap::map(&file)? };
        Ok(Self::Mapped(map))
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Owned(bytes) => bytes,
            Self::Mapped(map) => map,
        }
    }
}
