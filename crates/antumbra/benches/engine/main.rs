//! How long answers take. Each benchmark confirms its answer before it is timed; scenes and
//! kD-trees are built beforehand (and timed on their own), one thread works unless two are named.
//!
//! Data that is not part of the project is looked for as the tests do, and skipped if absent.

#![allow(missing_docs, reason = "the macro makes a public function")]

mod buildings;
mod culling;
mod maps;
mod pairs;
mod plans;
mod synthetic;

use criterion::{criterion_group, criterion_main};

criterion_group! {
    name = engine;
    config = criterion::Criterion::default()
        .sample_size(10)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(3));
    targets = synthetic::build, synthetic::layered, synthetic::triangles, pairs::all, buildings::cells,
        maps::views, culling::walks, plans::cells
}
criterion_main!(engine);
