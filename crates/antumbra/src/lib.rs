//! Placeholder.
pub mod pair;
pub mod ray;
pub mod region;
