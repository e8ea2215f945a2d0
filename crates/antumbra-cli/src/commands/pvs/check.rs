//! `antumbra pvs check`: verifies every certificate of a bake, recomputing nothing.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use antumbra::region::{Accuracy, CheckReport, FinePoint, VisibleEntry, Witness, check_cell};
use antumbra_io::pvs::{Accuracy as Stored, CellIndex, PvsCell, PvsCellKind};
use antumbra_io::{ProofFile, PvsFile, PvsWriter};
use antumbra_scene::{CellKind, ObjectId, PolygonId, Scene, ViewCell};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;

use super::{open, pvs_failure};
use crate::cli::Global;
use crate::failure::Failure;
use crate::load;
use crate::output::{Output, seconds};
use crate::recipe::{Recipe, scene_hash};

/// Options of `pvs check`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra pvs check house.pvs --scene house.glb")]
pub(crate) struct CheckArgs {
    /// The .pvs file; its certificates are in the .proof file beside it
    file: PathBuf,
    /// The scene it was baked from
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,
}

/// Checks and reports.
pub(crate) fn run(args: &CheckArgs, global: &Global) -> Result<(), Failure> {
    let file = open(&args.file)?;
    let proofs = open_proofs(&args.file, &file)?;
    let scene = scene_of(&file, &args.scene)?;
    let checked = check(&file, &proofs, &scene, global.output())?;
    let failed = checked.report.failed.len();
    let result = json!({
        "visible_checked": checked.report.visible_checked,
        "hidden_checked": checked.report.hidden_checked,
        "failed": failed,
        "failures": checked.report.failed,
        "seconds": seconds(checked.time),
    });
    let mut lines = vec![format!(
        "{}: {} visible and {} hidden pairs of cell and object checked, {failed} failed; {:.2} s",
        args.file.display(),
        checked.report.visible_checked,
        checked.report.hidden_checked,
        checked.time.as_secs_f64()
    )];
    lines.extend(
        checked
            .report
            .failed
            .iter()
            .take(20)
            .map(|f| format!("  {f}")),
    );
    global.output().result(&result, &lines.join("\n"))?;
    if failed == 0 {
        return Ok(());
    }
    Err(Failure::Content(format!(
        "{}: {failed} certificates do not hold; bake the scene anew",
        args.file.display()
    )))
}

/// What a check found, over all cells.
pub(crate) struct Checked {
    pub report: CheckReport,
    pub time: Duration,
}

/// Opens the certificates beside a file.
pub(crate) fn open_proofs(path: &Path, file: &PvsFile) -> Result<ProofFile, Failure> {
    if !file.provenance().proofs {
        return Err(Failure::Usage(format!(
            "{}: baked with --no-proofs, so there is nothing to check; bake it again without that option",
            path.display()
        )));
    }
    let proofs = ProofFile::open(&PvsWriter::proof_path(path)).map_err(|e| pvs_failure(&e))?;
    proofs.check_belongs_to(file).map_err(|e| pvs_failure(&e))?;
    Ok(proofs)
}

/// Builds a scene as it was for a bake, and makes sure it is the same.
pub(crate) fn scene_of(file: &PvsFile, path: &Path) -> Result<Scene, Failure> {
    let provenance = file.provenance();
    let recipe = Recipe::from_text(&provenance.options).ok_or_else(|| {
        Failure::Content(format!(
            "{}: its options are in a form this program does not know; use the program that wrote it (antumbra {})",
            file.file_name(),
            provenance.antumbra
        ))
    })?;
    let input = load::read(path, &recipe.reading)?;
    let (scene, _) = load::build(input, &recipe.reading, recipe.grid, recipe.cells_box)?;
    if Some(scene_hash(&scene)) != provenance.scene_hash() {
        return Err(Failure::Content(format!(
            "{}: this is not the scene that {} was baked from; give that scene, unchanged",
            path.display(),
            file.file_name()
        )));
    }
    Ok(scene)
}

/// Verifies every certificate of every cell.
pub(crate) fn check(
    file: &PvsFile,
    proofs: &ProofFile,
    scene: &Scene,
    output: Output,
) -> Result<Checked, Failure> {
    let bar = output.progress(file.cell_count() as u64, "cells checked");
    let start = Instant::now();
    let one = |index: CellIndex| -> Result<CheckReport, Failure> {
        let record = file.record(index).map_err(|e| pvs_failure(&e))?;
        let proof = proofs.proof(index).map_err(|e| pvs_failure(&e))?;
        let Some(cell) = file.cell(index).map(view_cell) else {
            return Ok(CheckReport::default());
        };
        let visible: Vec<VisibleEntry> = record
            .visible
            .iter()
            .map(|entry| VisibleEntry {
                object: ObjectId(entry.object),
                touching: entry.witness.is_none(),
                witness: entry.witness.map(|w| Witness {
                    from: FinePoint(w.from),
                    through: FinePoint(w.through),
                    polygon: PolygonId(w.polygon),
                    source: w.source,
                }),
            })
            .collect();
        let unknown: Vec<ObjectId> = record.unknown.iter().map(|id| ObjectId(*id)).collect();
        let accuracy = stored_accuracy(record.accuracy);
        let report = check_cell(scene, &cell, &visible, &unknown, accuracy, &proof);
        bar.inc(1);
        Ok(report)
    };
    let indices: Vec<CellIndex> = file.cells().collect();
    let reports: Result<Vec<CheckReport>, Failure> =
        indices.into_par_iter().with_max_len(1).map(one).collect();
    bar.finish_and_clear();
    let mut report = CheckReport::default();
    for part in reports? {
        report.visible_checked += part.visible_checked;
        report.hidden_checked += part.hidden_checked;
        report.failed.extend(part.failed);
    }
    Ok(Checked {
        report,
        time: start.elapsed(),
    })
}

/// A stored accuracy class as the engine knows it.
fn stored_accuracy(accuracy: Stored) -> Accuracy {
    match accuracy {
        Stored::Exact => Accuracy::Exact,
        // The engine never writes the last one; conservative claims the least that can be checked.
        Stored::Conservative | Stored::Approximate => Accuracy::Conservative,
        Stored::AggressiveBelow(angle) => Accuracy::AggressiveBelow(angle),
    }
}

/// A stored cell as the engine knows it.
pub(crate) fn view_cell(cell: PvsCell) -> ViewCell {
    ViewCell {
        name: cell.name,
        bounds: cell.bounds,
        kind: match cell.kind {
            PvsCellKind::Box => CellKind::Box,
            PvsCellKind::Object(id) => CellKind::Object(ObjectId(id)),
        },
    }
}
