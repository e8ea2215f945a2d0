//! What each chore does, step by step.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::counts::Counts;
use crate::runner::{Failure, cargo, root, run, run_tests, title};

/// How much `cargo xtask test` runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// What every change must pass.
    Short,
    /// The slow tests too.
    Long,
}

/// Everything a change must pass; the last line printed is the sum of all tests.
pub(crate) fn test(depth: Depth) -> Result<(), Failure> {
    let mut total = Counts::default();
    let outcome = test_steps(depth, &mut total);
    match outcome {
        Ok(()) => {
            println!("\nall steps passed\n{total}");
            Ok(())
        }
        Err(failure) => Err(Failure {
            counts: Some(total),
            ..failure
        }),
    }
}

fn test_steps(depth: Depth, total: &mut Counts) -> Result<(), Failure> {
    // Cheap checks first; doctests last of the tests, since they link one binary each.
    format()?;
    tidy()?;
    clippy()?;
    run_tests("tests", &mut cargo(SHORT_TESTS), total)?;
    run_tests("doctests", &mut cargo(DOCTESTS), total)?;
    docs()?;
    fuzz_targets(depth)?;
    if depth == Depth::Long {
        run_tests(
            "long tests",
            cargo(LONG_TESTS).env("ANTUMBRA_LONG", "1"),
            total,
        )?;
    }
    Ok(())
}

/// `--show-output` lets us see which passing tests skipped themselves.
const SHORT_TESTS: &[&str] = &[
    "test",
    "--workspace",
    "--lib",
    "--bins",
    "--tests",
    "--examples",
    "--no-fail-fast",
    "--",
    "--show-output",
];
const DOCTESTS: &[&str] = &["test", "--workspace", "--doc", "--", "--show-output"];
const LONG_TESTS: &[&str] = &[
    "test",
    "--release",
    "--workspace",
    "--lib",
    "--bins",
    "--tests",
    "--no-fail-fast",
    "--",
    "--include-ignored",
    "--show-output",
];

/// Format, clippy and tidy.
pub(crate) fn lint() -> Result<(), Failure> {
    format()?;
    tidy()?;
    clippy()
}

fn format() -> Result<(), Failure> {
    run("format", &mut cargo(&["fmt", "--all", "--check"]))
}

fn clippy() -> Result<(), Failure> {
    let arguments = [
        "clippy",
        "--workspace",
        "--all-targets",
        "--",
        "-D",
        "warnings",
    ];
    run("clippy", &mut cargo(&arguments))
}

fn docs() -> Result<(), Failure> {
    let mut command = cargo(&["doc", "--workspace", "--no-deps"]);
    run("docs", command.env("RUSTDOCFLAGS", "-D warnings"))
}

/// The rules of the house.
pub(crate) fn tidy() -> Result<(), Failure> {
    title("tidy");
    let report = crate::tidy::check(&root());
    for warning in &report.warnings {
        println!("    warning: {warning}");
    }
    for error in &report.errors {
        println!("    {error}");
    }
    if report.errors.is_empty() {
        println!("    {} files looked at", report.files);
        return Ok(());
    }
    let why = format!("{} rules broken (see above)", report.errors.len());
    Err(Failure {
        step: "tidy".to_owned(),
        why,
        counts: None,
    })
}

/// All benchmarks.
pub(crate) fn bench(arguments: &[&str]) -> Result<(), Failure> {
    run(
        "benchmarks",
        cargo(&["bench", "--workspace"]).args(arguments),
    )
}

/// Runs every `figure_*` example of every crate, in release mode, from the root.
pub(crate) fn figures() -> Result<(), Failure> {
    for (package, example) in figure_examples(&root()) {
        let arguments = [
            "run",
            "--release",
            "--package",
            &package,
            "--example",
            &example,
        ];
        run(&format!("figure {example}"), &mut cargo(&arguments))?;
    }
    gallery(&root())
}

/// Runs the commands of `docs/gallery.md` in a folder below `target` and keeps the pictures.
fn gallery(root: &Path) -> Result<(), Failure> {
    let failed = |cause: std::io::Error| Failure {
        step: "gallery".to_owned(),
        why: cause.to_string(),
        counts: None,
    };
    let page = std::fs::read_to_string(root.join("docs/gallery.md")).map_err(failed)?;
    let build = ["build", "--release", "--package", "antumbra-cli"];
    run("the binary of the gallery", &mut cargo(&build))?;
    let binary = root.join("target/release/antumbra");
    let (work, kept) = (root.join("target/gallery"), root.join("docs/gallery"));
    std::fs::create_dir_all(&work).map_err(failed)?;
    std::fs::create_dir_all(&kept).map_err(failed)?;
    for line in page.lines().filter_map(|l| l.strip_prefix("antumbra ")) {
        let mut command = Command::new(&binary);
        command.args(words(line)).current_dir(&work);
        run(line, &mut command)?;
    }
    for name in names_in(&work) {
        if name.ends_with(".svg") || name.ends_with(".png") {
            std::fs::copy(work.join(&name), kept.join(&name)).map_err(failed)?;
        }
    }
    Ok(())
}

