//! How two potentially visible sets differ: what only one of them holds, and the relative over-
//! and underestimation. After [Bittner02, 2.4.3].

use serde::Serialize;

use crate::pvs::{CellIndex, PvsError, PvsFile};

/// The differences of two files A and B with the same cells and objects; B is the reference.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// How many cells were compared.
    pub cells: u64,
    /// Entries (pairs of cell and object) of A.
    pub entries_a: u64,
    /// Entries of B.
    pub entries_b: u64,
    /// Entries of A that B does not have.
    pub only_a: u64,
    /// Entries of B that A does not have.
    pub only_b: u64,
    /// Relative overestimation of A: `only_a / entries_b`.
    pub q_over: f64,
    /// Relative underestimation of A: `only_b / entries_b`.
    pub q_under: f64,
    /// The cells that differ.
    pub differences: Vec<CellDifference>,
}

/// What differs in one cell.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CellDifference {
    /// The cell's number.
    pub cell: u32,
    /// The cell's name.
    pub name: String,
    /// Objects that only A may see.
    pub only_a: Vec<u32>,
    /// Objects that only B may see.
    pub only_b: Vec<u32>,
}

/// Compares two files cell by cell. Against an empty reference the quotients divide by one.
///
/// # Errors
/// If the files do not have the same objects (by name) and cells (by box, in scene units), or one
/// of them is damaged.
pub fn compare(a: &PvsFile, b: &PvsFile) -> Result<Comparison, PvsError> {
    check_comparable(a, b)?;
    let mut out = Comparison::default();
    for cell in a.cells() {
        let (seen_a, seen_b) = (a.visible(cell)?, b.visible(cell)?);
        let only_a: Vec<u32> = (&seen_a - &seen_b).iter().collect();
        let only_b: Vec<u32> = (&seen_b - &seen_a).iter().collect();
        out.cells += 1;
        out.entries_a += seen_a.len();
        out.entries_b += seen_b.len();
        out.only_a += only_a.len() as u64;
        out.only_b += only_b.len() as u64;
        if !only_a.is_empty() || !only_b.is_empty() {
            let name = a.cell(cell).map(|cell| cell.name).unwrap_or_default();
            out.differences.push(CellDifference {
                cell: cell.0,
                name,
                only_a,
                only_b,
            });
        }
    }
    let reference = out.entries_b.max(1) as f64;
    out.q_over = out.only_a as f64 / reference;
    out.q_under = out.only_b as f64 / reference;
    Ok(out)
}

fn check_comparable(a: &PvsFile, b: &PvsFile) -> Result<(), PvsError> {
    let differ = |found: String| {
        Err(PvsError::Mismatch {
            file: b.file_name().to_owned(),
            found,
            advice: "compare bakes of one scene with the same cells and the same --grid",
        })
    };
    let (n, m) = (a.object_count(), b.object_count());
    if n != m {
        return differ(format!("it has {m} objects, {} has {n}", a.file_name()));
    }
    if let Some(object) = (0..n as u32).find(|o| a.object_name(*o) != b.object_name(*o)) {
        return differ(format!(
            "object {object} has another name than in {}",
            a.file_name()
        ));
    }
    let (n, m) = (a.cell_count(), b.cell_count());
    if n != m {
        return differ(format!("it has {m} cells, {} has {n}", a.file_name()));
    }
    // Boxes are snapped outwards, each on its own grid: one step of each is the same box.
    let tolerance = a.grid().step().max(b.grid().step());
    let corners = |file: &PvsFile, cell: CellIndex| {
        let bounds = file.cell(cell).map(|cell| cell.bounds)?;
        Some([
            file.grid().to_scene(bounds.min),
            file.grid().to_scene(bounds.max),
        ])
    };
    let same = |cell: CellIndex| match (corners(a, cell), corners(b, cell)) {
        (Some(p), Some(q)) => p
            .iter()
            .flatten()
            .zip(q.iter().flatten())
            .all(|(p, q)| (p - q).abs() <= 2.0 * tolerance),
        _ => false,
    };
    match a.cells().find(|cell| !same(*cell)) {
        Some(cell) => differ(format!(
            "cell {} is another box than in {}",
            cell.0,
            a.file_name()
        )),
        None => Ok(()),
    }
}
