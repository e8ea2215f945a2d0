//! `antumbra man [COMMAND]...`: the manual page, as roff.

use clap::{Args, CommandFactory as _};

use crate::cli::Cli;
use crate::failure::Failure;
use crate::output::line;

/// Options of `man`.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  antumbra man | man -l -\n  antumbra man pvs query > antumbra-pvs-query.1"
)]
pub(crate) struct ManArgs {
    /// The command whose page to print (default: the page of antumbra itself)
    command: Vec<String>,
}

/// Prints the page.
pub(crate) fn run(args: &ManArgs) -> Result<(), Failure> {
    let mut command = Cli::command();
    command.build();
    for name in &args.command {
        let Some(sub) = command.find_subcommand(name) else {
            let path = command.get_name();
            return Err(Failure::Usage(format!(
                "{path} has no command '{name}'; see `antumbra --help`"
            )));
        };
        command = sub.clone();
    }
    let mut page = Vec::new();
    // Writing to memory cannot fail.
    let _ = clap_mangen::Man::new(command).render(&mut page);
    line(String::from_utf8_lossy(&page).trim_end())
}
