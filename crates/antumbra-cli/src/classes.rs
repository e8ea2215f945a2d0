//! Class names on the command line, held against those there are.

use crate::failure::Failure;
use crate::output::Output;

/// How many names a message lists.
const LISTED: usize = 20;

/// Notes classes that nothing has, and refuses `--occluders` if nothing has any of them: then nothing
/// would block the view.
pub(crate) fn check_classes(
    occluders: &[String],
    transparent: &[String],
    known: &[String],
    output: Output,
) -> Result<(), Failure> {
    let has = |name: &String| known.iter().any(|k| same(k, name));
    if !occluders.is_empty() && !occluders.iter().any(has) {
        return Err(Failure::Usage(format!(
            "--occluders {}: nothing has such a class, so nothing would block the view; {}",
            occluders.join(","),
            listing(known)
        )));
    }
    for name in occluders.iter().chain(transparent).filter(|n| !has(n)) {
        output.note(&format!(
            "note: nothing has the class {name}; {}",
            listing(known)
        ));
    }
    Ok(())
}

/// Without case, as policies compare.
fn same(a: &str, b: &str) -> bool {
    a.to_lowercase() == b.to_lowercase()
}

/// The classes there are, as the end of a sentence.
pub(crate) fn listing(known: &[String]) -> String {
    let mut names: Vec<&str> = known.iter().map(String::as_str).collect();
    names.retain(|n| !n.is_empty());
    names.sort_unstable();
    names.dedup();
    let more = if names.len() > LISTED { ", ..." } else { "" };
    match names[..] {
        [] => "nothing there has a class".to_owned(),
        _ => format!(
            "the classes are {}{more}",
            names[..names.len().min(LISTED)].join(", ")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::{check_classes, listing};
    use crate::output::Output;

    #[test]
    fn unknown_classes_are_noted_or_refused() {
        let known = ["Wall", "door", ""].map(str::to_owned);
        let output = Output {
            json: false,
            quiet: true,
        };
        let names = |list: &[&str]| -> Vec<String> { list.iter().map(|n| (*n).into()).collect() };
        let check = |o: &[&str], t: &[&str]| check_classes(&names(o), &names(t), &known, output);
        assert!(check(&["wall", "glass"], &[]).is_ok());
        assert!(check(&[], &["glass"]).is_ok());
        assert!(check(&["glass"], &[]).is_err());
        assert_eq!(listing(&known), "the classes are Wall, door");
        assert_eq!(listing(&[]), "nothing there has a class");
    }
}
