//! What can be wrong with an input file, said in one sentence: which file, where in it, what was
//! found, what to do.

use std::fmt;
use std::io;

/// Why a scene could not be read.
///
/// ```
/// use antumbra_io::{ReadError, read_scene};
/// let error = read_scene("no/such/file.glb".as_ref()).unwrap_err();
/// assert!(error.is_path_error());
/// assert!(error.to_string().starts_with("no/such/file.glb: cannot be read (no such file"));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The path itself cannot be read (no such file, no permission, a folder).
    #[error(
        "{file}: cannot be read ({}); check the path and its permissions",
        said(cause)
    )]
    Path {
        /// The path as given.
        file: String,
        /// What the operating system said.
        cause: io::Error,
    },
    /// The file was read, but what is in it is damaged, impossible or not supported.
    #[error("{file}: {damage}")]
    Content {
        /// The file's name as given.
        file: String,
        /// Where, what, and what to do.
        damage: Damage,
    },
}

impl ReadError {
    /// Whether the path was the trouble (exit code 4 of the command line), not the content (3).
    #[must_use]
    pub fn is_path_error(&self) -> bool {
        matches!(self, Self::Path { .. })
    }
}

/// What the system said, in lower case and without its number: how messages about paths word it.
#[must_use]
pub fn said(cause: &io::Error) -> String {
    let text = cause.to_string();
    let text = text.split(" (os error").next().unwrap_or_default();
    text.to_lowercase()
}

/// A fault at a place of a file: what was found there and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// Where in the file.
    pub place: Place,
    /// What was found (and, where it helps, what was expected).
    pub found: String,
    /// What to do.
    pub advice: String,
}

impl Damage {
    pub(crate) fn new(place: Place, found: impl Into<String>, advice: impl Into<String>) -> Self {
        Self {
            place,
            found: found.into(),
            advice: advice.into(),
        }
    }

    /// For files that stop or contradict themselves: nothing can be done but to write them anew.
    pub(crate) fn broken(place: Place, found: impl Into<String>) -> Self {
        Self::new(place, found, "export or copy the file again")
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::Whole => write!(f, "{}; {}", self.found, self.advice),
            place => write!(f, "{place}: {}; {}", self.found, self.advice),
        }
    }
}

/// A place in a file. Numbers of things count from zero, lines from one.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A byte offset from the start.
    Byte(u64),
    /// A line of a text file, counted from one.
    Line(u64),
    /// A line and column of JSON text, both counted from one.
    Json {
        /// The line.
        line: usize,
        /// The column.
        column: usize,
    },
    /// An entry of a numbered list of the file, for example accessor 3.
    Item {
        /// The name of the list's entries: `accessor`, `node`, `facet` ...
        list: &'static str,
        /// Which one.
        index: u64,
    },
    /// A primitive of a mesh.
    Primitive {
        /// The mesh.
        mesh: u64,
        /// The primitive of that mesh.
        primitive: u64,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => write!(f, "the file"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Json { line, column } => write!(f, "JSON line {line}, column {column}"),
            Self::Item { list, index } => write!(f, "{list} {index}"),
            Self::Primitive { mesh, primitive } => write!(f, "mesh {mesh}, primitive {primitive}"),
        }
    }
}

/// Most face corners a scene may have; more would not fit the 32-bit ids of the scene.
pub(crate) const MOST_CORNERS: u64 = 1 << 30;

/// A running total of face corners that refuses scenes (or lies about sizes) beyond all reason.
#[derive(Default)]
pub(crate) struct CornerCount(u64);

impl CornerCount {
    pub(crate) fn add(&mut self, corners: usize) -> Result<(), Damage> {
        self.0 = self.0.saturating_add(corners as u64);
        if self.0 > MOST_CORNERS {
            return Err(Damage::new(
                Place::Whole,
                format!("more than {MOST_CORNERS} face corners"),
                "split the scene or simplify it",
            ));
        }
        Ok(())
    }
}

/// Refuses a position that is NaN or infinite; `vertex` counts from zero.
pub(crate) fn check_finite(
    point: [f64; 3],
    place: impl FnOnce() -> Place,
    vertex: u64,
) -> Result<(), Damage> {
    if point.iter().all(|c| c.is_finite()) {
        return Ok(());
    }
    let [x, y, z] = point;
    Err(Damage::new(
        place(),
        format!("vertex {vertex} is ({x}, {y}, {z}), which is not finite"),
        "repair the vertex in the modeling program and export again",
    ))
}
