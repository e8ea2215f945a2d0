//! The chores of this repository: `cargo xtask test`, `lint`, `tidy`, `bench`, `figures`.
//!
//! Needs nothing but a Rust toolchain; what cannot run for lack of another tool is listed as skipped.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line tool"
)]

mod chores;
mod counts;
mod runner;
mod tidy;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask CHORE

  test [--long]   everything a change must pass: format, clippy, tests, doctests, docs, tidy;
                  --long adds the slow tests in release mode and a short run of the fuzz targets
  lint            format, clippy and tidy only
  tidy            the rules of the house only (see ARCHITECTURE.md)
  bench [ARGS]    all benchmarks; ARGS go to `cargo bench`
  figures         run every example whose name starts with `figure_`, which rewrites docs/figures,
                  and the commands of docs/gallery.md, which rewrites docs/gallery";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words.as_slice() {
        ["test"] => chores::test(chores::Depth::Short),
        ["test", "--long"] => chores::test(chores::Depth::Long),
        ["lint"] => chores::lint(),
        ["tidy"] => chores::tidy(),
        ["bench", rest @ ..] => chores::bench(rest),
        ["figures"] => chores::figures(),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("\nfailed: {failure}");
            if let Some(counts) = failure.counts {
                println!("{counts}");
            }
            ExitCode::FAILURE
        }
    }
}
