//! *What is seen?* Where object space and line space meet: exact verdicts and their certificates.

mod blocker;
mod bundle;
mod caster;
mod check;
mod cover;
mod gates;
mod line;
pub mod occlusion;
mod pair;
pub mod plan;
mod point;
mod proof;
mod random;
mod range;
mod ray;
mod region;
mod sample;
mod search;
mod size;
mod verdict;

pub use caster::Caster;
pub use check::{CheckReport, PlanCheck, check_cell, check_plan};
pub use line::FineLine;
pub use pair::{PairResult, Surface, Verdict};
pub use point::PointVerdict;
pub use proof::{
    CellProof, Claim, GateProof, Node, PlanProof, PlanProofChild, PlanProofFragment, PlanProofNode,
    PlanProofTree, ProofError, Reason, RowName, Target, Tree,
};
pub use ray::{Hit, Trace};
pub use region::{BakeOptions, Baker};
pub use search::Work;
pub use verdict::{Accuracy, CellResult, FINE_BITS, FinePoint, VisibleEntry, Witness};
