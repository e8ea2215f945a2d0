//! `antumbra pvs compare`: how much two files differ.

use std::path::PathBuf;

use antumbra_io::compare::compare;
use clap::Args;
use serde_json::json;

use super::{open, pvs_failure};
use crate::cli::Global;
use crate::failure::Failure;

/// Options of `pvs compare`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra pvs compare fast.pvs exact.pvs")]
pub(crate) struct CompareArgs {
    /// The file to judge
    a: PathBuf,
    /// The reference
    b: PathBuf,
}

/// Prints the relative over- and underestimation of A.
pub(crate) fn run(args: &CompareArgs, global: &Global) -> Result<(), Failure> {
    let (a, b) = (open(&args.a)?, open(&args.b)?);
    let c = compare(&a, &b).map_err(|e| pvs_failure(&e))?;
    let differences: Vec<_> = c
        .differences
        .iter()
        .map(|d| json!({"cell": d.cell, "name": d.name, "only_a": d.only_a, "only_b": d.only_b}))
        .collect();
    let result = json!({
        "cells": c.cells,
        "entries_a": c.entries_a,
        "entries_b": c.entries_b,
        "only_a": c.only_a,
        "only_b": c.only_b,
        "q_over": c.q_over,
        "q_under": c.q_under,
        "differences": differences,
    });
    let text = format!(
        "{} cells: {} entries against {} in the reference; {} too many (Q_o = {:.4}), {} too few (Q_u = {:.4}), {} cells differ",
        c.cells,
        c.entries_a,
        c.entries_b,
        c.only_a,
        c.q_over,
        c.only_b,
        c.q_under,
        c.differences.len()
    );
    global.output().result(&result, &text)
}
