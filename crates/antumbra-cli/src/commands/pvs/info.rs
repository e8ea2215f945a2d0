//! `antumbra pvs info`: what a file is.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{accuracy_name, open, totals};
use crate::cli::Global;
use crate::failure::Failure;

/// Options of `pvs info`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra pvs info house.pvs")]
pub(crate) struct InfoArgs {
    /// The .pvs file
    file: PathBuf,
}

/// Prints sizes and provenance.
pub(crate) fn run(args: &InfoArgs, global: &Global) -> Result<(), Failure> {
    let file = open(&args.file)?;
    let totals = totals(&file)?;
    let provenance = file.provenance();
    let accuracy = accuracy_name(totals.accuracy);
    let result = json!({
        "cells": file.cell_count(),
        "objects": file.object_count(),
        "bytes": file.byte_len(),
        "unknown": totals.unknown,
        "visible_mean": totals.visible_mean,
        "accuracy": accuracy,
        "provenance": {
            "antumbra": provenance.antumbra,
            "scene": provenance.scene,
            "grid": {"origin": provenance.grid.origin, "step": provenance.grid.step},
            "options": provenance.options,
            "proofs": provenance.proofs,
        },
    });
    let text = format!(
        "{}: {} cells, {} objects, {} bytes\n\
         a cell may see {:.1} objects on average, {accuracy}, {} undecided\n\
         scene    {}\n\
         grid     step {} at {:?}\n\
         options  {}\n\
         proofs   {}\n\
         written by antumbra {}",
        args.file.display(),
        file.cell_count(),
        file.object_count(),
        file.byte_len(),
        totals.visible_mean,
        totals.unknown,
        provenance.scene,
        provenance.grid.step,
        provenance.grid.origin,
        provenance.options,
        if provenance.proofs {
            "in a .proof file beside it"
        } else {
            "none"
        },
        provenance.antumbra,
    );
    global.output().result(&result, &text)
}
