//! The crate graph is a diamond: object space and line space meet only in the sweep.

use super::{File, Report};

/// What a crate may depend on.
struct Node {
    name: &'static str,
    may_use: &'static [&'static str],
    /// In addition, for its tests, benches and examples only.
    tests_may_use: &'static [&'static str],
}

const TESTKIT: &str = "antumbra-testkit";

/// The whole graph. A new crate gets its line here and in ARCHITECTURE.md.
const GRAPH: [Node; 9] = [
    Node {
        name: "antumbra-kernel",
        may_use: &[],
        tests_may_use: &[],
    },
    Node {
        name: "antumbra-scene",
        may_use: &["antumbra-kernel"],
        tests_may_use: &[],
    },
    Node {
        name: "antumbra-lines",
        may_use: &["antumbra-kernel"],
        tests_may_use: &[],
    },
    Node {
        name: "antumbra-sweep",
        may_use: &["antumbra-kernel", "antumbra-scene", "antumbra-lines"],
        tests_may_use: &[],
    },
    Node {
        name: "antumbra",
        may_use: &[
            "antumbra-kernel",
            "antumbra-scene",
            "antumbra-lines",
            "antumbra-sweep",
        ],
        tests_may_use: &["antumbra-io"],
    },
    Node {
        name: "antumbra-io",
        may_use: &["antumbra-kernel", "antumbra-scene", "antumbra"],
        tests_may_use: &[],
    },
    Node {
        name: "antumbra-cli",
        // The facade re-exports what the binary needs; the scene is named for its generators.
        may_use: &["antumbra", "antumbra-io", "antumbra-scene"],
        tests_may_use: &[],
    },
    // The oracles share no code with what they judge.
    Node {
        name: TESTKIT,
        may_use: &[],
        tests_may_use: &[],
    },
    Node {
        name: "xtask",
        may_use: &[],
        tests_may_use: &[],
    },
];

pub(super) fn check(files: &[File], report: &mut Report) {
    for file in files.iter().filter(|f| is_member(&f.path)) {
        match file.text.parse::<toml::Table>() {
            Ok(manifest) => check_manifest(&file.path, &manifest, report),
            Err(e) => report
                .errors
                .push(format!("{}: not valid TOML: {e}", file.path)),
        }
    }
}

fn is_member(path: &str) -> bool {
    let parts: Vec<&str> = path.split('/').collect();
    matches!(
        parts.as_slice(),
        ["crates", _, "Cargo.toml"] | ["xtask", "Cargo.toml"]
    )
}

fn check_manifest(path: &str, manifest: &toml::Table, report: &mut Report) {
    let name = manifest
        .get("package")
        .and_then(|p| p.get("name"))
        .and_then(toml::Value::as_str);
    let Some(node) = GRAPH.iter().find(|n| Some(n.name) == name) else {
        let name = name.unwrap_or("?");
        report.errors.push(format!(
            "{path}: the crate `{name}` has no place in the crate graph"
        ));
        return;
    };
    for (kind, used) in dependencies(manifest) {
        if !used.starts_with("antumbra") {
            continue;
        }
        let used = used.as_str();
        let for_tests = kind == "dev-dependencies";
        let allowed = node.may_use.contains(&used)
            || for_tests && (used == TESTKIT || node.tests_may_use.contains(&used));
        if !allowed {
            let name = node.name;
            report.errors.push(format!(
                "{path}: `{name}` must not depend on `{used}` ({kind})"
            ));
        }
    }
}

/// All (table, package) pairs, of every target; renamed packages under their own name.
fn dependencies(manifest: &toml::Table) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let tables = targets
        .into_iter()
        .flat_map(|t| t.values())
        .filter_map(toml::Value::as_table);
    for table in std::iter::once(manifest).chain(tables) {
        for kind in ["dependencies", "dev-dependencies", "build-dependencies"] {
            let list = table.get(kind).and_then(toml::Value::as_table);
            for (key, value) in list.into_iter().flatten() {
                let renamed = value.get("package").and_then(toml::Value::as_str);
                found.push((kind.to_owned(), renamed.unwrap_or(key).to_owned()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::check;

    fn manifest(name: &str, rest: &str) -> Vec<String> {
        let path = format!("crates/{name}/Cargo.toml");
        errors(
            check,
            &[file(
                &path,
                &format!("[package]\nname = \"{name}\"\n{rest}"),
            )],
        )
    }

    #[test]
    fn lines_never_see_a_scene_and_scenes_never_a_line() {
        for (name, other) in [
            ("antumbra-lines", "antumbra-scene"),
            ("antumbra-scene", "antumbra-lines"),
            ("antumbra-testkit", "antumbra-kernel"),
            ("antumbra-sweep", "antumbra"),
        ] {
            let forms = [
                format!("[dependencies]\n{other}.workspace = true"),
                format!("[dependencies.{other}]\nversion = \"1\""),
                format!("[dev-dependencies]\n{other}.workspace = true"),
                format!("[target.'cfg(unix)'.dependencies]\nx = {{ package = \"{other}\" }}"),
            ];
            for form in forms {
                assert_eq!(manifest(name, &form).len(), 1, "{name} with {form}");
            }
        }
    }

    #[test]
    fn the_diamond_itself_is_allowed() {
        let good = "[dependencies]\nantumbra-scene.workspace = true\nthiserror = \"2\"";
        assert!(manifest("antumbra-sweep", good).is_empty());
        let tests = "[dev-dependencies]\nantumbra-testkit.workspace = true";
        assert!(manifest("antumbra-kernel", tests).is_empty());
        let shipped = "[dependencies]\nantumbra-testkit.workspace = true";
        assert_eq!(manifest("antumbra-kernel", shipped).len(), 1);
        assert_eq!(manifest("antumbra-new", "").len(), 1);
    }
}
