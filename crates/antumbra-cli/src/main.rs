//! The command line of Antumbra: `antumbra COMMAND INPUT [options]`.

mod cancel;
mod cells_file;
mod classes;
mod cli;
mod commands;
mod ends;
mod engine;
mod failure;
mod load;
mod output;
mod picture;
mod recipe;
mod values;

use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;

use clap::CommandFactory as _;
use clap::error::ErrorKind;

use crate::cli::Cli;
use crate::failure::Failure;

fn main() -> ExitCode {
    let args: Vec<OsString> = std::env::args_os().collect();
    let outcome = match Cli::read(&args) {
        Ok(cli) => commands::run(cli),
        Err(error) => explain(&error, &args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // Nothing can be done if stderr is gone.
            let _ = writeln!(std::io::stderr(), "error: {failure}");
            ExitCode::from(failure.code())
        }
    }
}

/// Prints help and version; turns wrong usage into one sentence.
fn explain(error: &clap::Error, args: &[OsString]) -> Result<(), Failure> {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // Clap knows whether stdout understands styles; a reader that went away is no failure.
            let _ = error.print();
            Ok(())
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => Err(Failure::Usage(
            "a command is missing; see `antumbra --help`".to_owned(),
        )),
        _ => Err(Failure::Usage(usage(&error.render().to_string(), args))),
    }
}

/// One sentence of a rendered error: what is wrong, a tip, where help is.
fn usage(text: &str, args: &[OsString]) -> String {
    let body = text.split("\n\nFor more information").next();
    let body = body.and_then(|b| b.split("\n\nUsage: ").next());
    let mut parts = body.unwrap_or_default().split("\n\n").map(|part| {
        let lines: Vec<&str> = part.lines().map(str::trim).collect();
        match lines[..] {
            // A list has a line an item.
            [head, ref items @ ..] if head.ends_with(':') => {
                format!("{head} {}", items.join(", "))
            }
            _ => lines.join(" "),
        }
    });
    let mut sentence = parts.next().unwrap_or_default();
    for part in parts {
        sentence = format!("{sentence}; {}", part.trim());
    }
    let sentence = sentence.strip_prefix("error: ").unwrap_or(&sentence);
    format!("{sentence}; see `{} --help`", command_of(args))
}

/// The command that is named, as far as there is one.
fn command_of(args: &[OsString]) -> String {
    let mut command = Cli::command();
    let mut path = command.get_name().to_owned();
    for word in args.iter().skip(1).filter_map(|a| a.to_str()) {
        if let Some(found) = command.find_subcommand(word).cloned() {
            path = format!("{path} {word}");
            command = found;
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use std::ffi::OsString;

    use crate::cli::Cli;

    fn usage(line: &str) -> String {
        let args: Vec<OsString> = line.split(' ').map(Into::into).collect();
        let error = Cli::read(&args).expect_err("wrong usage");
        super::usage(&error.render().to_string(), &args)
    }

    #[test]
    fn wrong_usage_is_one_sentence_with_the_command_that_helps() {
        assert_eq!(
            usage("antumbra map"),
            "the following required arguments were not provided: --eye <X,Y,Z>, <SCENE>; \
             see `antumbra map --help`"
        );
        assert_eq!(
            usage("antumbra pvs query a.pvs --att 1,2,3"),
            "unexpected argument '--att' found; tip: a similar argument exists: '--at'; \
             see `antumbra pvs query --help`"
        );
        assert_eq!(
            usage("antumbra gen maze --rooms -1 -o a.glb"),
            "invalid value '-1' for '--rooms <N>': -1 is not in 1..=500; \
             see `antumbra gen maze --help`"
        );
    }
}
