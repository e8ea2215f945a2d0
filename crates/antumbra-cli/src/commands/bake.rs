//! `antumbra bake`: the potentially visible set of every cell of a scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use antumbra::region::{BakeOptions, Baker};
use antumbra_io::pvs::Finished;
use antumbra_io::{PvsError, PvsWriter};
use antumbra_scene::{CellSpec, Scene, ViewCell, make_cells};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;

use super::pvs::{Totals, accuracy_name, open, pvs_failure, totals};
use crate::cancel::on_interrupt;
use crate::cells_file;
use crate::cli::Global;
use crate::engine::{header, record};
use crate::failure::Failure;
use crate::load::{SceneArgs, load};
use crate::output::{Output, check_writable, seconds};
use crate::recipe::Recipe;
use crate::values::AngleArg;

/// Options of `bake`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BakeArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// View cells: `grid:SIZE` (cubes over the whole scene), `boxes:FILE.json`
    /// (`[{"name","min":[3],"max":[3]}]`), `object:NAME` (its polygons are the source), `auto`
    /// (over free space)
    #[arg(long, value_name = "SPEC", default_value = "auto")]
    cells: String,
    /// The file to write (default: the scene's name with .pvs, in this folder)
    #[arg(long, short, value_name = "F.pvs")]
    output: Option<PathBuf>,
    /// Count sets of lines below this angle as blocked, for example 0.1mrad or 0.01deg; the
    /// result is then aggressive
    #[arg(long, value_name = "ANGLE")]
    ignore_below: Option<AngleArg>,
    /// Keep no certificates of what is hidden
    #[arg(long)]
    no_proofs: bool,
    /// List every object that had to be repaired, not only the first ones
    #[arg(long)]
    report: bool,
    /// Go on with an interrupted bake
    #[arg(long)]
    resume: bool,
    /// Give up on an object after this many splits; it is then unknown, and never culled
    #[arg(long, value_name = "N")]
    max_splits: Option<u64>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra bake house.glb --cells grid:2 -o house.pvs
  antumbra bake house.glb --cells boxes:rooms.json --transparent window,door
  antumbra bake walls.glb --cells object:source --json
  antumbra bake city.obj --up y --ignore-below 0.1mrad --no-proofs
  antumbra bake house.glb --cells grid:2 -o house.pvs --resume

Certificates go to F.proof beside F.pvs. Ctrl-C saves the finished cells in F.pvs.part.";

/// Bakes a scene.
pub(crate) fn run(args: &BakeArgs, global: &Global) -> Result<(), Failure> {
    let output = global.output();
    let path = match &args.output {
        Some(path) => path.clone(),
        None => default_output(&args.scene.scene),
    };
    check_writable(&path, &[&args.scene.scene])?;
    let (spec, cells_box) = cells(&args.cells)?;
    let loaded = load(&args.scene, global, cells_box)?;
    if !loaded.report.repairs.is_empty() {
        output.note(&repairs(&loaded.report.to_string(), args.report));
    }
    let scene = &loaded.scene;
    let cells = make_cells(scene, &spec)
        .map_err(|e| Failure::Content(format!("{}: {e}", args.scene.scene.display())))?;
    let name = args.cells.split(':').next().unwrap_or_default();
    let recipe = Recipe {
        cells: if name == "boxes" {
            name.to_owned()
        } else {
            args.cells.clone()
        },
        cells_box,
        grid: global.grid,
        ignore_below: args.ignore_below.map(|a| a.0),
        max_splits: args.max_splits,
        reading: args.scene.reading.clone(),
        seed: global.seed,
    };
    let job = Job {
        scene,
        cells: &cells,
        recipe: &recipe,
        proofs: !args.no_proofs,
        resume: args.resume,
        path: &path,
    };
    let baked = bake(&job, output)?;
    let accuracy = accuracy_name(baked.totals.accuracy);
    let result = json!({
        "output": path.display().to_string(),
        "cells": cells.len(),
        "objects": scene.objects().len(),
        "polygons": scene.polygon_count(),
        "unknown": baked.totals.unknown,
        "visible_mean": baked.totals.visible_mean,
        "accuracy": accuracy,
        "grid": scene.grid().step(),
        "bytes": baked.finished.pvs_bytes,
        "proof_bytes": baked.finished.proof_bytes,
        "seconds": seconds(baked.bake_time),
        "load_seconds": seconds(loaded.load_time),
        "build_seconds": seconds(loaded.build_time + baked.prepare_time),
        "write_seconds": seconds(baked.write_time),
    });
    let text = format!(
        "{}: {} cells, {} objects; a cell may see {:.1} on average ({accuracy}, {} unknown); {:.2} s",
        path.display(),
        cells.len(),
        scene.objects().len(),
        baked.totals.visible_mean,
        baked.totals.unknown,
        baked.bake_time.as_secs_f64(),
    );
    output.result(&result, &text)
}

