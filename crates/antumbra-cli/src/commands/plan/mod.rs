//! `antumbra plan`: what cells of the plane see of a plan.

mod cells;
mod picture;
mod report;

use std::path::PathBuf;
use std::time::Instant;

use antumbra::plan::{
    BoxTest, Isovist, Plan, PlanCell, PlanInput, PlanOptions, SeeOptions, Seen, SweepOrder,
    isovist, mutual, mutual_matrix, see_all,
};
use antumbra_io::plan::{Crs, PlanReadOptions, read_plan};
use antumbra_scene::OccluderPolicy;
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::classes::check_classes;
use crate::cli::Global;
use crate::failure::Failure;
use crate::load::read_failure;
use crate::output::{check_outputs, counted, seconds, write_file};
use crate::values::positive;
use cells::{NamedCell, OutlineArg};

/// Options of `plan`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct PlanArgs {
    /// The plan: GeoJSON, SVG, DXF or lines of `x1 y1 x2 y2`, also gzip'd
    plan: PathBuf,
    /// The view cell: corners of a polygon, two ends of a segment, or one point, in the coordinates of the plan
    #[arg(long, value_name = "\"X,Y X,Y ...\"", allow_hyphen_values = true)]
    #[arg(conflicts_with = "cells")]
    cell: Option<OutlineArg>,
    /// View cells from GeoJSON, also gzip'd: a polygon, a line of two points or a point a feature
    #[arg(long, value_name = "FILE")]
    cells: Option<PathBuf>,
    /// Another cell: does the cell, or which of the cells, see it?
    #[arg(long, value_name = "\"X,Y X,Y ...\"", allow_hyphen_values = true)]
    #[arg(conflicts_with = "matrix")]
    to: Option<OutlineArg>,
    /// Which of the cells of --cells see which, instead of what they see
    #[arg(long)]
    matrix: bool,
    /// Leave out segments that are as a whole farther from the cell than this, in units of the plan
    ///
    /// A segment that comes within the distance is reported with all that is seen of it, also beyond. The distance is
    /// that to the box around the cell (around each convex part of one that is not convex), rounded up to a
    /// grid step; where corners of other segments lie on a segment, each piece between them counts by itself. What is
    /// seen within the distance is exact. Segments left out hide nothing: beyond the distance, more of a
    /// reported segment may be called visible than is, and then the accuracy is "conservative".
    #[arg(long, value_name = "DISTANCE", value_parser = positive)]
    #[arg(conflicts_with_all = ["matrix", "to"])]
    reach: Option<f64>,
    /// Add a line for each fragment that sees it, as exact coefficients in grid steps
    #[arg(long, conflicts_with_all = ["matrix", "to"])]
    witnesses: bool,
    /// Only these classes or layers block the view
    #[arg(
        long,
        value_name = "A,B",
        value_delimiter = ',',
        conflicts_with = "transparent"
    )]
    occluders: Vec<String>,
    /// These classes or layers do not block the view
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    transparent: Vec<String>,
    /// The GeoJSON property that names the class (default: class, layer or type)
    #[arg(long, value_name = "NAME")]
    class_property: Option<String>,
    /// What the coordinates of GeoJSON are
    #[arg(long, value_enum, value_name = "CRS", default_value_t)]
    crs: CrsArg,
    /// The order of the sweep; no result depends on it
    #[arg(long, value_enum, value_name = "ORDER", default_value_t)]
    sweep: SweepArg,
    /// How kD nodes are tested; no result depends on it
    #[arg(long, value_enum, value_name = "TEST", default_value_t)]
    test: TestArg,
    /// One occlusion tree for all edges of a cell; no result depends on it
    #[arg(long)]
    one_tree: bool,
    /// Test the opened kD leaves again when all occluders are known, and list the visible kD nodes
    #[arg(long, conflicts_with_all = ["matrix", "to"])]
    second_pass: bool,
    /// The visible area of each cell, however far it goes: polygon, area, perimeter and depth; drawn with --svg
    #[arg(long, conflicts_with_all = ["matrix", "reach", "to"])]
    isovist: bool,
    /// Check every verdict by code that shares nothing with the engine
    #[arg(long, conflicts_with_all = ["matrix", "reach", "to"])]
    check: bool,
    /// Draw the plan, the cells, the visible fragments, extremal lines and the kD nodes culled for all cells as SVG
    #[arg(long, value_name = "FILE", conflicts_with_all = ["matrix", "to"])]
    svg: Option<PathBuf>,
    /// Draw the blocked sets of lines of a single cell, as polygons of line space, as SVG
    #[arg(long, value_name = "FILE", conflicts_with_all = ["matrix", "to"])]
    line_space: Option<PathBuf>,
    /// Write the visible fragments as GeoJSON, in the coordinates and with the `crs` of the plan
    #[arg(long, value_name = "FILE", conflicts_with_all = ["matrix", "to"])]
    geojson: Option<PathBuf>,
    /// Write the funnels as JSON: which fragment is seen from which part of the cell
    #[arg(short, long, value_name = "FILE", conflicts_with_all = ["matrix", "to"])]
    output: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  antumbra plan office.seg --cell \"4,3 8,3 8,6 4,6\" --json
  antumbra plan office.dxf --cell \"4,3\" --transparent glass --svg office.svg
  antumbra plan city.geojson.gz --cells streets.geojson --json
  antumbra plan office.geojson --cells rooms.geojson --matrix --json

