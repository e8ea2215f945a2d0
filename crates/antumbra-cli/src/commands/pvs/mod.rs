//! `antumbra pvs`: what can be done with a baked file.

pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod export;
pub(crate) mod info;
pub(crate) mod query;
pub(crate) mod render;

use std::path::Path;

use antumbra_io::pvs::{Accuracy, CellIndex, PvsCell};
use antumbra_io::{PvsError, PvsFile};
use clap::Subcommand;

use crate::cli::Global;
use crate::failure::Failure;

/// What to do with a .pvs file.
#[derive(Debug, Subcommand)]
pub(crate) enum PvsCommand {
    /// Say what a file is and where it comes from
    Info(info::InfoArgs),
    /// List what may be visible from a point
    Query(query::QueryArgs),
    /// Print everything as JSON
    Export(export::ExportArgs),
    /// Verify every certificate, recomputing nothing
    Check(check::CheckArgs),
    /// Measure how two files differ
    Compare(compare::CompareArgs),
    /// Draw what a cell sees
    Render(render::RenderArgs),
}

/// Runs it.
pub(crate) fn run(command: &PvsCommand, global: &Global) -> Result<(), Failure> {
    match command {
        PvsCommand::Info(args) => info::run(args, global),
        PvsCommand::Query(args) => query::run(args, global),
        PvsCommand::Export(args) => export::run(args),
        PvsCommand::Check(args) => check::run(args, global),
        PvsCommand::Compare(args) => compare::run(args, global),
        PvsCommand::Render(args) => render::run(args, global),
    }
}

/// Opens a .pvs file.
pub(crate) fn open(path: &Path) -> Result<PvsFile, Failure> {
    PvsFile::open(path).map_err(|error| pvs_failure(&error))
}

/// A failure of the container as a failure of the command.
pub(crate) fn pvs_failure(error: &PvsError) -> Failure {
    if error.is_path_error() {
        Failure::Path(error.to_string())
    } else {
        Failure::Content(error.to_string())
    }
}

/// Finds a cell by number or name.
pub(crate) fn cell(file: &PvsFile, text: &str) -> Result<(CellIndex, PvsCell), Failure> {
    let index = match text.parse::<u32>() {
        Ok(number) => Some(CellIndex(number)),
        Err(_) => file
            .cells()
            .find(|i| file.cell(*i).is_some_and(|c| c.name == text)),
    };
    let found = index.and_then(|i| Some((i, file.cell(i)?)));
    found.ok_or_else(|| {
        Failure::Content(format!(
            "{}: there is no cell '{text}', only {} cells numbered from 0; list them with `antumbra pvs export`",
            file.file_name(),
            file.cell_count()
        ))
    })
}

/// The name of an accuracy class.
pub(crate) fn accuracy_name(accuracy: Accuracy) -> &'static str {
    match accuracy {
        Accuracy::Exact => "exact",
        Accuracy::Conservative => "conservative",
        Accuracy::AggressiveBelow(_) => "aggressive",
        Accuracy::Approximate => "approximate",
    }
}

/// The class that is true of both.
pub(crate) fn weaker(a: Accuracy, b: Accuracy) -> Accuracy {
    use Accuracy::{AggressiveBelow, Approximate, Conservative, Exact};
    match (a, b) {
        (Exact, other) | (other, Exact) => other,
        (Conservative, Conservative) => Conservative,
        (AggressiveBelow(x), AggressiveBelow(y)) => AggressiveBelow(x.max(y)),
        _ => Approximate,
    }
}

/// What a file says of all its cells together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Totals {
    /// Pairs of cell and object that were not decided.
    pub unknown: u64,
    /// Objects that may not be culled, a cell on average.
    pub visible_mean: f64,
    /// The weakest accuracy of a cell.
    pub accuracy: Accuracy,
}

/// Adds up all cells.
pub(crate) fn totals(file: &PvsFile) -> Result<Totals, Failure> {
    let (mut unknown, mut visible, mut accuracy) = (0, 0, Accuracy::Exact);
    for cell in file.cells() {
        unknown += file.unknown(cell).map_err(|e| pvs_failure(&e))?.len();
        visible += file.visible(cell).map_err(|e| pvs_failure(&e))?.len();
        accuracy = weaker(
            accuracy,
            file.accuracy(cell).unwrap_or(Accuracy::Approximate),
        );
    }
    let visible_mean = visible as f64 / file.cell_count().max(1) as f64;
    Ok(Totals {
        unknown,
        visible_mean,
        accuracy,
    })
}
