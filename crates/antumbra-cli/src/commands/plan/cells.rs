//! View cells from the command line and from files.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use antumbra::plan::{Plan, PlanCell, PlanInput};
use antumbra_io::plan::{Projection, parse_cells};
use antumbra_io::read_unpacked;

use crate::failure::Failure;
use crate::load::read_failure;
use crate::output::counted;

/// An outline on the command line: `x,y x,y ...`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OutlineArg(pub Vec<[f64; 2]>);

impl FromStr for OutlineArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected points like \"1,2 5,2 5,4.5\"".to_owned();
        let point = |word: &str| -> Option<[f64; 2]> {
            let (x, y) = word.split_once(',')?;
            let number = |s: &str| s.parse::<f64>().ok().filter(|v| v.is_finite());
            Some([number(x)?, number(y)?])
        };
        let points: Option<Vec<_>> = text.split_whitespace().map(point).collect();
        points.filter(|p| !p.is_empty()).map(Self).ok_or_else(wrong)
    }
}

/// A cell by name.
#[derive(Clone, Debug)]
pub(super) struct NamedCell {
    /// The `id` of its feature, or its number.
    pub id: String,
    /// Its outline in scene units.
    pub outline: Vec<[f64; 2]>,
    place: CellPlace,
}

/// Where a cell was given, for messages.
#[derive(Clone, Debug)]
enum CellPlace {
    Option(&'static str),
    /// A file and the number of a feature.
    Feature(String, usize),
}

impl fmt::Display for CellPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Option(name) => f.write_str(name),
            Self::Feature(file, number) => write!(f, "{file}: feature {number}"),
        }
    }
}

impl NamedCell {
    /// A cell of the command line, in the coordinates of the plan's file: degrees if that was projected.
    pub(super) fn given(
        outline: &OutlineArg,
        option: &'static str,
        around: Option<[f64; 2]>,
    ) -> Self {
        let mut outline = outline.0.clone();
        if let Some(projection) = around.map(Projection::around) {
            outline.iter_mut().for_each(|p| *p = projection.apply(*p));
        }
        Self {
            id: "0".to_owned(),
            outline,
            place: CellPlace::Option(option),
        }
    }

    /// Puts the cell on the grid of a plan.
    pub(super) fn make(&self, plan: &Plan) -> Result<PlanCell, Failure> {
        PlanCell::new(plan, &self.outline).map_err(|e| {
            let text = format!("{}: {e}", self.place);
            match self.place {
                CellPlace::Option(_) => Failure::Usage(text),
                CellPlace::Feature(..) => Failure::Content(text),
            }
        })
    }
}

/// Reads cells from a GeoJSON file.
pub(super) fn read(path: &Path, around: Option<[f64; 2]>) -> Result<Vec<NamedCell>, Failure> {
    let text = read_unpacked(path).map_err(|error| read_failure(&error))?;
    let content =
        |what: &dyn std::fmt::Display| Failure::Content(format!("{}: {what}", path.display()));
    let text = String::from_utf8(text)
        .map_err(|_| content(&"this is not text; give GeoJSON with a cell a feature"))?;
    let cells = parse_cells(&text, around).map_err(|damage| content(&damage))?;
    if cells.is_empty() {
        return Err(content(
            &"there are no cells in it; give a polygon a feature",
        ));
    }
    let file = path.display().to_string();
    let named = |(number, c): (usize, antumbra_io::plan::CellInput)| NamedCell {
        id: c.id,
        outline: c.outline,
        place: CellPlace::Feature(file.clone(), number),
    };
    Ok(cells.into_iter().enumerate().map(named).collect())
}

/// The box around all cells.
pub(super) fn around<'c>(
    cells: impl Iterator<Item = &'c NamedCell>,
) -> Option<([f64; 2], [f64; 2])> {
    let points = cells
        .flat_map(|c| &c.outline)
        .filter(|p| p.iter().all(|v| v.is_finite()));
    points.fold(None, |b, p| {
        let (low, high) = b.unwrap_or((*p, *p));
        Some((
            [0, 1].map(|k| low[k].min(p[k])),
            [0, 1].map(|k| high[k].max(p[k])),
        ))
    })
}

/// Refuses cells so far from a plan that segments with a length on the plan's own grid have none on the grid that
/// holds the cells, too.
pub(super) fn refuse_far<'c>(
    input: &PlanInput,
    plan: &Plan,
    cells: impl Iterator<Item = &'c NamedCell>,
) -> Result<(), Failure> {
    let lost = plan.lost_to_cells(input);
    if lost == 0 {
        return Ok(());
    }
    let far = cells.map(|cell| (distance(input, cell), cell));
    let Some((distance, cell)) = far.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Ok(());
    };
    let step = plan.grid().step();
    Err(Failure::Content(format!(
        "{}: the cell is {} from the plan, too far for the grid: {} would lose {} length in its step of {step:?}; \
         give a cell nearer by, or choose that grid with --grid",
        cell.place,
        if distance < 1e7 {
            format!("{distance:.1}")
        } else {
            format!("{distance:.1e}")
        },
        counted(lost, "segment", "segments"),
        if lost == 1 { "its" } else { "their" },
    )))
}

/// How far a cell goes from the box around a plan.
fn distance(input: &PlanInput, cell: &NamedCell) -> f64 {
    let ends = || input.segments.iter().flat_map(|s| s.ends);
    let low = [0, 1].map(|k| ends().fold(f64::INFINITY, |m, p| m.min(p[k])));
    let high = [0, 1].map(|k| ends().fold(f64::NEG_INFINITY, |m, p| m.max(p[k])));
    let gap = |p: &[f64; 2], k: usize| (low[k] - p[k]).max(p[k] - high[k]).max(0.0);
    let corners = cell.outline.iter().map(|p| gap(p, 0).hypot(gap(p, 1)));
    corners.fold(0.0, f64::max)
}
