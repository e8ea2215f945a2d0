//! What a test may find around it: the corpus, measured data, and whether slow tests are wanted.

use std::path::PathBuf;

/// The root of the workspace: two folders above the crate whose test runs, by what cargo says, since
/// the checkout may have moved after this crate was compiled; else above this crate.
#[must_use]
pub fn workspace_root() -> PathBuf {
    let running = std::env::var_os("CARGO_MANIFEST_DIR").map(|d| PathBuf::from(d).join("../.."));
    let compiled = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    running
        .filter(|root| root.join("corpus").is_dir())
        .unwrap_or(compiled)
}

/// The folder with measured data that is not part of the repository: `ANTUMBRA_DATA`, or
/// `../shared/data` beside the workspace. `None` if there is none; then [`skip`] the test.
#[must_use]
pub fn data() -> Option<PathBuf> {
    let given = std::env::var_os("ANTUMBRA_DATA").map(PathBuf::from);
    let path = given.unwrap_or_else(|| workspace_root().join("../shared/data"));
    path.is_dir().then_some(path)
}

/// Whether slow tests are wanted: `cargo xtask test --long` sets `ANTUMBRA_LONG`.
#[must_use]
pub fn long() -> bool {
    std::env::var_os("ANTUMBRA_LONG").is_some_and(|v| !v.is_empty() && v != "0")
}

/// Says that a test skips itself, so that `cargo xtask test` counts it as skipped; then return.
#[allow(clippy::print_stdout, reason = "the test harness captures it")]
pub fn skip(reason: &str) {
    println!("skipped: {reason}");
}
