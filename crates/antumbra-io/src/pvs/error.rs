//! What can be wrong with `.pvs` and `.proof` files, and with writing them.

use std::io;

use crate::error::said;

/// Why a `.pvs` or `.proof` file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PvsError {
    /// A path cannot be read or written.
    #[error(
        "{file}: cannot be {action} ({}); check the path, its permissions and free space",
        said(cause)
    )]
    Path {
        /// The path.
        file: String,
        /// What was tried: `read`, `written` ...
        action: &'static str,
        /// What the operating system said.
        cause: io::Error,
    },
    /// The file is not what it should be, or was cut off or altered.
    #[error("{file}: {place}: {found}; {advice}")]
    Damaged {
        /// The file.
        file: String,
        /// Where in the file.
        place: String,
        /// What was found.
        found: String,
        /// What to do.
        advice: &'static str,
    },
    /// A journal or a proof belongs to something else.
    #[error("{file}: {found}; {advice}")]
    Mismatch {
        /// The file.
        file: String,
        /// What differs.
        found: String,
        /// What to do.
        advice: &'static str,
    },
    /// A cell's results contradict themselves or the header.
    #[error("cell {cell}: {found}; this is a fault of the program that made the results")]
    Record {
        /// The cell.
        cell: u32,
        /// What is wrong.
        found: String,
    },
}

impl PvsError {
    /// Whether a path was the trouble (exit code 4 of the command line), not the content (3).
    #[must_use]
    pub fn is_path_error(&self) -> bool {
        matches!(self, Self::Path { .. })
    }

    pub(crate) fn damaged(file: &str, place: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Damaged {
            file: file.to_owned(),
            place: place.into(),
            found: found.into(),
            advice: "copy the file again or bake it anew",
        }
    }
}
