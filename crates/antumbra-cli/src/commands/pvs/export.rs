//! `antumbra pvs export`: everything as JSON.

use std::path::PathBuf;

use antumbra_io::export::export;
use clap::Args;

use super::{open, pvs_failure};
use crate::failure::Failure;
use crate::output::line;

/// Options of `pvs export`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra pvs export house.pvs --json --witnesses > house.json")]
pub(crate) struct ExportArgs {
    /// The .pvs file
    file: PathBuf,
    /// Also a witness segment for each visible object that does not touch the cell
    #[arg(long)]
    witnesses: bool,
}

/// Prints one JSON object.
pub(crate) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let file = open(&args.file)?;
    let export = export(&file, args.witnesses).map_err(|e| pvs_failure(&e))?;
    let text = serde_json::to_string(&export).map_err(|cause| {
        Failure::Content(format!(
            "{}: cannot be put into JSON ({cause}); bake it anew",
            args.file.display()
        ))
    })?;
    line(&text)
}