Segments are numbered as the file lists them; fragments run from 0 to 1 along a segment. A
segment that meets the cell is visible as a whole.";

/// What the coordinates of GeoJSON are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum CrsArg {
    /// What the file says
    #[default]
    File,
    /// Lengths
    Planar,
    /// Degrees of longitude and latitude
    Lonlat,
}

/// The order of the sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum SweepArg {
    /// Nearest kD node first
    #[default]
    Priority,
    /// Depth first, nearer child first
    DepthFirst,
}

/// How kD nodes are tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum TestArg {
    /// Exactly, by the sides of their boxes
    #[default]
    Exact,
    /// By tangents, without splitting
    Conservative,
    /// Not at all
    None,
}

impl PlanArgs {
    fn reading(&self) -> PlanReadOptions {
        PlanReadOptions {
            crs: match self.crs {
                CrsArg::File => Crs::FromFile,
                CrsArg::Planar => Crs::Planar,
                CrsArg::Lonlat => Crs::LonLat,
            },
            class_property: self.class_property.clone(),
        }
    }

    fn policy(&self) -> OccluderPolicy {
        if !self.occluders.is_empty() {
            OccluderPolicy::Only(self.occluders.clone())
        } else if !self.transparent.is_empty() {
            OccluderPolicy::Except(self.transparent.clone())
        } else {
            OccluderPolicy::Default
        }
    }

    fn options(&self, step: f64) -> SeeOptions {
        SeeOptions {
            order: match self.sweep {
                SweepArg::Priority => SweepOrder::Priority,
                SweepArg::DepthFirst => SweepOrder::DepthFirst,
            },
            test: match self.test {
                TestArg::Exact => BoxTest::Exact,
                TestArg::Conservative => BoxTest::Conservative,
                TestArg::None => BoxTest::Never,
            },
            one_tree: self.one_tree,
            reach: self.reach.map(|r| (r / step).ceil() as u64),
            second_pass: self.second_pass,
            funnels: self.svg.is_some() || self.line_space.is_some() || self.output.is_some(),
            proof: self.check,
            growth: false,
        }
    }

