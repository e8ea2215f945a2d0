//! Reads what the test harness prints: sums its counts and finds the tests that skipped themselves.

use std::collections::BTreeSet;
use std::fmt;

/// How many tests passed, failed and were skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) passed: usize,
    pub(crate) failed: usize,
    pub(crate) skipped: usize,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} passed, {} failed, {} skipped",
            self.passed, self.failed, self.skipped
        )
    }
}

/// Follows the output of `cargo test -- --show-output` line by line.
///
/// A test that finds its data absent prints a line `skipped: reason` and returns; the harness calls
/// that passed, we do not. What passing tests print is otherwise swallowed.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    counts: Counts,
    /// Inside the harness's list of what passing tests printed.
    in_successes: bool,
    current: String,
    skips: BTreeSet<(String, String)>,
    skipping_tests: BTreeSet<String>,
}

impl Reader {
    /// Takes one line and says whether it is worth showing.
    pub(crate) fn line(&mut self, line: &str) -> bool {
        if let Some(counts) = parse_result(line) {
            let own = self.skipping_tests.len().min(counts.passed);
            self.counts += Counts {
                passed: counts.passed - own,
                failed: counts.failed,
                skipped: counts.skipped + own,
            };
            self.in_successes = false;
            self.skipping_tests.clear();
            return true;
        }
        match line.trim_end() {
            "successes:" => self.in_successes = true,
            "failures:" => self.in_successes = false,
            _ => {}
        }
        if !self.in_successes {
            return true;
        }
        if let Some(name) = line.strip_prefix("---- ").and_then(|l| l.split(' ').next()) {
            name.clone_into(&mut self.current);
        } else if let Some(reason) = line.strip_prefix("skipped: ") {
            self.skipping_tests.insert(self.current.clone());
            self.skips.insert((self.current.clone(), reason.to_owned()));
        }
        false
    }

    /// The sums so far.
    pub(crate) fn counts(&self) -> Counts {
        self.counts
    }

    /// The tests that skipped themselves, with their reasons.
    pub(crate) fn skips(&self) -> impl Iterator<Item = (&str, &str)> {
        self.skips
            .iter()
            .map(|(test, why)| (test.as_str(), why.as_str()))
    }
}

/// `test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured; 2 filtered out; finished in 0.00s`
fn parse_result(line: &str) -> Option<Counts> {
    let rest = line.strip_prefix("test result: ")?;
    let mut counts = Counts::default();
    for part in rest.split(['.', ';']) {
        let mut words = part.split_whitespace();
        let (Some(number), Some(what)) = (words.next(), words.next()) else {
            continue;
        };
        let Ok(number) = number.parse::<usize>() else {
            continue;
        };
        match what {
            "passed" => counts.passed = number,
            "failed" => counts.failed = number,
            "ignored" => counts.skipped = number,
            _ => {}
        }
    }
    Some(counts)
}

#[cfg(test)]
mod tests {
    use super::{Counts, Reader, parse_result};

    #[test]
    fn result_lines_are_read() {
        let line = "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; 7 filtered out; finished in 0.01s";
        assert_eq!(
            parse_result(line),
            Some(Counts {
                passed: 12,
                failed: 3,
                skipped: 1
            })
        );
        assert_eq!(parse_result("test tests::foo ... ok"), None);
    }

    #[test]
    fn tests_that_skip_themselves_are_not_counted_as_passed() {
        let output = "\
running 3 tests
test a ... ok
test b ... ok
test c ... FAILED

successes:

---- b stdout ----
skipped: no shared data
skipped: said twice

successes:
    a
    b

failures:

---- c stdout ----
skipped: this line belongs to a failure

test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s";
        let mut reader = Reader::default();
        let shown: Vec<&str> = output.lines().filter(|l| reader.line(l)).collect();
        assert_eq!(
            reader.counts(),
            Counts {
                passed: 1,
                failed: 1,
                skipped: 1
            }
        );
        assert_eq!(reader.counts().to_string(), "1 passed, 1 failed, 1 skipped");
        assert_eq!(
            reader.skips().map(|(test, _)| test).collect::<Vec<_>>(),
            ["b", "b"]
        );
        assert!(shown.contains(&"---- c stdout ----") && !shown.contains(&"---- b stdout ----"));
    }
}