/// The words of a command line; what stands between double quotes is one word.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (i, part) in line.split('"').enumerate() {
        if i % 2 == 1 {
            words.push(part.to_owned());
        } else {
            words.extend(part.split_whitespace().map(str::to_owned));
        }
    }
    words
}

fn figure_examples(root: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for krate in names_in(&root.join("crates")) {
        for file in names_in(&root.join("crates").join(&krate).join("examples")) {
            let stem = file.trim_end_matches(".rs");
            if stem.starts_with("figure_") {
                found.push((krate.clone(), stem.to_owned()));
            }
        }
    }
    found
}

/// The sorted names in a directory; none if it cannot be read.
fn names_in(directory: &Path) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(directory) else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Instrumentation for libFuzzer with a stable compiler and no sanitizer.
const FUZZ_FLAGS: &str = "--cfg fuzzing -Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table";

/// Compiles the fuzz targets; runs each for a few seconds in a long run.
///
/// libFuzzer is C++, so a machine with nothing but Rust skips this step.
fn fuzz_targets(depth: Depth) -> Result<(), Failure> {
    let manifest = root().join("fuzz/Cargo.toml");
    if !manifest.exists() {
        return Ok(());
    }
    if !has_cpp_compiler() {
        title("fuzz targets");
        println!("    skipped: no C++ compiler (c++) on this machine, and libFuzzer needs one");
        return Ok(());
    }
    let manifest = manifest.to_string_lossy().into_owned();
    if depth == Depth::Short {
        let arguments = ["check", "--bins", "--manifest-path", &manifest];
        return run(
            "fuzz targets compile",
            cargo(&arguments).env("RUSTFLAGS", "--cfg fuzzing"),
        );
    }
    let host = host_triple();
    let build = [
        "build",
        "--release",
        "--bins",
        "--manifest-path",
        &manifest,
        "--target",
        &host,
    ];
    run(
        "fuzz targets compile",
        cargo(&build).env("RUSTFLAGS", FUZZ_FLAGS),
    )?;
    for target in fuzz_target_names(&root()) {
        let arguments = [
            "run",
            "--release",
            "--manifest-path",
            &manifest,
            "--target",
            &host,
            "--bin",
            &target,
            "--",
            "-max_total_time=20",
        ];
        run(
            &format!("fuzz {target}"),
            cargo(&arguments).env("RUSTFLAGS", FUZZ_FLAGS),
        )?;
    }
    Ok(())
}

/// The files that hold a target; what targets have in common is a file beside them.
fn fuzz_target_names(root: &Path) -> Vec<String> {
    let folder = root.join("fuzz/fuzz_targets");
    let is_target = |file: &String| {
        let text = std::fs::read_to_string(folder.join(file)).unwrap_or_default();
        text.contains("fuzz_target!(")
    };
    let files = names_in(&folder).into_iter().filter(is_target);
    files
        .map(|file| file.trim_end_matches(".rs").to_owned())
        .collect()
}

fn has_cpp_compiler() -> bool {
    let compiler = std::env::var_os("CXX").unwrap_or_else(|| "c++".into());
    let mut command = Command::new(compiler);
    command
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.status().is_ok_and(|s| s.success())
}

/// Given explicitly, so that the instrumentation flags do not reach build scripts.
fn host_triple() -> String {
    let output = Command::new("rustc")
        .args(["--version", "--verbose"])
        .output();
    let text = output
        .map(|o| String::from_utf8_lossy(&o.stdout).into_owned())
        .unwrap_or_default();
    let host = text.lines().find_map(|l| l.strip_prefix("host: "));
    host.unwrap_or("x86_64-unknown-linux-gnu").to_owned()
}

#[cfg(test)]
mod tests {
    use super::fuzz_target_names;
    use crate::runner::root;

    #[test]
    fn every_fuzz_target_is_a_binary_of_its_manifest() {
        let manifest = std::fs::read_to_string(root().join("fuzz/Cargo.toml")).expect("a manifest");
        let targets = fuzz_target_names(&root());
        let binaries = manifest.lines().filter(|line| *line == "[[bin]]").count();
        assert_eq!(targets.len(), binaries);
        for target in targets {
            assert!(
                manifest.contains(&format!("name = \"{target}\"")),
                "{target}"
            );
        }
    }
}