    fn outputs(&self) -> [(Option<&PathBuf>, &'static [&'static str]); 4] {
        [
            (self.svg.as_ref(), &["svg"]),
            (self.line_space.as_ref(), &["svg"]),
            (self.geojson.as_ref(), &["geojson", "json"]),
            (self.output.as_ref(), &["json"]),
        ]
    }

    /// What is wrong with the options together.
    fn misuse(&self) -> Option<&'static str> {
        if self.matrix && self.cells.is_none() {
            return Some(
                "--matrix compares the cells of a file with each other; give them with --cells FILE",
            );
        }
        (self.cell.is_none() && self.cells.is_none()).then_some(
            "the view cell is missing; give one with --cell \"X,Y X,Y ...\" or a file of them with --cells FILE",
        )
    }

    /// The view cells, in lengths.
    fn outlines(&self, input: &PlanInput) -> Result<Vec<NamedCell>, Failure> {
        let around = input.projected_around;
        let outlines = match (&self.cell, &self.cells) {
            (Some(outline), _) => vec![NamedCell::given(outline, "--cell", around)],
            (None, Some(path)) => cells::read(path, around)?,
            (None, None) => Vec::new(),
        };
        let n = outlines.len();
        if self.line_space.is_some() && n > 1 {
            return Err(Failure::Usage(format!(
                "--line-space measures lines from the middle of one cell, but there are {n}; give the one to draw with --cell"
            )));
        }
        Ok(outlines)
    }
}

/// Reads, looks, writes.
pub(crate) fn run(args: &PlanArgs, global: &Global) -> Result<(), Failure> {
    if let Some(misuse) = args.misuse() {
        return Err(Failure::Usage(misuse.to_owned()));
    }
    let mut inputs = vec![args.plan.as_path()];
    inputs.extend(args.cells.as_deref());
    check_outputs(&args.outputs(), &inputs)?;
    let start = Instant::now();
    let input = read_plan(&args.plan, &args.reading()).map_err(|e| read_failure(&e))?;
    let output = global.output();
    check_classes(&args.occluders, &args.transparent, &input.classes, output)?;
    let outlines = args.outlines(&input)?;
    let to = args.to.as_ref();
    let to = to.map(|outline| NamedCell::given(outline, "--to", input.projected_around));
    let load_time = start.elapsed();
    let start = Instant::now();
    let plan = build(args, global, &input, || outlines.iter().chain(&to))?;
    let made = outlines
        .iter()
        .map(|c| c.make(&plan))
        .collect::<Result<Vec<PlanCell>, Failure>>()?;
    let build_time = start.elapsed();
    for note in &input.notes {
        global.output().note(&format!("note: {note}"));
    }
    note_repairs(&plan, global);
    let start = Instant::now();
    let mut result = Map::new();
    let mut failed = None;
    let text = if args.matrix {
        matrix(&plan, &outlines, &made, &mut result)
    } else if let Some(to) = &to {
        let to = to.make(&plan)?;
        let sights: Vec<_> = made.par_iter().map(|c| mutual(&plan, c, &to)).collect();
        report::sights(args.cells.is_some(), &outlines, &sights, &mut result)
    } else {
        let seen = see_all(&plan, &made, &args.options(plan.grid().step()));
        let areas: Vec<Isovist> = if args.isovist {
            made.par_iter().map(|cell| isovist(&plan, cell)).collect()
        } else {
            Vec::new()
        };
        result.insert("seconds".to_owned(), json!(seconds(start.elapsed())));
        let start = Instant::now();
        write(args, &plan, &input, &outlines, (&seen, &areas))?;
        result.insert("write_seconds".to_owned(), json!(seconds(start.elapsed())));
        let mut text = report::seen(args, &plan, &outlines, (&seen, &areas), &mut result);
        text += &report::asked(args, &seen, &areas);
        if args.check {
            let checked = report::check(&plan, &seen, &mut result);
            text += &checked.text;
            failed = checked.failure;
        }
        text
    };
    let mut add = |key: &str, value: Value| {
        result.entry(key).or_insert(value);
    };
    add("seconds", json!(seconds(start.elapsed())));
    add("segments", json!(plan.segment_count()));
    add("grid", json!(plan.grid().step()));
    if let Some(middle) = input.projected_around {
        add("projected_around", json!(middle));
    }
    add("load_seconds", json!(seconds(load_time)));
    add("build_seconds", json!(seconds(build_time)));
    let took = result["seconds"].as_f64().unwrap_or_default() * 1e3;
    let text = format!("{text}, in {took:.1} ms");
    global.output().result(&Value::Object(result), &text)?;
    failed.map_or(Ok(()), Err)
}

