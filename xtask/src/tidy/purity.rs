//! What code may do where: no `unsafe`, no I/O in libraries, no stray floats, a checker on its own.

use super::{File, Report};

/// Published libraries that read and write nothing: readers take bytes.
const PURE: [&str; 5] = [
    "crates/antumbra-kernel/src/",
    "crates/antumbra-scene/src/",
    "crates/antumbra-lines/src/",
    "crates/antumbra-sweep/src/",
    "crates/antumbra/src/",
];
/// The border itself: snapping, and the exact conversion of grid points for output.
const BORDER: [&str; 2] = [
    "crates/antumbra-kernel/src/grid.rs",
    "crates/antumbra-kernel/src/point.rs",
];
/// Where a float may decide nothing, so that each file that has one says what for.
const EXACT: [&str; 2] = ["crates/antumbra-kernel/src/", "crates/antumbra-lines/src/"];
/// What the checker may use of its own crate.
const CERTIFICATE: [&str; 3] = ["check", "proof", "verdict"];
const OUTSIDE_WORLD: [&str; 6] = [
    "std::fs",
    "std::net",
    "std::process",
    "std::env",
    "std::io::stdin",
    "std::time::SystemTime",
];

pub(super) fn check(files: &[File], report: &mut Report) {
    let rust: Vec<&File> = files.iter().filter(|f| f.is_rust()).collect();
    check_unsafe(&rust, report);
    for file in &rust {
        let path = &file.path;
        if PURE.iter().any(|p| path.starts_with(p)) {
            check_io(file, report);
        }
        if EXACT.iter().any(|p| path.starts_with(p)) && !BORDER.contains(&path.as_str()) {
            check_floats(file, report);
        }
        if path.starts_with("crates/antumbra-sweep/src/check") {
            check_independence(file, report);
        }
    }
}

/// `unsafe` is for one file: the memory mapping of antumbra-io.
fn check_unsafe(files: &[&File], report: &mut Report) {
    let mut mapping: Option<&str> = None;
    for file in files {
        let Some(line) = code_lines(&file.text).find(|(_, l)| has_word(l, "unsafe")) else {
            continue;
        };
        let (path, at) = (file.path.as_str(), line.0);
        let is_mapping = path.starts_with("crates/antumbra-io/src/") && path.contains("map");
        if !is_mapping || mapping.replace(path).is_some() {
            report.errors.push(format!(
                "{path}:{at}: `unsafe` is allowed in the one mapping file of antumbra-io only"
            ));
        }
    }
}

fn check_io(file: &File, report: &mut Report) {
    for (at, line) in file.shipped_lines().filter(|(_, l)| !is_comment(l)) {
        for world in OUTSIDE_WORLD.iter().filter(|w| line.contains(*w)) {
            let path = &file.path;
            report.errors.push(format!(
                "{path}:{at}: `{world}` in a library that does no I/O"
            ));
        }
    }
}

/// A file of exact arithmetic that mentions a float must say in its header what the float is for.
fn check_floats(file: &File, report: &mut Report) {
    let explained = file.header().any(|l| {
        ["float", "double", "filter"]
            .iter()
            .any(|word| l.contains(word))
    });
    let first = file
        .shipped_lines()
        .find(|(_, l)| !is_comment(l) && (has_word(l, "f64") || has_word(l, "f32")));
    if let (false, Some((at, _))) = (explained, first) {
        let path = &file.path;
        report.errors.push(format!(
            "{path}:{at}: a float in exact code: say in the `//!` header what floats do here \
             (they may filter, snap, sample or print, never decide)"
        ));
    }
}

/// Certificates are checked by code that knows nothing of trees, polytopes or the engine: of its own
/// crate it may use what a certificate is made of, and nothing that makes one.
fn check_independence(file: &File, report: &mut Report) {
    for (at, line) in file.shipped_lines().filter(|(_, l)| !is_comment(l)) {
        let path = &file.path;
        if line.contains("antumbra_lines") {
            let why = "the checker must not use line space";
            report.errors.push(format!("{path}:{at}: {why}"));
        }
        for (start, _) in line.match_indices("crate::") {
            let rest = &line[start + "crate::".len()..];
            let module = rest
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .next();
            if module.is_none_or(|m| !CERTIFICATE.contains(&m)) {
                let why = format!("the checker may use only {CERTIFICATE:?} of its crate");
                report.errors.push(format!("{path}:{at}: {why}"));
            }
        }
    }
}

fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .enumerate()
        .map(|(i, l)| (i + 1, l))
        .filter(|(_, l)| !is_comment(l))
}

fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with("//")
}

/// Whether `word` stands alone in the line, outside of string literals.
fn has_word(line: &str, word: &str) -> bool {
    let outside: String = line.split('"').step_by(2).collect::<Vec<_>>().join(" ");
    outside
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .any(|w| w == word)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::check;

    #[test]
    fn unsafe_has_one_home() {
        let text = "//! M.\nfn f() { unsafe { g() } }\n";
        let (first, second) = (
            "crates/antumbra-io/src/mapping.rs",
            "crates/antumbra-io/src/map.rs",
        );
        assert!(errors(check, &[file(first, text)]).is_empty());
        assert_eq!(
            errors(check, &[file(first, text), file(second, text)]).len(),
            1
        );
        assert_eq!(
            errors(check, &[file("crates/antumbra-kernel/src/a.rs", text)]).len(),
            1
        );
        let words = "//! A.\n// unsafe in a comment\nfn f() { g(QUOTEunsafeQUOTE) }\n";
        let words = words.replace("QUOTE", "\"");
        assert!(errors(check, &[file("crates/antumbra-kernel/src/a.rs", &words)]).is_empty());
    }

    #[test]
    fn libraries_do_no_io_outside_their_tests() {
        let text = "//! A.\nfn f() { std::fs::read(\"x\") }\n";
        assert_eq!(
            errors(check, &[file("crates/antumbra-scene/src/a.rs", text)]).len(),
            1
        );
        assert!(errors(check, &[file("crates/antumbra-io/src/a.rs", text)]).is_empty());
        let tests = "//! A.\n#[cfg(test)]\nmod tests { fn f() { std::fs::read(\"x\") } }\n";
        assert!(errors(check, &[file("crates/antumbra-scene/src/a.rs", tests)]).is_empty());
    }

    #[test]
    fn floats_in_exact_code_are_explained() {
        let bare = "//! Signs.\nfn f(x: f64) {}\n";
        assert_eq!(
            errors(check, &[file("crates/antumbra-kernel/src/a.rs", bare)]).len(),
            1
        );
        let said = "//! Signs, by a float filter first.\nfn f(x: f64) {}\n";
        assert!(errors(check, &[file("crates/antumbra-kernel/src/a.rs", said)]).is_empty());
        assert!(errors(check, &[file("crates/antumbra-scene/src/a.rs", bare)]).is_empty());
    }

    #[test]
    fn the_checker_stands_alone() {
        let text = "//! C.\nuse antumbra_lines::OcclusionTree;\n";
        assert_eq!(
            errors(check, &[file("crates/antumbra-sweep/src/check.rs", text)]).len(),
            1
        );
        assert!(errors(check, &[file("crates/antumbra-sweep/src/engine.rs", text)]).is_empty());
        let text = "//! C.\nuse crate::proof::Target;\nuse crate::search::Piece;\n";
        let path = "crates/antumbra-sweep/src/check/ends.rs";
        assert_eq!(errors(check, &[file(path, text)]).len(), 1);
    }
}
