//! Every scene of the corpus is there for a rule: the table of degenerate cases links to it.

use super::{File, Report};

const TABLE: &str = "docs/theory/degeneracy.md";

pub(super) fn check(files: &[File], report: &mut Report) {
    let table = files
        .iter()
        .find(|f| f.path == TABLE)
        .map_or("", |f| f.text.as_str());
    for file in files {
        let scene = file
            .path
            .strip_prefix("corpus/")
            .filter(|p| p.ends_with(".toml"));
        if scene.is_some_and(|s| !table.contains(&format!("](../../corpus/{s})"))) {
            report
                .errors
                .push(format!("{}: {TABLE} does not link to it", file.path));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::check;

    #[test]
    fn a_scene_without_a_rule_is_reported() {
        let table = file("docs/theory/degeneracy.md", "[a](../../corpus/a.toml)");
        let files = [table, file("corpus/a.toml", ""), file("corpus/b.toml", "")];
        let found = errors(check, &files);
        assert_eq!(
            found,
            ["corpus/b.toml: docs/theory/degeneracy.md does not link to it"]
        );
    }
}
