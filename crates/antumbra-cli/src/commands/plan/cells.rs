//! View cells from the command line and from files.

use std::path::Path;
use std::str::FromStr;

use antumbra::plan::{Plan, PlanCell};
use antumbra_io::plan::{Projection, parse_cells};

use crate::failure::Failure;

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
}

impl NamedCell {
    /// The cell of the command line, in the coordinates of the plan's file: degrees if that was projected.
    pub(super) fn given(outline: &OutlineArg, around: Option<[f64; 2]>) -> Self {
        let mut outline = outline.0.clone();
        if let Some(projection) = around.map(Projection::around) {
            outline.iter_mut().for_each(|p| *p = projection.apply(*p));
        }
        Self {
            id: "0".to_owned(),
            outline,
        }
    }

    /// Puts the cell on the grid of a plan; `file` is where it comes from.
    pub(super) fn make(&self, plan: &Plan, file: Option<&Path>) -> Result<PlanCell, Failure> {
        PlanCell::new(plan, &self.outline).map_err(|e| match file {
            Some(path) => Failure::Content(format!("{}: cell {}: {e}", path.display(), self.id)),
            None => Failure::Usage(e.to_string()),
        })
    }
}

/// Reads cells from a GeoJSON file.
pub(super) fn read(path: &Path, around: Option<[f64; 2]>) -> Result<Vec<NamedCell>, Failure> {
    let text = std::fs::read(path).map_err(|cause| Failure::unreadable(path, &cause))?;
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
    let named = |c: antumbra_io::plan::CellInput| NamedCell {
        id: c.id,
        outline: c.outline,
    };
    Ok(cells.into_iter().map(named).collect())
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
