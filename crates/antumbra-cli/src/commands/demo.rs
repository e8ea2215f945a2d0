//! `antumbra demo`: the main job on a small office that is built in.

use std::path::PathBuf;
use std::time::Instant;

use antumbra_scene::synth::floor;
use antumbra_scene::{CellSpec, NamedBox, make_cells};
use clap::Args;
use serde_json::json;

use super::bake::{Job, bake};
use super::pvs::check::{check, open_proofs};
use super::pvs::render::{subject, write_view};
use super::pvs::{accuracy_name, cell, open};
use crate::cells_file::hull;
use crate::cli::Global;
use crate::failure::Failure;
use crate::load::{ReadingArgs, build};
use crate::output::{seconds, write_file};
use crate::picture::{PerspectiveOptions, plan};
use crate::recipe::Recipe;

/// Options of `demo`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra demo && open antumbra-demo/view.png")]
pub(crate) struct DemoArgs {
    /// The folder to write into
    #[arg(long, short, value_name = "FOLDER", default_value = "antumbra-demo")]
    output: PathBuf,
}

/// The cell that is drawn: a part of the corridor.
const SHOWN: &str = "corridor-1";

/// Bakes, checks, draws, and says where everything is.
pub(crate) fn run(args: &DemoArgs, global: &Global) -> Result<(), Failure> {
    let output = global.output();
    let folder = &args.output;
    std::fs::create_dir_all(folder).map_err(|cause| Failure::unwritable(folder, &cause))?;
    let paths = ["demo.pvs", "demo.proof", "top.svg", "view.png"].map(|name| folder.join(name));
    let [pvs, proof, top, view] = &paths;

    let start = Instant::now();
    let plan_of_floor = floor(1);
    let boxes: Vec<NamedBox> = plan_of_floor
        .places
        .iter()
        .map(|(name, min, max)| NamedBox {
            name: name.clone(),
            min: *min,
            max: *max,
        })
        .collect();
    let reading = ReadingArgs::default();
    let cells_box = hull(&boxes);
    let (scene, _) = build(plan_of_floor.scene, &reading, global.grid, cells_box)?;
    let build_time = start.elapsed();
    let cells =
        make_cells(&scene, &CellSpec::Boxes(boxes)).map_err(|e| Failure::Content(e.to_string()))?;
    let recipe = Recipe {
        cells: "boxes".to_owned(),
        cells_box,
        grid: global.grid,
        ignore_below: None,
        max_splits: None,
        reading,
        seed: global.seed,
    };
    let job = Job {
        scene: &scene,
        cells: &cells,
        recipe: &recipe,
        proofs: true,
        resume: false,
        path: pvs,
    };
    let baked = bake(&job, output)?;

    let file = open(pvs)?;
    let proofs = open_proofs(pvs, &file)?;
    let checked = check(&file, &proofs, &scene, output)?;
    let failed = checked.report.failed.len();

    let (index, shown) = cell(&file, SHOWN)?;
    let subject = subject(&file, index, &shown, &scene)?;
    write_file(top, plan(&subject).as_bytes())?;
    write_view(&subject, &PerspectiveOptions::default(), view)?;

    let accuracy = accuracy_name(baked.totals.accuracy);
    let name = |p: &PathBuf| p.display().to_string();
    let result = json!({
        "cells": cells.len(),
        "objects": scene.objects().len(),
        "polygons": scene.polygon_count(),
        "unknown": baked.totals.unknown,
        "visible_mean": baked.totals.visible_mean,
        "accuracy": accuracy,
        "grid": scene.grid().step(),
        "seconds": seconds(baked.bake_time),
        "load_seconds": 0.0,
        "build_seconds": seconds(build_time + baked.prepare_time),
        "write_seconds": seconds(baked.write_time),
        "check_seconds": seconds(checked.time),
        "visible_checked": checked.report.visible_checked,
        "hidden_checked": checked.report.hidden_checked,
        "failed": failed,
        "pvs": name(pvs),
        "proof": name(proof),
        "top": name(top),
        "view": name(view),
    });
    let text = format!(
        "An office floor of {} objects ({} polygons), seen from {} places where people stand:\n\
         baked in {:.2} s; a place may see {:.1} objects on average ({accuracy}, {} unknown).\n\
         Checked in {:.2} s: {} visible and {} hidden pairs of place and object, {failed} failed.\n\
         \n\
         {:<28} what the place '{SHOWN}' sees, from above\n\
         {:<28} the same in perspective\n\
         {:<28} the potentially visible sets: antumbra pvs query {} --at 10,0,1.6\n\
         {:<28} their certificates",
        scene.objects().len(),
        scene.polygon_count(),
        cells.len(),
        baked.bake_time.as_secs_f64(),
        baked.totals.visible_mean,
        baked.totals.unknown,
        checked.time.as_secs_f64(),
        checked.report.visible_checked,
        checked.report.hidden_checked,
        name(top),
        name(view),
        name(pvs),
        name(pvs),
        name(proof),
    );
    output.result(&result, &text)?;
    if failed > 0 {
        return Err(Failure::Content(format!(
            "{failed} certificates of the demo do not hold; please report this as a fault of the program"
        )));
    }
    Ok(())
}
