//! Where results, notes and progress go: results to stdout, everything else to stderr.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::Value;

use crate::failure::Failure;

/// How a command talks: set by the global options.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    /// Print exactly one JSON object.
    pub json: bool,
    /// Print no notes and no progress.
    pub quiet: bool,
}

impl Output {
    /// Prints the result of a command: an object for scripts or lines for people.
    pub(crate) fn result(self, json: &Value, text: &str) -> Result<(), Failure> {
        if self.json {
            line(&json.to_string())
        } else {
            line(text)
        }
    }

    /// Prints a note to stderr.
    pub(crate) fn note(self, text: &str) {
        if !self.quiet {
            // Nothing can be done if stderr is gone.
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    }

    /// A progress bar with an estimate, on a terminal only.
    pub(crate) fn progress(self, total: u64, what: &str) -> ProgressBar {
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
        }
        let template = "{msg} [{bar:32}] {pos}/{len}, {elapsed} so far, {eta} to go";
        let style = ProgressStyle::with_template(template)
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .progress_chars("=> ");
        ProgressBar::new(total)
            .with_style(style)
            .with_message(what.to_owned())
    }
}

/// A number of things in words.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// Prints a line to stdout. A reader that went away early is no failure.
pub(crate) fn line(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out
        .write_all(text.as_bytes())
        .and_then(|()| out.write_all(b"\n"))
    {
        Err(cause) if cause.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::Path(
            format!("the result cannot be written to stdout ({cause})"),
        )),
        _ => Ok(()),
    }
}

/// Writes a file as a whole: first beside it, then moved to its name, so that no half-written
/// file is left under the final name.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    written.map_err(|cause| {
        // The part file is of no use to anyone; that it cannot be removed changes nothing.
        let _ = std::fs::remove_file(&part);
        Failure::unwritable(path, &cause)
    })
}

/// Refuses results that cannot be written as asked, before any work is done: each has a path, if it
/// is wanted, and the extensions of its format.
pub(crate) fn check_outputs(
    outputs: &[(Option<&PathBuf>, &[&str])],
    inputs: &[&Path],
) -> Result<(), Failure> {
    let mut known: Vec<&PathBuf> = Vec::new();
    for (path, extensions) in outputs {
        let Some(path) = *path else { continue };
        check_writable(path, inputs)?;
        if known.contains(&path) {
            return Err(Failure::Usage(format!(
                "{}: two results would be written to this file; give each its own name",
                path.display()
            )));
        }
        known.push(path);
        let given = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if given.is_some_and(|given| !extensions.contains(&given.as_str())) {
            return Err(Failure::Usage(format!(
                "{}: what is written there is .{}; change the file's extension",
                path.display(),
                extensions.join(" or .")
            )));
        }
    }
    Ok(())
}

/// Refuses a path that will not be writable or is one of the inputs, before any work is done.
pub(crate) fn check_writable(path: &Path, inputs: &[&Path]) -> Result<(), Failure> {
    if path.is_dir() {
        let cause = std::io::Error::from(std::io::ErrorKind::IsADirectory);
        return Err(Failure::unwritable(path, &cause));
    }
    // Results are moved to their name, which would replace a device or a pipe.
    if path.exists() && !path.is_file() {
        let cause = std::io::Error::other("not a regular file");
        return Err(Failure::unwritable(path, &cause));
    }
    let place = |path: &Path| path.canonicalize().ok();
    if inputs
        .iter()
        .any(|input| place(path).is_some() && place(input) == place(path))
    {
        return Err(Failure::Usage(format!(
            "{}: the result would replace its own input; give it another name",
            path.display()
        )));
    }
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    match std::fs::metadata(folder) {
        Ok(data) if data.is_dir() => Ok(()),
        Ok(_) => Err(Failure::unwritable(
            path,
            &std::io::ErrorKind::NotADirectory.into(),
        )),
        Err(cause) => Err(Failure::unwritable(path, &cause)),
    }
}

/// Seconds with microsecond resolution, for JSON.
pub(crate) fn seconds(duration: std::time::Duration) -> f64 {
    (duration.as_secs_f64() * 1e6).round() / 1e6
}
