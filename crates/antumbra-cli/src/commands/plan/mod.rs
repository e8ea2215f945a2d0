//! `antumbra plan`: what cells of the plane see of a plan.

mod cells;
mod picture;
mod report;

use std::path::PathBuf;
use std::time::Instant;

use antumbra::plan::{
    BoxTest, Isovist, Plan, PlanCell, PlanOptions, SeeOptions, Seen, SweepOrder, isovist, mutual,
    mutual_matrix, see_all,
};
use antumbra_io::plan::{Crs, PlanReadOptions, read_plan};
use antumbra_scene::OccluderPolicy;
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::cli::Global;
use crate::failure::Failure;
use crate::load::read_failure;
use crate::output::{check_writable, seconds, write_file};
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
    #[arg(required_unless_present = "cells", conflicts_with = "cells")]
    cell: Option<OutlineArg>,
    /// View cells from GeoJSON: a polygon, a line of two points or a point a feature
    #[arg(long, value_name = "FILE")]
    cells: Option<PathBuf>,
    /// Another cell: does the first one see it?
    #[arg(
        long,
        value_name = "\"X,Y X,Y ...\"",
        allow_hyphen_values = true,
        requires = "cell"
    )]
    to: Option<OutlineArg>,
    /// Which cells see which, instead of what they see
    #[arg(long, requires = "cells")]
    matrix: bool,
    /// Nothing farther from the cell than this, in units of the plan
    #[arg(long, value_name = "DISTANCE", value_parser = positive)]
    reach: Option<f64>,
    /// Add a line for each fragment that sees it, as exact coefficients in grid steps
    #[arg(long)]
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
    #[arg(long)]
    second_pass: bool,
    /// The visible area of each cell: polygon, area, perimeter and depth; drawn with --svg
    #[arg(long, conflicts_with_all = ["matrix", "to"])]
    isovist: bool,
    /// Check every verdict by code that shares nothing with the engine
    #[arg(long, conflicts_with_all = ["matrix", "reach", "to"])]
    check: bool,
    /// Draw the plan, the cell, the visible fragments, extremal lines and culled kD nodes as SVG
    #[arg(long, value_name = "FILE", conflicts_with = "matrix")]
    svg: Option<PathBuf>,
    /// Draw the blocked sets of lines, as polygons of line space, as SVG
    #[arg(long, value_name = "FILE", conflicts_with = "matrix")]
    line_space: Option<PathBuf>,
    /// Write the visible fragments as GeoJSON
    #[arg(long, value_name = "FILE", conflicts_with = "matrix")]
    geojson: Option<PathBuf>,
    /// Write the funnels as JSON: which fragment is seen from which part of the cell
    #[arg(short, long, value_name = "FILE", conflicts_with = "matrix")]
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

    fn outputs(&self) -> [Option<&PathBuf>; 4] {
        [
            self.svg.as_ref(),
            self.line_space.as_ref(),
            self.geojson.as_ref(),
            self.output.as_ref(),
        ]
    }
}

/// Reads, looks, writes.
pub(crate) fn run(args: &PlanArgs, global: &Global) -> Result<(), Failure> {
    let mut inputs = vec![args.plan.as_path()];
    inputs.extend(args.cells.as_deref());
    for path in args.outputs().into_iter().flatten() {
        check_writable(path, &inputs)?;
    }
    let start = Instant::now();
    let input = read_plan(&args.plan, &args.reading()).map_err(|e| read_failure(&e))?;
    let outlines = match (&args.cell, &args.cells) {
        (Some(outline), _) => vec![NamedCell::given(outline, input.projected_around)],
        (None, Some(path)) => cells::read(path, input.projected_around)?,
        (None, None) => Vec::new(),
    };
    let to = args.to.as_ref();
    let to = to.map(|outline| NamedCell::given(outline, input.projected_around));
    let load_time = start.elapsed();
    let start = Instant::now();
    let around = cells::around(outlines.iter().chain(&to));
    let options = PlanOptions {
        grid: global.grid,
        around,
        policy: args.policy(),
        ..PlanOptions::default()
    };
    let plan = Plan::build(&input, &options)
        .map_err(|e| Failure::Content(format!("{}: {e}", args.plan.display())))?;
    let made = outlines
        .iter()
        .map(|c| c.make(&plan, args.cells.as_deref()))
        .collect::<Result<Vec<PlanCell>, Failure>>()?;
    let build_time = start.elapsed();
    for note in &input.notes {
        global.output().note(&format!("note: {note}"));
    }
    note_repairs(&plan, global);
    let start = Instant::now();
    let mut result = Map::new();
    let text = if args.matrix {
        matrix(&plan, &outlines, &made, &mut result)
    } else if let Some(to) = &to {
        let to = to.make(&plan, None)?;
        report::sight(mutual(&plan, &made[0], &to), &mut result)
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
        if args.check {
            report::check(&plan, &seen, &mut result)?;
        }
        report::seen(args, &plan, &outlines, (&seen, &areas), &mut result)
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
    global.output().result(&Value::Object(result), &text)
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
    format!(
        "{pairs} of {} pairs of cells see each other",
        n * n.saturating_sub(1) / 2
    )
}

fn write(
    args: &PlanArgs,
    plan: &Plan,
    input: &antumbra::plan::PlanInput,
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
        global.output().note(&format!(
            "note: {points} segments have no length on the grid: they block nothing and are seen only by cells they lie in"
        ));
    }
    if report.shared > 0 {
        global.output().note(&format!(
            "note: {} pieces belong to more than one segment: all of them are reported",
            report.shared
        ));
    }
    if report.sealed > 0 {
        global.output().note(&format!(
            "note: {} corners within a grid step of a foreign segment were put into it",
            report.sealed
        ));
    }
}
