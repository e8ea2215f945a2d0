//! The rules of the house, as code: `cargo xtask tidy`, and a test.
//!
//! Each rule is a function from the repository's files to broken rules; ARCHITECTURE.md says which
//! invariant it guards.

mod corpus;
mod graph;
mod layout;
mod links;
mod purity;
mod references;
mod words;

use std::path::Path;
use std::process::Command;

/// A text file of the repository.
#[derive(Clone, Debug)]
pub(crate) struct File {
    /// Relative to the root, with `/`.
    pub(crate) path: String,
    pub(crate) text: String,
}

impl File {
    fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// The code before the first `#[cfg(test)]`, with its line numbers from one.
    fn shipped_lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text
            .lines()
            .enumerate()
            .map(|(i, line)| (i + 1, line))
            .take_while(|(_, line)| line.trim() != "#[cfg(test)]")
    }

    /// The `//!` lines the file opens with.
    fn header(&self) -> impl Iterator<Item = &str> {
        self.text.lines().take_while(|line| line.starts_with("//!"))
    }
}

/// What a tidy run found.
#[derive(Debug, Default)]
pub(crate) struct Report {
    /// Broken rules, each a sentence that begins with `path:line`.
    pub(crate) errors: Vec<String>,
    /// Things to think about.
    pub(crate) warnings: Vec<String>,
    /// How many files were looked at.
    pub(crate) files: usize,
}

/// Checks every rule on the repository at `root`.
pub(crate) fn check(root: &Path) -> Report {
    check_files(&read_files(root))
}

fn check_files(files: &[File]) -> Report {
    let mut report = Report {
        files: files.len(),
        ..Report::default()
    };
    layout::check(files, &mut report);
    graph::check(files, &mut report);
    purity::check(files, &mut report);
    words::check(files, &mut report);
    references::check(files, &mut report);
    links::check(files, &mut report);
    corpus::check(files, &mut report);
    report
}

/// All text files that belong to the repository: what git knows or would add, else all but `target`.
fn read_files(root: &Path) -> Vec<File> {
    let mut paths = git_files(root).unwrap_or_else(|| {
        let mut found = Vec::new();
        walk(root, "", &mut found);
        found
    });
    paths.sort();
    paths.dedup();
    let read = |path: String| {
        let bytes = std::fs::read(root.join(&path)).ok()?;
        Some(File {
            path,
            text: String::from_utf8(bytes).ok()?,
        })
    };
    paths.into_iter().filter_map(read).collect()
}

fn git_files(root: &Path) -> Option<Vec<String>> {
    let arguments = [
        "ls-files",
        "-z",
        "--cached",
        "--others",
        "--exclude-standard",
    ];
    let output = Command::new("git")
        .args(arguments)
        .current_dir(root)
        .output()
        .ok()?;
    if !output.status.success() || output.stdout.is_empty() {
        return None;
    }
    let text = String::from_utf8(output.stdout).ok()?;
    Some(
        text.split('\0')
            .filter(|p| !p.is_empty())
            .map(str::to_owned)
            .collect(),
    )
}

fn walk(root: &Path, below: &str, found: &mut Vec<String>) {
    let Ok(entries) = std::fs::read_dir(root.join(below)) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = if below.is_empty() {
            name.clone()
        } else {
            format!("{below}/{name}")
        };
        if name == "target" || name == ".git" {
            continue;
        }
        if entry.path().is_dir() {
            walk(root, &path, found);
        } else {
            found.push(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{File, Report, check};

    /// A file made up for a test.
    pub(super) fn file(path: &str, text: &str) -> File {
        File {
            path: path.to_owned(),
            text: text.to_owned(),
        }
    }

    /// The errors of one rule on made-up files.
    pub(super) fn errors(rule: fn(&[File], &mut Report), files: &[File]) -> Vec<String> {
        let mut report = Report::default();
        rule(files, &mut report);
        report.errors
    }

    #[test]
    fn the_repository_is_tidy() {
        let report = check(&crate::runner::root());
        assert!(report.files > 10, "only {} files found", report.files);
        assert!(report.errors.is_empty(), "{}", report.errors.join("\n"));
    }
}
