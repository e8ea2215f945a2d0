//! Plans against an oracle that shares no code with the engine, on tiny lattices and on measured plans.

mod cases;
mod glass;
mod isovist;
mod ladder;
mod mutual;
mod rays;
mod reach;
mod real;
mod small;
