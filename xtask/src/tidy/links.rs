//! Relative links in Markdown lead to files that exist.

use std::collections::BTreeSet;

use super::{File, Report};

pub(super) fn check(files: &[File], report: &mut Report) {
    let known: BTreeSet<&str> = files.iter().map(|f| f.path.as_str()).collect();
    for file in files.iter().filter(|f| f.path.ends_with(".md")) {
        for (at, target) in links(&file.text) {
            let resolved = resolve(&file.path, target);
            // Pictures are not text files, so we do not know them; directories are prefixes.
            let binary = [".png", ".jpg", ".glb", ".pvs"]
                .iter()
                .any(|e| resolved.ends_with(e));
            let directory = format!("{}/", resolved.trim_end_matches('/'));
            let found = binary
                || known.contains(resolved.as_str())
                || known.iter().any(|p| p.starts_with(&directory));
            if !found {
                let path = &file.path;
                report
                    .errors
                    .push(format!("{path}:{at}: the link leads to no file: {target}"));
            }
        }
    }
}

/// The relative targets of `[text](target)`, with line numbers, outside of code blocks.
fn links(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut in_code = false;
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        for (at, _) in line.match_indices("](") {
            let rest = &line[at + 2..];
            let Some(target) = rest.split(')').next() else {
                continue;
            };
            let path = target.split('#').next().unwrap_or_default();
            if !path.is_empty() && !path.contains("://") && !path.starts_with("mailto:") {
                found.push((i + 1, path));
            }
        }
    }
    found
}

fn resolve(from: &str, target: &str) -> String {
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in target.split('/') {
        match part {
            "." | "" => {}
            ".." => {
                parts.pop();
            }
            name => parts.push(name),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::{check, resolve};

    #[test]
    fn dead_links_are_reported() {
        let text = "[a](b.md) [c](../docs/#x) [d](https://example.org) [e](#here) [f](gone.md)\n";
        let files = [file("docs/a.md", text), file("docs/b.md", "")];
        assert_eq!(
            errors(check, &files),
            ["docs/a.md:1: the link leads to no file: gone.md"]
        );
    }

    #[test]
    fn paths_are_resolved_from_the_file() {
        assert_eq!(
            resolve("docs/theory/a.md", "../references.md"),
            "docs/references.md"
        );
        assert_eq!(resolve("README.md", "./docs/"), "docs");
    }
}
