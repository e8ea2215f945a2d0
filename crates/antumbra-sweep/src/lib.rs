//! *What is seen?* Where object space and line space meet: exact verdicts and their certificates.

mod blocker;
mod caster;
mod cover;
mod gates;
mod line;
mod proof;
mod random;
mod region;
mod sample;
mod search;
mod verdict;

pub use blocker::RowName;
pub use caster::Caster;
pub use line::{FINE_BITS, FinePoint};
pub use proof::{CellProof, Claim, GateProof, Node, ProofError, Reason, Target, Tree};
pub use region::{BakeOptions, Baker};
pub use search::Work;
pub use verdict::{Accuracy, CellResult, VisibleEntry, Witness};
