//! `antumbra pvs render`: a picture of what a cell sees.

use std::path::{Path, PathBuf};

use antumbra_io::PvsFile;
use antumbra_io::pvs::{CellIndex, PvsCell, PvsCellKind};
use antumbra_scene::Scene;
use clap::Args;
use serde_json::json;

use super::check::scene_of;
use super::{accuracy_name, cell, open, pvs_failure};
use crate::cli::Global;
use crate::failure::Failure;
use crate::output::{check_writable, write_file};
use crate::picture::{Face, PerspectiveOptions, Shown, Subject, perspective, plan, png};
use crate::values::pixels;

/// Options of `pvs render`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RenderArgs {
    /// The .pvs file
    file: PathBuf,
    /// The scene it was baked from
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,
    /// The cell: its number or name
    #[arg(long, value_name = "N")]
    cell: String,
    /// The picture to write: .png (a view) or .svg (a plan)
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Size of a .png
    #[arg(long, value_name = "WxH", default_value = "1600x1000", value_parser = pixels)]
    size: [usize; 2],
    /// Where the camera of a .png stands: degrees counter-clockwise from +x
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    azimuth: Option<f64>,
    /// How high the camera of a .png stands: degrees above the horizon
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    elevation: Option<f64>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra pvs render house.pvs --scene house.glb --cell 3 -o cell3.png
  antumbra pvs render house.pvs --scene house.glb --cell hall -o hall.svg";

/// Draws and writes.
pub(crate) fn run(args: &RenderArgs, global: &Global) -> Result<(), Failure> {
    let extension = args
        .output
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    let kind = extension.unwrap_or_default();
    if kind != "png" && kind != "svg" {
        return Err(Failure::Usage(format!(
            "{}: pictures are written as .png or .svg; change the file's extension",
            args.output.display()
        )));
    }
    check_writable(&args.output, &[&args.file, &args.scene])?;
    let file = open(&args.file)?;
    let (index, cell) = cell(&file, &args.cell)?;
    let scene = scene_of(&file, &args.scene)?;
    let subject = subject(&file, index, &cell, &scene)?;
    if kind == "svg" {
        write_file(&args.output, plan(&subject).as_bytes())?;
    } else {
        let options = PerspectiveOptions {
            size: args.size,
            azimuth: args.azimuth.filter(|a| a.is_finite()),
            elevation: args.elevation.filter(|a| a.is_finite()),
        };
        write_view(&subject, &options, &args.output)?;
    }
    let visible = subject
        .shown
        .iter()
        .filter(|s| **s == Shown::Visible)
        .count();
    let result = json!({
        "cell": index.0,
        "name": cell.name,
        "visible": visible,
        "output": args.output.display().to_string(),
    });
    let text = format!("{}: {}", args.output.display(), subject.caption);
    global.output().result(&result, &text)
}

/// Renders the perspective view into a file.
pub(crate) fn write_view(
    subject: &Subject,
    options: &PerspectiveOptions,
    path: &Path,
) -> Result<(), Failure> {
    let pixels = perspective(subject, options);
    let bytes = png(options.size, &pixels).map_err(|cause| {
        Failure::Content(format!(
            "{}: the picture cannot be encoded ({cause})",
            path.display()
        ))
    })?;
    write_file(path, &bytes)
}

/// What there is to draw for a cell.
pub(crate) fn subject(
    file: &PvsFile,
    index: CellIndex,
    cell: &PvsCell,
    scene: &Scene,
) -> Result<Subject, Failure> {
    let visible = file.visible(index).map_err(|e| pvs_failure(&e))?;
    let grid = scene.grid();
    let faces = scene.polygons().map(|polygon| Face {
        corners: polygon.corners.iter().map(|p| grid.to_scene(*p)).collect(),
        object: polygon.object.0,
        clear: !polygon.occludes,
    });
    let shown = (0..scene.objects().len() as u32).map(|id| {
        if cell.kind == PvsCellKind::Object(id) {
            Shown::Source
        } else if visible.contains(id) {
            Shown::Visible
        } else {
            Shown::Hidden
        }
    });
    let accuracy = file.accuracy(index).map(accuracy_name).unwrap_or_default();
    Ok(Subject {
        faces: faces.collect(),
        shown: shown.collect(),
        cell: [
            grid.to_scene(cell.bounds.min),
            grid.to_scene(cell.bounds.max),
        ],
        caption: format!(
            "Cell {} ({}) may see {} of {} objects ({accuracy})",
            index.0,
            cell.name,
            visible.len(),
            scene.objects().len()
        ),
    })
}
