//! A `.pvs` file as plain data for JSON, witnesses with exact fractions included.

use antumbra_kernel::Grid;
use dashu_int::IBig;
use dashu_int::ops::Gcd;
use serde::Serialize;

use crate::pvs::{Accuracy, PvsCellKind, PvsError, PvsFile, PvsProvenance, WitnessRecord};

/// Everything in a `.pvs` file, ready to be written as JSON. Coordinates are in scene units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Export {
    /// Where the file comes from.
    pub provenance: PvsProvenance,
    /// All objects.
    pub objects: Vec<ExportObject>,
    /// All cells.
    pub cells: Vec<ExportCell>,
}

/// An object's number and name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ExportObject {
    /// The number.
    pub id: u32,
    /// The name.
    pub name: String,
}

/// A cell and what it sees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExportCell {
    /// The number.
    pub id: u32,
    /// The name.
    pub name: String,
    /// Lower corner.
    pub min: [f64; 3],
    /// Upper corner.
    pub max: [f64; 3],
    /// The object whose polygons are the source, if the cell is no box.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<u32>,
    /// `exact`, `conservative`, `aggressive` or `approximate`.
    pub accuracy: &'static str,
    /// For aggressive cells: sets of lines smaller than this angle (radians) count as blocked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub below: Option<f64>,
    /// All objects that must not be culled, the touching and the unknown ones included.
    pub visible: Vec<u32>,
    /// Those of them that touch the cell.
    pub touching: Vec<u32>,
    /// Those of them that were not decided.
    pub unknown: Vec<u32>,
    /// A witness for each of the others, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub witnesses: Option<Vec<ExportWitness>>,
}

/// A segment that sees an object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExportWitness {
    /// The object.
    pub object: u32,
    /// The polygon it ends on.
    pub polygon: u32,
    /// Its start on the cell's boundary.
    pub from: [f64; 3],
    /// Its end on the polygon (if the file holds no planes: a point of its line).
    pub to: [f64; 3],
    /// `from` without rounding: a fraction of scene units for each coordinate.
    pub from_exact: [String; 3],
    /// `to` without rounding.
    pub to_exact: [String; 3],
}

/// Exports a file, with witnesses if `witnesses` is set.
///
/// # Errors
/// If the file was altered.
pub fn export(file: &PvsFile, witnesses: bool) -> Result<Export, PvsError> {
    let object = |id: u32| ExportObject {
        id,
        name: file.object_name(id).unwrap_or_default().to_owned(),
    };
    let planes = if witnesses {
        file.planes()?
    } else {
        Vec::new()
    };
    let mut cells = Vec::with_capacity(file.cell_count());
    for index in file.cells() {
        let Some(cell) = file.cell(index) else {
            continue;
        };
        let record = if witnesses {
            Some(file.record(index)?)
        } else {
            None
        };
        let exported = |record: crate::pvs::CellRecord| {
            let seen = record
                .visible
                .into_iter()
                .filter_map(|v| Some((v.object, v.witness?)));
            seen.map(|(object, w)| witness(file.grid(), &planes, object, &w))
                .collect()
        };
        let (accuracy, below) = accuracy(file.accuracy(index));
        cells.push(ExportCell {
            id: index.0,
            name: cell.name,
            min: file.grid().to_scene(cell.bounds.min),
            max: file.grid().to_scene(cell.bounds.max),
            source: match cell.kind {
                PvsCellKind::Box => None,
                PvsCellKind::Object(object) => Some(object),
            },
            accuracy,
            below,
            visible: file.visible(index)?.iter().collect(),
            touching: file.touching(index)?.iter().collect(),
            unknown: file.unknown(index)?.iter().collect(),
            witnesses: record.map(exported),
        });
    }
    Ok(Export {
        provenance: file.provenance().clone(),
        objects: (0..file.object_count() as u32).map(object).collect(),
        cells,
    })
}

fn accuracy(accuracy: Option<Accuracy>) -> (&'static str, Option<f64>) {
    match accuracy {
        Some(Accuracy::Exact) => ("exact", None),
        Some(Accuracy::Conservative) => ("conservative", None),
        Some(Accuracy::AggressiveBelow(angle)) => ("aggressive", Some(angle)),
        Some(Accuracy::Approximate) | None => ("approximate", None),
    }
}

fn witness(grid: &Grid, planes: &[[[i32; 3]; 3]], object: u32, w: &WitnessRecord) -> ExportWitness {
    let from = ExactPoint::fine(w.from);
    let plane = planes.get(w.polygon as usize);
    let to = plane
        .and_then(|plane| hit(plane, w))
        .unwrap_or_else(|| ExactPoint::fine(w.through));
    ExportWitness {
        object,
        polygon: w.polygon,
        from: from.to_scene(grid),
        to: to.to_scene(grid),
        from_exact: from.to_scene_exact(grid),
        to_exact: to.to_scene_exact(grid),
    }
}

/// A point with rational coordinates, in grid steps.
struct ExactPoint {
    numerators: [IBig; 3],
    /// Positive.
    denominator: IBig,
}

/// Fine coordinates to a grid step.
const FINE: i64 = 1 << 16;