/// The summary of a report and its first objects, or all.
fn repairs(report: &str, all: bool) -> String {
    const SHORT: usize = 6;
    let lines: Vec<&str> = report
        .trim_end()
        .lines()
        .filter(|line| !line.ends_with(": nothing repaired"))
        .collect();
    let shown = if all {
        lines.len()
    } else {
        lines.len().min(SHORT)
    };
    let mut text = lines[..shown].join("\n");
    if shown < lines.len() {
        let more = lines.len() - shown;
        text += &format!("\n... and {more} more repaired objects; list all with --report");
    }
    text
}

/// The scene's name with `.pvs`, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    let name = scene.file_name().unwrap_or_default();
    let name = Path::new(name);
    let name = if name
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gz"))
    {
        Path::new(name.file_stem().unwrap_or_default())
    } else {
        name
    };
    name.with_extension("pvs")
}

/// Understands `--cells`; boxes are read from their file, and the box around them is known then.
fn cells(text: &str) -> Result<(CellSpec, Option<crate::load::SceneBox>), Failure> {
    if let Some(file) = text.strip_prefix("boxes:") {
        let boxes = cells_file::read(Path::new(file))?;
        let hull = cells_file::hull(&boxes);
        return Ok((CellSpec::Boxes(boxes), hull));
    }
    let spec = text.parse::<CellSpec>();
    spec.map(|spec| (spec, None))
        .map_err(|e| Failure::Usage(format!("--cells {text}: {e}")))
}

/// A bake to be done.
pub(crate) struct Job<'a> {
    pub scene: &'a Scene,
    pub cells: &'a [ViewCell],
    pub recipe: &'a Recipe,
    pub proofs: bool,
    pub resume: bool,
    pub path: &'a Path,
}

/// What a finished bake amounts to.
pub(crate) struct Baked {
    pub totals: Totals,
    pub finished: Finished,
    /// Building what the cells share.
    pub prepare_time: Duration,
    pub bake_time: Duration,
    pub write_time: Duration,
}

/// Bakes all cells in parallel and writes the files. Ctrl-C keeps what is finished.
pub(crate) fn bake(job: &Job<'_>, output: Output) -> Result<Baked, Failure> {
    if job.cells.is_empty() {
        return Err(Failure::Content(
            "there is no view cell to bake; choose other cells with --cells".to_owned(),
        ));
    }
    let cancel = on_interrupt()?;
    let start = Instant::now();
    let header = header(job.scene, job.cells, job.recipe, job.proofs);
    let (writer, done) = if job.resume {
        PvsWriter::resume(job.path, header).map_err(|e| pvs_failure(&e))?
    } else {
        (
            PvsWriter::create(job.path, header).map_err(|e| pvs_failure(&e))?,
            Default::default(),
        )
    };
    let mut write_time = start.elapsed();

    let start = Instant::now();
    let baker = Baker::new(job.scene);
    let prepare_time = start.elapsed();

    let start = Instant::now();
    let bar = output.progress(job.cells.len() as u64, "cells");
    bar.inc(done.len() as u64);
    let options = BakeOptions {
        ignore_below: job.recipe.ignore_below,
        seed: job.recipe.seed,
        proofs: job.proofs,
        cancel: Some(Arc::clone(&cancel)),
        max_splits: job.recipe.max_splits,
    };
    let left: Vec<u32> = (0..job.cells.len() as u32)
        .filter(|i| !done.contains(i))
        .collect();
    let one = |index: &u32| -> Result<(), PvsError> {
        if cancel.load(Ordering::SeqCst) {
            return Ok(());
        }
        let result = baker.bake_cell(&job.cells[*index as usize], &options);
        // A cell that was interrupted is not finished: it is baked anew next time.
        if cancel.load(Ordering::SeqCst) {
            return Ok(());
        }
        writer.push_cell(*index, &record(&result), &result.proof)?;
        bar.inc(1);
        Ok(())
    };
    let outcome = left.par_iter().with_max_len(1).try_for_each(one);
    let finished_cells = bar.position();
    bar.finish_and_clear();
    let bake_time = start.elapsed();
    outcome.map_err(|e| pvs_failure(&e))?;
    if cancelled_before(&cancel, finished_cells, job.cells.len()) {
        return Err(Failure::Stopped(format!(
            "stopped after {finished_cells} of {} cells, which are saved in {}; go on with --resume",
            job.cells.len(),
            PvsWriter::journal_path(job.path).display()
        )));
    }

    let start = Instant::now();
    let finished = writer.finish().map_err(|e| pvs_failure(&e))?;
    write_time += start.elapsed();
    let totals = totals(&open(job.path)?)?;
    Ok(Baked {
        totals,
        finished,
        prepare_time,
        bake_time,
        write_time,
    })
}

fn cancelled_before(cancel: &AtomicBool, finished: u64, cells: usize) -> bool {
    cancel.load(Ordering::SeqCst) && finished < cells as u64
}