/// Puts the plan on a grid that holds the cells, too.
fn build<'c, I: Iterator<Item = &'c NamedCell>>(
    args: &PlanArgs,
    global: &Global,
    input: &PlanInput,
    outlines: impl Fn() -> I,
) -> Result<Plan, Failure> {
    let options = PlanOptions {
        grid: global.grid,
        around: cells::around(outlines()),
        policy: args.policy(),
        ..PlanOptions::default()
    };
    let plan = Plan::build(input, &options)
        .map_err(|e| Failure::Content(format!("{}: {e}", args.plan.display())))?;
    // Who chooses the grid chooses what is lost on it.
    if global.grid.is_none() {
        cells::refuse_far(input, &plan, outlines())?;
    }
    Ok(plan)
}

fn matrix(
    plan: &Plan,
    outlines: &[NamedCell],
    cells: &[PlanCell],
    result: &mut Map<String, Value>,
) -> String {
    let rows = mutual_matrix(plan, cells);
    let pairs: usize = rows.iter().flatten().filter(|&&seen| seen).count();
    let pairs = (pairs - cells.len()) / 2;
    let ids: Vec<&str> = outlines.iter().map(|c| c.id.as_str()).collect();
    result.insert("cells".to_owned(), json!(ids));
    result.insert("matrix".to_owned(), json!(rows));
    result.insert("pairs".to_owned(), json!(pairs));
    let n = cells.len();
    let all = counted(n * n.saturating_sub(1) / 2, "pair", "pairs");
    let see = if pairs == 1 { "sees" } else { "see" };
    format!("{pairs} of {all} of cells {see} each other")
}

fn write(
    args: &PlanArgs,
    plan: &Plan,
    input: &PlanInput,
    outlines: &[NamedCell],
    (seen, areas): (&[Seen], &[Isovist]),
) -> Result<(), Failure> {
    if let Some(path) = &args.geojson {
        let text = report::geojson(input, outlines, seen, areas).to_string();
        write_file(path, text.as_bytes())?;
    }
    if let Some(path) = &args.output {
        let text = report::funnels(plan, outlines, seen).to_string();
        write_file(path, text.as_bytes())?;
    }
    if let Some(path) = &args.svg {
        write_file(
            path,
            picture::plan(plan, seen, areas, input.y_down).as_bytes(),
        )?;
    }
    if let Some(path) = &args.line_space {
        write_file(path, picture::line_space(seen).as_bytes())?;
    }
    Ok(())
}

fn note_repairs(plan: &Plan, global: &Global) {
    let report = plan.report();
    let points = report.points.len();
    if points > 0 {
        let text = match points {
            1 => "1 segment has no length on the grid: it blocks nothing and is seen only by cells it lies in".to_owned(),
            n => format!(
                "{n} segments have no length on the grid: they block nothing and are seen only by cells they lie in"
            ),
        };
        global.output().note(&format!("note: {text}"));
    }
    if report.shared > 0 {
        let belong = if report.shared == 1 {
            "belongs"
        } else {
            "belong"
        };
        global.output().note(&format!(
            "note: {} {belong} to more than one segment: all of these are reported",
            counted(report.shared, "piece", "pieces")
        ));
    }
    if report.sealed > 0 {
        global.output().note(&format!(
            "note: {} within a grid step of a foreign segment {} put into it",
            counted(report.sealed, "corner", "corners"),
            if report.sealed == 1 { "was" } else { "were" }
        ));
    }
}
