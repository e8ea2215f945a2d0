//! The command line of Antumbra: `antumbra COMMAND INPUT [options]`.

mod cancel;
mod cells_file;
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

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;
use clap::error::ErrorKind;

use crate::cli::Cli;
use crate::failure::Failure;

fn main() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(cli) => commands::run(cli),
        Err(error) => explain(&error),
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
fn explain(error: &clap::Error) -> Result<(), Failure> {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // Clap knows whether stdout understands styles; a reader that went away is no failure.
            let _ = error.print();
            Ok(())
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => Err(Failure::Usage(
            "a command is missing; see `antumbra --help`".to_owned(),
        )),
        _ => {
            let text = error.render().to_string();
            let body = text.split("\n\nUsage:").next().unwrap_or_default();
            let body = body
                .split("\n\nFor more information")
                .next()
                .unwrap_or_default();
            let words: Vec<&str> = body.split_whitespace().collect();
            let sentence = words.join(" ");
            let sentence = sentence.strip_prefix("error: ").unwrap_or(&sentence);
            Err(Failure::Usage(format!("{sentence}; see `antumbra --help`")))
        }
    }
}
