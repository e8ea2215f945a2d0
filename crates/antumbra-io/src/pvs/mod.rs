//! The `.pvs` container: which objects each view cell may see, for loading at run time.
//!
//! The bytes are described in `docs/formats/pvs.md`. [`PvsWriter`] writes a file cell by cell so
//! that an interrupted bake goes on where it stopped; [`PvsFile`] maps a file into memory and
//! answers which cell a point is in and what that cell may see, in microseconds.

mod cells;
mod encode;
mod error;
mod file;
mod journal;
mod layout;
mod lookup;
mod map;
mod model;
pub(crate) mod record;
mod writer;

pub use encode::encode_pvs;
pub use error::PvsError;
pub use file::{CellIndex, PvsFile};
pub use model::{
    Accuracy, CellRecord, PvsCell, PvsCellKind, PvsHeader, PvsProvenance, VisibleRecord,
    WitnessRecord,
};
pub use writer::{Finished, PvsWriter};

pub(crate) use encode::io_error;
pub(crate) use layout::checksum;
pub(crate) use map::Bytes;
