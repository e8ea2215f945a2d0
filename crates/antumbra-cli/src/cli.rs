//! The options that all commands share, and the list of commands.

use std::ffi::OsString;

use clap::{Args, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::commands::{
    bake, completions, cull, demo, r#gen, man, map, pair, plan, pvs, ray, shadow,
};
use crate::output::Output;
use crate::values::positive;

/// Exact visibility: what can be seen from here, with a proof of every answer.
#[derive(Debug, Parser)]
#[command(name = "antumbra", version, propagate_version = true, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
Examples:
  antumbra demo
  antumbra bake house.glb --cells grid:2 -o house.pvs
  antumbra pvs query house.pvs --at 3.5,-2,1.6
  antumbra pair house.glb --from lamp --to table
  antumbra map house.glb --eye -12,-9,6 --to 4,3,2 --svg house.svg
  antumbra shadow house.glb --light 3,2,2.4 -o lit.glb
  antumbra cull house.glb --path walk.path --verify
  antumbra plan office.geojson --cell \"4,3 8,3 8,6 4,6\" --svg office.svg

Exit codes: 0 done; 2 wrong usage; 3 damaged or impossible content; 4 a path that cannot be
read or written; 5 stopped, with what was finished saved.";

impl Cli {
    /// Parses a command line. Values may be negative numbers: what is wrong with one is then said of
    /// the value, and it is not taken for an option.
    pub(crate) fn read(args: &[OsString]) -> Result<Self, clap::Error> {
        let matches = with_negative_numbers(Self::command()).try_get_matches_from(args)?;
        Self::from_arg_matches(&matches)
    }
}

fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let of_arg = |arg: clap::Arg| {
        let takes = arg.get_action().takes_values();
        arg.allow_negative_numbers(takes)
    };
    command
        .mut_args(of_arg)
        .mut_subcommands(with_negative_numbers)
}

/// Options of every command.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Global {
    /// Threads to use (default: all cores); results never depend on it
    #[arg(long, global = true, value_name = "N", help_heading = "Global options")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print no progress and no notes
    #[arg(long, short, global = true, help_heading = "Global options")]
    pub quiet: bool,
    /// Grid step in scene units (default: the finest power of two that fits)
    #[arg(long, global = true, value_name = "SIZE", value_parser = positive, help_heading = "Global options")]
    pub grid: Option<f64>,
    /// What chance depends on
    #[arg(
        long,
        global = true,
        value_name = "N",
        default_value_t = 1,
        help_heading = "Global options"
    )]
    pub seed: u64,
    /// Print exactly one JSON object to stdout
    #[arg(long, global = true, help_heading = "Global options")]
    pub json: bool,
}

impl Global {
    /// How to talk.
    pub(crate) fn output(&self) -> Output {
        Output {
            json: self.json,
            quiet: self.quiet,
        }
    }
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute what can be seen from every cell of a scene
    Bake(bake::BakeArgs),
    /// Look into, check, compare and draw a .pvs file
    #[command(subcommand)]
    Pvs(pvs::PvsCommand),
    /// Decide whether two objects, polygons or points can see each other
    Pair(pair::PairArgs),
    /// Follow a line: first hit and free stretches, exactly
    Ray(ray::RayArgs),
    /// Draw what is seen from a point: hidden-line drawings, solid angles, the visibility map
    Map(map::MapArgs),
    /// Cut every polygon into lit and shadowed parts; find where soft shadows begin and end
    Shadow(shadow::ShadowArgs),
    /// Cull the frames of a camera path in real time: what may be seen, never wrong
    Cull(Box<cull::CullArgs>),
    /// See what a room, a street or a point of a floor plan or city map sees, in the plane
    Plan(plan::PlanArgs),
    /// Make a synthetic scene
    Gen(r#gen::GenArgs),
    /// Bake, check and draw a small office that is built in
    Demo(demo::DemoArgs),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArgs),
    /// Print the manual page
    Man(man::ManArgs),
}
