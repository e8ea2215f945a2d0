//! Words that do not belong: the text speaks of the project, not of where or how it was written.

use super::{File, Report};

/// Each in two halves, so that this list does not find itself. Matched as whole words, without case.
const WORDS: [(&str, &str, &str); 9] = [
    ("ses", "sion", "say run, or name the thing"),
    ("assis", "tant", "speak of the project only"),
    ("chat", "bot", "speak of the project only"),
    ("/wor", "k/", "a path of one machine"),
    ("/hom", "e/", "a path of one machine"),
    ("/roo", "t/", "a path of one machine"),
    ("crates", ".io", "a package registry"),
    ("pypi", ".org", "a package registry"),
    ("npmjs", ".com", "a package registry"),
];
/// Words that are followed by a number only when they point into a tracker.
const TRACKERS: [&str; 6] = ["issue", "issues", "fixes", "closes", "ticket", "pr"];

pub(super) fn check(files: &[File], report: &mut Report) {
    // A lock file names where every dependency comes from; a change log, what was resolved.
    for file in files.iter().filter(|f| !f.path.ends_with(".lock")) {
        for (i, line) in file.text.lines().enumerate() {
            let place = format!("{}:{}", file.path, i + 1);
            let lower = line.to_lowercase();
            for (word, why) in WORDS.iter().map(|(a, b, why)| (format!("{a}{b}"), why)) {
                if has_whole(&lower, &word) {
                    report.errors.push(format!("{place}: `{word}`: {why}"));
                }
            }
            if has_tracker_number(&lower, !file.path.ends_with(".svg")) {
                report.errors.push(format!(
                    "{place}: a tracker's number: say what it was about"
                ));
            }
        }
    }
}

/// Whether `word` occurs with no letter or digit directly before or after it.
fn has_whole(line: &str, word: &str) -> bool {
    let edge = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    line.match_indices(word).any(|(at, _)| {
        let inside_path = word.starts_with('/');
        let before = edge(line[..at].chars().next_back()) || inside_path && at == 0;
        let after = inside_path || edge(line[at + word.len()..].chars().next());
        before && after
    })
}

/// `issue 12`, `fixes #12`, or a lone `#12`.
fn has_tracker_number(line: &str, lone_too: bool) -> bool {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |w: &str| {
        let digits = w
            .trim_start_matches(['#', '('])
            .trim_end_matches(['.', ',', ')', ':', ';']);
        !digits.is_empty() && digits.len() <= 5 && digits.bytes().all(|b| b.is_ascii_digit())
    };
    let named = words.windows(2).any(|pair| {
        let name = pair[0].trim_start_matches('(');
        TRACKERS.contains(&name) && number(pair[1])
    });
    let lone = words.iter().any(|w| {
        let w = w.trim_start_matches('(');
        w.starts_with('#') && number(w)
    });
    named || lone && lone_too
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, file};
    use super::{WORDS, check, has_tracker_number};

    fn count(text: &str) -> usize {
        errors(check, &[file("docs/a.md", text)]).len()
    }

    #[test]
    fn every_word_of_the_list_is_found() {
        for (a, b, _) in WORDS {
            assert_eq!(count(&format!("see {a}{b}, then")), 1, "{a}{b}");
        }
    }

    #[test]
    fn legitimate_words_stay() {
        for text in [
            "an obsession",
            "the network/x",
            "the issue is large",
            "# 12 monkeys",
            "obj#12a",
        ] {
            assert_eq!(count(text), 0, "{text}");
        }
    }

    #[test]
    fn numbers_of_a_tracker_are_found() {
        for text in ["issue N", "fixes #N.", "(see #N)", "pr N:"] {
            assert!(has_tracker_number(&text.replace('N', "12"), true), "{text}");
        }
        assert!(!has_tracker_number("the ring of issue 123456789", true));
        assert!(!has_tracker_number(
            &"<path fill= N />".replace('N', "#123"),
            false
        ));
    }
}
