//! What a `.pvs` file holds, as plain data.

use antumbra_kernel::{Aabb, Grid};
use serde::{Deserialize, Serialize};

/// Everything about a bake but its results. Two bakes with equal headers may be continued by
/// each other; a finished bake with an equal header is the same file.
#[derive(Clone, Debug, PartialEq)]
pub struct PvsHeader {
    /// A hash of the snapped scene.
    pub scene_hash: [u8; 32],
    /// The grid that all integers refer to.
    pub grid: Grid,
    /// The options that shape the result, in a canonical form. No time, path or thread count.
    pub options: String,
    /// Whether certificates are kept, in a `.proof` file beside.
    pub proofs: bool,
    /// Name of each object, by id.
    pub objects: Vec<String>,
    /// Three corners of each polygon that are not collinear, in grid coordinates: with them the
    /// end of a witness can be computed without the scene. Empty if that is not wanted.
    pub planes: Vec<[[i32; 3]; 3]>,
    /// The view cells.
    pub cells: Vec<PvsCell>,
}

/// A view cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PvsCell {
    /// Its name. Need not be unique.
    pub name: String,
    /// Its box in grid coordinates; for an object as source, the box around it.
    pub bounds: Aabb,
    /// What the source of the lines is.
    pub kind: PvsCellKind,
}

/// What a view cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PvsCellKind {
    /// The box itself.
    Box,
    /// The polygons of this object; such a cell contains no points and is never looked up.
    Object(u32),
}

/// How a cell's set relates to the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Neither too much nor too little.
    Exact,
    /// Never too little.
    Conservative,
    /// Sets of lines smaller than this angle (radians) count as blocked.
    AggressiveBelow(f64),
    /// Both too much and too little are possible.
    Approximate,
}

/// What was found out about one cell.
#[derive(Clone, Debug, PartialEq)]
pub struct CellRecord {
    /// The accuracy class of this cell.
    pub accuracy: Accuracy,
    /// The visible objects, ascending, each once.
    pub visible: Vec<VisibleRecord>,
    /// The objects that were not decided, ascending; none of them in `visible`.
    pub unknown: Vec<u32>,
}

/// One visible object of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibleRecord {
    /// The object.
    pub object: u32,
    /// The proof: `None` exactly if the object touches the cell, where none is needed.
    pub witness: Option<WitnessRecord>,
}

/// A segment that sees an object: it starts at `from` on the cell's boundary, runs towards
/// `through` and ends on the polygon. Coordinates count 2^-16 grid steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WitnessRecord {
    /// The polygon it ends on.
    pub polygon: u32,
    /// Which part of the source it leaves, as the certificates number them.
    pub source: u32,
    /// Where it starts.
    pub from: [i64; 3],
    /// Another point of its line.
    pub through: [i64; 3],
}

/// Where a `.pvs` file comes from; equal bakes have equal provenance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PvsProvenance {
    /// The version of the program that wrote it.
    pub antumbra: String,
    /// The hash of the snapped scene in hexadecimal digits.
    pub scene: String,
    /// The grid of all integers.
    pub grid: ProvenanceGrid,
    /// The options that shaped the result.
    pub options: String,
    /// Whether a `.proof` file was written beside.
    pub proofs: bool,
}

/// A grid as JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProvenanceGrid {
    /// Scene coordinates of the grid point (0, 0, 0).
    pub origin: [f64; 3],
    /// The grid's step in scene units.
    pub step: f64,
}

impl PvsHeader {
    /// What the file says of its origin.
    #[must_use]
    pub fn provenance(&self) -> PvsProvenance {
        PvsProvenance {
            antumbra: env!("CARGO_PKG_VERSION").to_owned(),
            scene: hex(&self.scene_hash),
            grid: ProvenanceGrid {
                origin: self.grid.origin(),
                step: self.grid.step(),
            },
            options: self.options.clone(),
            proofs: self.proofs,
        }
    }
}

impl PvsProvenance {
    /// The scene's hash as bytes; `None` if the text is not 64 hexadecimal digits.
    #[must_use]
    pub fn scene_hash(&self) -> Option<[u8; 32]> {
        let digits = self.scene.as_bytes();
        if digits.len() != 64 {
            return None;
        }
        let mut out = [0; 32];
        for (byte, pair) in out.iter_mut().zip(digits.as_chunks::<2>().0) {
            let digit = |d: u8| char::from(d).to_digit(16);
            *byte = (digit(pair[0])? << 4 | digit(pair[1])?) as u8;
        }
        Some(out)
    }
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes
        .iter()
        .flat_map(|b| [b >> 4, b & 15])
        .filter_map(|d| char::from_digit(u32::from(d), 16))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{PvsHeader, hex};

    #[test]
    fn the_scene_hash_survives_its_text() {
        let header = PvsHeader {
            scene_hash: std::array::from_fn(|i| (i * 37) as u8),
            grid: antumbra_kernel::Grid::new([0.1, -7.0, 1e9], 0.001).expect("finite"),
            options: "cells=grid:2".into(),
            proofs: true,
            objects: Vec::new(),
            planes: Vec::new(),
            cells: Vec::new(),
        };
        let provenance = header.provenance();
        assert_eq!(provenance.scene_hash(), Some(header.scene_hash));
        let text = serde_json::to_string(&provenance).expect("plain data");
        assert_eq!(
            serde_json::from_str::<super::PvsProvenance>(&text).expect("own text"),
            provenance
        );
        assert_eq!(hex(&[0x0f, 0xa0]), "0fa0");
    }
}
