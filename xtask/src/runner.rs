//! Runs one step of a chore: prints its title, streams its output, says clearly why it failed.

use std::fmt;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::counts::{Counts, Reader};

/// Why a chore stopped.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) step: String,
    pub(crate) why: String,
    /// The test counts so far, if any test ran.
    pub(crate) counts: Option<Counts>,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step `{}`: {}", self.step, self.why)
    }
}

/// The root of the workspace: what `cargo run` says, since the checkout may have moved after this
/// crate was compiled; else where it was compiled.
pub(crate) fn root() -> PathBuf {
    let here = std::env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    here.parent().map(PathBuf::from).unwrap_or(here)
}

/// A `cargo` command in the root, with the toolchain that runs us.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(arguments).current_dir(root());
    command
}

/// Prints the title of a step.
pub(crate) fn title(step: &str) {
    println!("\n=== {step}");
}

/// Runs a command whose exit code is all that matters.
pub(crate) fn run(step: &str, command: &mut Command) -> Result<(), Failure> {
    title(step);
    let start = Instant::now();
    let status = command
        .status()
        .map_err(|e| cannot_start(step, command, &e))?;
    if !status.success() {
        return Err(failed(step, command));
    }
    println!("    done in {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Runs a command that prints test results, and adds them to `total`.
pub(crate) fn run_tests(
    step: &str,
    command: &mut Command,
    total: &mut Counts,
) -> Result<(), Failure> {
    title(step);
    let start = Instant::now();
    command.stdout(Stdio::piped());
    let mut child = command
        .spawn()
        .map_err(|e| cannot_start(step, command, &e))?;
    let mut reader = Reader::default();
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            if reader.line(&line) && !line.trim().is_empty() {
                println!("{line}");
            }
        }
    }
    let status = child.wait().map_err(|e| cannot_start(step, command, &e))?;
    for (test, why) in reader.skips() {
        println!("    skipped {test}: {why}");
    }
    *total += reader.counts();
    if !status.success() {
        return Err(failed(step, command));
    }
    println!(
        "    {} in {:.1} s",
        reader.counts(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

fn failed(step: &str, command: &Command) -> Failure {
    let why = format!("`{}` reported errors (see above)", shown(command));
    Failure {
        step: step.to_owned(),
        why,
        counts: None,
    }
}

fn cannot_start(step: &str, command: &Command, error: &std::io::Error) -> Failure {
    let why = format!("`{}` could not be run: {error}", shown(command));
    Failure {
        step: step.to_owned(),
        why,
        counts: None,
    }
}

fn shown(command: &Command) -> String {
    let words = command.get_args().map(|a| a.to_string_lossy().into_owned());
    std::iter::once("cargo".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}
