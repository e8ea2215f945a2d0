//! The command line of Antumbra: `antumbra COMMAND INPUT [options]`.
#![allow(dead_code, unused_imports)]

mod failure;
mod output;
mod picture;
mod values;

fn main() {}
