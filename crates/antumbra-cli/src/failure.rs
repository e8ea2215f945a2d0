//! How a command can fail: one sentence for people, one exit code for scripts.

use std::fmt;
use std::path::Path;

use antumbra_io::said;

/// Why a command did not do what it was asked to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// The options do not make sense: exit code 2.
    Usage(String),
    /// Damaged or impossible content: exit code 3.
    Content(String),
    /// A path that cannot be read or written: exit code 4.
    Path(String),
    /// Stopped by the user or a budget; what was finished is saved: exit code 5.
    Stopped(String),
}

impl Failure {
    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Content(_) => 3,
            Self::Path(_) => 4,
            Self::Stopped(_) => 5,
        }
    }

    /// A file that cannot be written.
    pub(crate) fn unwritable(path: &Path, cause: &std::io::Error) -> Self {
        Self::Path(format!(
            "{}: cannot be written ({}); check the path and its permissions",
            path.display(),
            said(cause)
        ))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Usage(text) | Self::Content(text) | Self::Path(text) | Self::Stopped(text)) =
            self;
        f.write_str(text)
    }
}
