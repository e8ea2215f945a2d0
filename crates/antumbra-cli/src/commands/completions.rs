//! `antumbra completions SHELL`: a completion script.

use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use crate::cli::Cli;
use crate::failure::Failure;
use crate::output::line;

/// Options of `completions`.
#[derive(Args, Debug)]
#[command(
    after_help = "Example:\n  antumbra completions bash > ~/.local/share/bash-completion/completions/antumbra"
)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script.
pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "antumbra", &mut script);
    line(String::from_utf8_lossy(&script).trim_end())
}
