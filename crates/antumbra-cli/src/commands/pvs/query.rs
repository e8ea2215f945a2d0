//! `antumbra pvs query`: what may be visible from a point.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::{open, pvs_failure};
use crate::cli::Global;
use crate::failure::Failure;
use crate::values::PointArg;

/// Options of `pvs query`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra pvs query house.pvs --at -3.5,2,1.6 --json")]
pub(crate) struct QueryArgs {
    /// The .pvs file
    file: PathBuf,
    /// Where, in scene units (z up)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    at: PointArg,
}

/// Prints the objects.
pub(crate) fn run(args: &QueryArgs, global: &Global) -> Result<(), Failure> {
    let file = open(&args.file)?;
    let [x, y, z] = args.at.0;
    let Some(index) = file.cell_at(args.at.0) else {
        return Err(Failure::Content(format!(
            "{}: no cell contains the point ({x}, {y}, {z}), so nothing is known there; give a point inside a cell or bake cells around it",
            args.file.display()
        )));
    };
    let visible = file.visible(index).map_err(|e| pvs_failure(&e))?;
    let name = |id: u32| file.object_name(id).unwrap_or_default();
    let objects: Vec<Value> = visible
        .iter()
        .map(|id| json!({"id": id, "name": name(id)}))
        .collect();
    let cell = file.cell(index).map(|cell| cell.name).unwrap_or_default();
    let mut lines = vec![format!(
        "cell {} ({cell}): {} objects may be visible",
        index.0,
        objects.len()
    )];
    lines.extend(visible.iter().map(|id| format!("{id:>6}  {}", name(id))));
    let result = json!({"cell": index.0, "name": cell, "visible": objects});
    global.output().result(&result, &lines.join("\n"))
}
