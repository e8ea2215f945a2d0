//! Tests that try to prove a verdict wrong, by oracles that share no code with the engine.
//!
//! | module | attack |
//! |---|---|
//! | [`rays`] | random and border rays into what is called hidden, on whole buildings; every witness followed by exact rationals, every *touching* recomputed |
//! | [`pairs`], [`cells`] | thousands of small degenerate scenes: laws, oracles, certificates |
//! | [`repeat`] | the same bytes again, on one thread and on two |
//! | [`snapping`] | rooms and buildings off the grid: no cracks |
//! | [`walls`] | layers of which exactly the first is seen |
//!
//! A failing small scene prints itself as a corpus case.

mod cells;
mod judge;
mod pairs;
mod rays;
mod repeat;
mod scenes;
mod small;
mod snapping;
mod walls;
