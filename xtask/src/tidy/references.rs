//! Papers are cited by keys such as `[Bittner02, 6.5.1]`, and every key is in docs/references.md.

use std::collections::BTreeSet;

use super::{File, Report};

const LIST: &str = "docs/references.md";

pub(super) fn check(files: &[File], report: &mut Report) {
    let known: BTreeSet<&str> = files
        .iter()
        .filter(|f| f.path == LIST)
        .flat_map(|f| f.text.lines())
        .filter_map(|line| line.strip_prefix("- **[")?.split(']').next())
        .collect();
    for file in files
        .iter()
        .filter(|f| f.is_rust() || f.path.ends_with(".md"))
    {
        for (i, line) in file.text.lines().enumerate() {
            if file.is_rust() && !line.trim_start().starts_with("//") {
                continue;
            }
            for key in keys(line).filter(|key| !known.contains(key)) {
                let (path, at) = (&file.path, i + 1);
                report
                    .errors
                    .push(format!("{path}:{at}: [{key}] is not in {LIST}"));
            }
        }
    }
}

/// What looks like a citation: after `[`, two or more letters, the first a capital, then two digits,
/// then `]`, a comma or a space.
fn keys(line: &str) -> impl Iterator<Item = &str> {
    line.match_indices('[').filter_map(|(at, _)| {
        let rest = &line[at + 1..];
        let key = &rest[..rest.find([']', ',', ' '])?];
        let letters = key.trim_end_matches(|c: char| c.is_ascii_digit());
        let looks = key.len() - letters.len() == 2
            && letters.len() >= 2
            && letters.starts_with(|c: char| c.is_ascii_uppercase())
            && letters.bytes().all(|b| b.is_ascii_alphabetic());
        looks.then_some(key)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::{check, keys};

    #[test]
    fn citations_are_told_from_code() {
        let line =
            "//! After [Bittner02, 6.5.1] and [TS92]; takes [I256; 6], [Vec3], [`Grid`], [a12].";
        assert_eq!(keys(line).collect::<Vec<_>>(), ["Bittner02", "TS92"]);
    }

    #[test]
    fn unknown_keys_are_reported() {
        let list = file("docs/references.md", "- **[TS92]** S. Teller ...\n");
        let code = file(
            "a.rs",
            "//! See [TS92, 3] and [Nobody99].\nlet x = [Foo12, 3];\n",
        );
        let found = errors(check, &[list, code]);
        assert_eq!(found, ["a.rs:1: [Nobody99] is not in docs/references.md"]);
    }
}
