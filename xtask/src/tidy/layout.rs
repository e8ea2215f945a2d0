//! Files: how long they are, what they are called, how they open.

use super::{File, Report};

/// Module names that say nothing about what is inside.
const EMPTY_NAMES: [&str; 8] = [
    "utils", "util", "helpers", "helper", "common", "misc", "shared", "stuff",
];
const THINK_AGAIN: usize = 600;
const TOO_LONG: usize = 1000;

pub(super) fn check(files: &[File], report: &mut Report) {
    for file in files.iter().filter(|f| f.is_rust()) {
        let path = &file.path;
        let lines = file.text.lines().count();
        if lines > TOO_LONG {
            report.errors.push(format!(
                "{path}: {lines} lines; {TOO_LONG} is the most: split it"
            ));
        } else if lines > THINK_AGAIN {
            report
                .warnings
                .push(format!("{path}: {lines} lines; aim at 250"));
        }
        if file.header().next().is_none() {
            report
                .errors
                .push(format!("{path}:1: open the file with a `//!` sentence"));
        }
        for part in path.split('/') {
            let name = part.trim_end_matches(".rs");
            if EMPTY_NAMES.contains(&name) {
                report.errors.push(format!(
                    "{path}: `{name}` says nothing: name what is inside"
                ));
            }
        }
        for (number, line) in file.text.lines().enumerate() {
            if let Some(name) = inline_module(line).filter(|n| EMPTY_NAMES.contains(n)) {
                let at = number + 1;
                report.errors.push(format!(
                    "{path}:{at}: the module name `{name}` says nothing"
                ));
            }
        }
    }
}

/// The name in `mod name {` or `pub(crate) mod name;`.
fn inline_module(line: &str) -> Option<&str> {
    let mut words = line
        .trim()
        .trim_end_matches([';', '{', ' '])
        .split(' ')
        .rev();
    let name = words.next()?;
    (words.next()? == "mod").then_some(name)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::{check, inline_module};

    #[test]
    fn names_headers_and_lengths_are_checked() {
        let good = file("crates/a/src/plane.rs", "//! Planes.\nmod cut;\n");
        assert!(errors(check, &[good]).is_empty());
        assert_eq!(
            errors(check, &[file("crates/a/src/utils.rs", "//! Things.\n")]).len(),
            1
        );
        assert_eq!(
            errors(check, &[file("crates/a/src/misc/mod.rs", "//! Things.\n")]).len(),
            1
        );
        assert_eq!(
            errors(check, &[file("a.rs", "//! A.\npub(crate) mod helpers;\n")]).len(),
            1
        );
        assert_eq!(errors(check, &[file("a.rs", "fn main() {}\n")]).len(), 1);
        let long = format!("//! Long.\n{}", "\n".repeat(1000));
        assert_eq!(errors(check, &[file("a.rs", &long)]).len(), 1);
    }

    #[test]
    fn module_lines_are_recognized() {
        assert_eq!(inline_module("    pub(crate) mod common {"), Some("common"));
        assert_eq!(inline_module("mod misc;"), Some("misc"));
        assert_eq!(inline_module("let modulus = misc;"), None);
    }
}
