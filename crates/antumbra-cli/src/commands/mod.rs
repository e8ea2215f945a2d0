//! One file a command.

pub(crate) mod bake;
pub(crate) mod completions;
pub(crate) mod cull;
pub(crate) mod demo;
pub(crate) mod r#gen;
pub(crate) mod man;
pub(crate) mod map;
pub(crate) mod pair;
pub(crate) mod plan;
pub(crate) mod pvs;
pub(crate) mod ray;
pub(crate) mod shadow;

use crate::cli::{Cli, Command};
use crate::failure::Failure;

/// Runs the command that was asked for.
pub(crate) fn run(cli: Cli) -> Result<(), Failure> {
    let global = cli.global;
    start_threads(global.threads)?;
    match cli.command {
        Command::Bake(args) => bake::run(&args, &global),
        Command::Pvs(command) => pvs::run(&command, &global),
        Command::Pair(args) => pair::run(&args, &global),
        Command::Ray(args) => ray::run(&args, &global),
        Command::Map(args) => map::run(&args, &global),
        Command::Shadow(args) => shadow::run(&args, &global),
        Command::Cull(args) => cull::run(&args, &global),
        Command::Plan(args) => plan::run(&args, &global),
        Command::Gen(args) => r#gen::run(&args, &global),
        Command::Demo(args) => demo::run(&args, &global),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
    }
}

/// The threads that read, build, bake and check; all cores if their number is not given.
fn start_threads(threads: Option<u16>) -> Result<(), Failure> {
    let Some(count) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(count))
        .build_global()
        .map_err(|cause| {
            Failure::Usage(format!(
                "{count} threads cannot be started ({cause}); give fewer with --threads"
            ))
        })
}
