//! How view cells are asked for: `grid:SIZE`, `boxes:FILE`, `object:NAME` or `auto`.

use std::str::FromStr;

use crate::SceneInput;

/// Which view cells to make.
///
/// ```
/// use antumbra_scene::CellSpec;
/// assert_eq!("grid:2.5".parse(), Ok(CellSpec::Grid(2.5)));
/// assert_eq!("object:north wall".parse(), Ok(CellSpec::Object("north wall".into())));
/// assert!("grid:0".parse::<CellSpec>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum CellSpec {
    /// Cubes of this size in scene units.
    Grid(f64),
    /// The boxes given.
    Boxes(Vec<NamedBox>),
    /// The polygons of an object, by name or decimal id.
    Object(String),
    /// Cubes over free space, sized to the scene.
    Auto,
}

/// A box in scene units.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedBox {
    /// Its name.
    pub name: String,
    /// Its smallest coordinates.
    pub min: [f64; 3],
    /// Its largest coordinates.
    pub max: [f64; 3],
}

/// Why a text describes no view cells.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CellSpecError {
    /// None of the known kinds.
    #[error("\"{0}\" describes no view cells: use grid:SIZE, boxes:FILE, object:NAME or auto")]
    Unknown(String),
    /// The size is no number, or not a positive finite one.
    #[error("\"{0}\" is no cell size: give a positive number of scene units, as in grid:2")]
    BadSize(String),
    /// `object:` without a name.
    #[error("object: needs the name or the id of an object, as in object:0")]
    NoName,
    /// The boxes are in a file, which somebody has to read: this crate reads none.
    #[error("the boxes of \"{0}\" have to be read from their file first")]
    BoxesInFile(String),
}

impl FromStr for CellSpec {
    type Err = CellSpecError;

    fn from_str(text: &str) -> Result<Self, CellSpecError> {
        let (kind, value) = text.split_once(':').unwrap_or((text, ""));
        match kind {
            "auto" if text == "auto" => Ok(Self::Auto),
            "grid" => match value.trim().parse::<f64>() {
                Ok(size) if size.is_finite() && size > 0.0 => Ok(Self::Grid(size)),
                _ => Err(CellSpecError::BadSize(value.to_owned())),
            },
            "object" if value.is_empty() => Err(CellSpecError::NoName),
            "object" => Ok(Self::Object(value.to_owned())),
            "boxes" => Err(CellSpecError::BoxesInFile(value.to_owned())),
            _ => Err(CellSpecError::Unknown(text.to_owned())),
        }
    }
}

impl CellSpec {
    /// The box that the cells will fill, in scene units, as far as it sticks out of the scene:
    /// what [`crate::SceneBuilder::cells_box`] should be told. `None` where the cells stay within
    /// the scene, or the input has no finite extent.
    #[must_use]
    pub fn reach(&self, input: &SceneInput) -> Option<([f64; 3], [f64; 3])> {
        match self {
            Self::Object(_) | Self::Auto => None,
            Self::Boxes(boxes) => union(boxes.iter().flat_map(|b| [b.min, b.max])),
            Self::Grid(size) => {
                let parts = input.objects.iter().flat_map(|object| &object.parts);
                let used = parts.flat_map(|part| {
                    let corners = part.faces.iter().flatten();
                    corners.filter_map(|&i| part.vertices.get(i as usize).copied())
                });
                let (min, max) = union(used)?;
                let end = |k: usize| min[k] + ((max[k] - min[k]) / size).ceil().max(1.0) * size;
                let reach = (min, [end(0), end(1), end(2)]);
                reach.1.iter().all(|c| c.is_finite()).then_some(reach)
            }
        }
    }
}

fn union(points: impl Iterator<Item = [f64; 3]>) -> Option<([f64; 3], [f64; 3])> {
    points
        .map(|p| (p, p))
        .reduce(|(a, b), (p, q)| {
            (
                std::array::from_fn(|k| a[k].min(p[k])),
                std::array::from_fn(|k| b[k].max(q[k])),
            )
        })
        .filter(|(min, max)| min.iter().chain(max).all(|c| c.is_finite()))
}

/// Up to three names that resemble the one asked for, best first.
pub(super) fn close_names<'a>(asked: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let asked = asked.to_lowercase();
    let tolerance = (asked.chars().count() / 3).max(2);
    let mut close: Vec<(usize, &str)> = names
        .filter_map(|name| {
            let lower = name.to_lowercase();
            let part = asked.len() >= 3 && lower.contains(&asked);
            let steps = if part {
                1
            } else {
                edits(&asked, &lower, tolerance)?
            };
            Some((steps, name))
        })
        .collect();
    // Stable: of names equally close, those earlier in the file come first.
    close.sort_by_key(|(steps, _)| *steps);
    let mut best: Vec<String> = Vec::new();
    for (_, name) in close {
        if best.len() < 3 && !best.iter().any(|b| b == name) {
            best.push(name.to_owned());
        }
    }
    best
}

/// How many insertions, deletions and exchanges lead from one word to the other, if not more than
/// the tolerance.
fn edits(a: &str, b: &str, tolerance: usize) -> Option<usize> {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    if a.len().abs_diff(b.len()) > tolerance {
        return None;
    }
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let exchange = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = exchange.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row.last().copied().filter(|&steps| steps <= tolerance)
}

#[cfg(test)]
mod tests {
    use super::{CellSpec, CellSpecError, NamedBox, close_names, edits};
    use crate::SceneInput;

    #[test]
    fn texts_are_read_or_refused_with_the_reason() {
        assert_eq!("auto".parse(), Ok(CellSpec::Auto));
        assert_eq!("object:a:b".parse(), Ok(CellSpec::Object("a:b".into())));
        for bad in [
            "grid:", "grid:0", "grid:-1", "grid:nan", "grid:inf", "grid:two",
        ] {
            assert!(
                matches!(bad.parse::<CellSpec>(), Err(CellSpecError::BadSize(_))),
                "{bad}"
            );
        }
        assert_eq!("object:".parse::<CellSpec>(), Err(CellSpecError::NoName));
        assert!(matches!(
            "cubes:3".parse::<CellSpec>(),
            Err(CellSpecError::Unknown(_))
        ));
        assert!(matches!(
            "auto:3".parse::<CellSpec>(),
            Err(CellSpecError::Unknown(_))
        ));
        assert!(matches!(
            "boxes:f.json".parse::<CellSpec>(),
            Err(CellSpecError::BoxesInFile(_))
        ));
    }

    #[test]
    fn boxes_reach_beyond_an_empty_scene() {
        let one = NamedBox {
            name: "a".into(),
            min: [-1.0; 3],
            max: [2.0; 3],
        };
        let spec = CellSpec::Boxes(vec![one]);
        assert_eq!(
            spec.reach(&SceneInput::default()),
            Some(([-1.0; 3], [2.0; 3]))
        );
        assert_eq!(CellSpec::Grid(1.0).reach(&SceneInput::default()), None);
    }

    #[test]
    fn near_misses_are_suggested() {
        assert_eq!(edits("kitten", "sitting", 3), Some(3));
        assert_eq!(edits("kitten", "sitting", 2), None);
        let names = ["Wall-1", "Wall-2", "slab", "Wall-1", "Stairwell"];
        assert_eq!(
            close_names("wal-1", names.into_iter()),
            ["Wall-1", "Wall-2"]
        );
        assert_eq!(close_names("well", names.into_iter())[0], "Stairwell");
        assert!(close_names("zzz", names.into_iter()).is_empty());
    }
}
