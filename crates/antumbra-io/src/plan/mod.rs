//! Plans: segments of the plane from GeoJSON, SVG, DXF and plain text.
//!
//! Readers hand over segments in scene units, with the y of the file, in its order; nothing is snapped,
//! merged or left out, so that ids are what a reader of the file would count.

mod curve;
mod dxf;
mod geojson;
mod project;
mod svg;
mod text;
mod write;

use std::fs;
use std::path::Path;

use antumbra_scene::plan::{PlanInput, PlanSegment};

use crate::error::{Damage, Place, ReadError};
use crate::read::gunzip;

pub use geojson::{CellInput, parse_cells};
pub use project::{Crs, Projection};
pub use write::{write_geojson, write_seg};

/// What a plan file does not say by itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlanReadOptions {
    /// What the coordinates of GeoJSON are.
    pub crs: Crs,
    /// The property of GeoJSON features that names their class; `class`, `layer` or `type` if there is none.
    pub class_property: Option<String>,
}

/// The formats of plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PlanFormat {
    GeoJson,
    Svg,
    Dxf,
    Text,
}

/// Reads a plan, recognized by its content; gzip'd files are unpacked.
///
/// # Errors
/// If the path cannot be read or the content is damaged.
pub fn read_plan(path: &Path, options: &PlanReadOptions) -> Result<PlanInput, ReadError> {
    let file = path.display().to_string();
    let bytes = fs::read(path).map_err(|cause| ReadError::Path {
        file: file.clone(),
        cause,
    })?;
    parse_plan(&bytes, &file, options)
}

/// Reads a plan from bytes; `file` names it in messages.
///
/// ```
/// use antumbra_io::plan::{PlanReadOptions, parse_plan};
/// let text = b"# two walls\n0 0 4 0\n4 0 4 3\n";
/// let plan = parse_plan(text, "room.seg", &PlanReadOptions::default())?;
/// assert_eq!(plan.segments[1].ends, [[4.0, 0.0], [4.0, 3.0]]);
/// # Ok::<(), antumbra_io::ReadError>(())
/// ```
///
/// # Errors
/// If the content is damaged, or there is no segment in it.
pub fn parse_plan(
    bytes: &[u8],
    file: &str,
    options: &PlanReadOptions,
) -> Result<PlanInput, ReadError> {
    let read = || -> Result<PlanInput, Damage> {
        let unpacked = gunzip(bytes)?;
        let bytes = unpacked.as_deref().unwrap_or(bytes);
        let text = std::str::from_utf8(bytes).map_err(|e| {
            Damage::new(
                Place::Byte(e.valid_up_to() as u64),
                "this is not text",
                "give GeoJSON, SVG, text DXF or lines of `x1 y1 x2 y2`",
            )
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            return Err(Damage::new(
                Place::Whole,
                "the file is empty",
                "give a plan with lines or polygons",
            ));
        }
        let plan = match recognize(text, file) {
            PlanFormat::GeoJson => geojson::read(text, options)?,
            PlanFormat::Text => text::read(text)?,
            PlanFormat::Svg => svg::read(text)?,
            PlanFormat::Dxf => dxf::read(text)?,
        };
        if plan.segments.is_empty() {
            return Err(Damage::new(
                Place::Whole,
                "there are no segments in it",
                "give a plan with lines or polygons",
            ));
        }
        Ok(plan)
    };
    read().map_err(|damage| ReadError::Content {
        file: file.to_owned(),
        damage,
    })
}

/// The content decides; among formats without a mark, text is what remains.
fn recognize(text: &str, file: &str) -> PlanFormat {
    let start = text.trim_start();
    let name = file.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    if start.starts_with('{') || start.starts_with('[') {
        PlanFormat::GeoJson
    } else if start.starts_with('<') {
        PlanFormat::Svg
    } else if name.ends_with(".dxf") || looks_like_dxf(start) {
        PlanFormat::Dxf
    } else {
        PlanFormat::Text
    }
}

/// A group code on the first line, `SECTION` on the second, comments aside.
fn looks_like_dxf(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        match code {
            "999" => {}
            "0" => return value == "SECTION",
            _ => return false,
        }
    }
    false
}

/// Adds the segments between successive points.
fn push_line(plan: &mut PlanInput, points: &[[f64; 2]], class: u32, feature: u32) {
    plan.segments.extend(points.windows(2).map(|w| PlanSegment {
        ends: [w[0], w[1]],
        class,
        feature,
    }));
}