/// Where the line of a witness meets the plane of its polygon; `None` if it is parallel.
fn hit(plane: &[[i32; 3]; 3], w: &WitnessRecord) -> Option<ExactPoint> {
    let big = |p: [i64; 3]| p.map(IBig::from);
    let corner = |i: usize| big(plane[i].map(|c| i64::from(c) * FINE));
    let (a, from) = (corner(0), big(w.from));
    let normal = cross(&minus(&corner(1), &a), &minus(&corner(2), &a));
    let direction = minus(&big(w.through), &from);
    let mut along = dot(&normal, &direction);
    let mut up = dot(&normal, &minus(&a, &from));
    if along == IBig::ZERO {
        return None;
    }
    if along < IBig::ZERO {
        (along, up) = (-along, -up);
    }
    let numerators = std::array::from_fn(|k| &from[k] * &along + &direction[k] * &up);
    Some(ExactPoint {
        numerators,
        denominator: along * IBig::from(FINE),
    })
}

fn minus(a: &[IBig; 3], b: &[IBig; 3]) -> [IBig; 3] {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn dot(a: &[IBig; 3], b: &[IBig; 3]) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &[IBig; 3], b: &[IBig; 3]) -> [IBig; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

impl ExactPoint {
    fn fine(p: [i64; 3]) -> Self {
        Self {
            numerators: p.map(IBig::from),
            denominator: IBig::from(FINE),
        }
    }

    fn to_scene(&self, grid: &Grid) -> [f64; 3] {
        let d = self.denominator.to_f64().value();
        grid.to_scene_f64(std::array::from_fn(|k| {
            self.numerators[k].to_f64().value() / d
        }))
    }

    /// Origin and step are doubles, so fractions themselves: nothing is lost.
    fn to_scene_exact(&self, grid: &Grid) -> [String; 3] {
        let (step, step_down) = fraction(grid.step());
        std::array::from_fn(|k| {
            let (origin, origin_down) = fraction(grid.origin()[k]);
            let numerator = origin * &step_down * &self.denominator
                + &self.numerators[k] * &step * &origin_down;
            reduced(numerator, origin_down * &step_down * &self.denominator)
        })
    }
}

/// A finite double as numerator and denominator.
fn fraction(value: f64) -> (IBig, IBig) {
    let bits = value.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i64;
    let mantissa = (bits & ((1 << 52) - 1)) as i64 + if exponent > 0 { 1 << 52 } else { 0 };
    let signed = IBig::from(if value < 0.0 { -mantissa } else { mantissa });
    let power = exponent.max(1) - 1075;
    let shift = IBig::ONE << power.unsigned_abs() as usize;
    if power >= 0 {
        (signed * shift, IBig::ONE)
    } else {
        (signed, shift)
    }
}

/// `n/d` in lowest terms; a whole number without the `/1`.
fn reduced(numerator: IBig, denominator: IBig) -> String {
    let divisor = IBig::from((&numerator).gcd(&denominator));
    let (n, d) = (numerator / &divisor, denominator / &divisor);
    if d == IBig::ONE {
        n.to_string()
    } else {
        format!("{n}/{d}")
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Grid;

    use super::{ExactPoint, FINE, fraction, hit, reduced};
    use crate::pvs::WitnessRecord;

    #[test]
    fn doubles_are_fractions() {
        for (value, text) in [(0.5, "1/2"), (-3.0, "-3"), (0.0, "0"), (1e300, "")] {
            let (n, d) = fraction(value);
            let found = reduced(n.clone(), d.clone());
            assert!(found == text || text.is_empty());
            assert_eq!(n.to_f64().value() / d.to_f64().value(), value);
        }
        let (n, d) = fraction(0.1);
        assert_eq!(reduced(n, d), "3602879701896397/36028797018963968");
    }

    #[test]
    fn a_witness_ends_on_its_plane() {
        // The plane x + y + z = 3 and the line from the origin towards (1, 1, 2).
        let plane = [[3, 0, 0], [0, 3, 0], [0, 0, 3]];
        let w = WitnessRecord {
            polygon: 0,
            source: 0,
            from: [0; 3],
            through: [FINE, FINE, 2 * FINE],
        };
        let grid = Grid::new([1.0, 0.0, 0.0], 0.5).expect("finite");
        let end = hit(&plane, &w).expect("not parallel");
        assert_eq!(end.to_scene_exact(&grid), ["11/8", "3/8", "3/4"]);
        assert_eq!(end.to_scene(&grid), [1.375, 0.375, 0.75]);
        let parallel = WitnessRecord {
            polygon: 0,
            source: 0,
            from: [0; 3],
            through: [1, -1, 0],
        };
        assert!(hit(&plane, &parallel).is_none());
        // Nothing overflows, whatever the file says.
        let wild = WitnessRecord {
            polygon: 0,
            source: 0,
            from: [i64::MIN; 3],
            through: [i64::MAX; 3],
        };
        let end = hit(&plane, &wild).unwrap_or_else(|| ExactPoint::fine([0; 3]));
        assert_eq!(end.to_scene_exact(&grid), ["3/2", "1/2", "1/2"]);
    }
}
