//! The table of cells: 96 bytes each.

use std::ops::Range;

use antumbra_kernel::{Aabb, LIMIT, Point};

use super::model::{Accuracy, PvsCell, PvsCellKind};
use crate::bytes::Cursor;

const ENTRY: usize = 96;
const NO_OBJECT: u32 = u32::MAX;

/// Where a cell's data lies in a section, and its checksum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) range: Range<usize>,
    pub(super) checksum: u64,
}

/// A row of the table.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) bounds: Aabb,
    pub(super) kind: PvsCellKind,
    pub(super) accuracy: Accuracy,
    pub(super) bitmaps: Block,
    pub(super) witnesses: Block,
    pub(super) witness_count: u32,
}

pub(super) fn encode(out: &mut Vec<u8>, cell: &PvsCell, row: &Row) {
    for c in [cell.bounds.min, cell.bounds.max]
        .into_iter()
        .flat_map(Point::to_array)
    {
        out.extend(c.to_le_bytes());
    }
    let object = match cell.kind {
        PvsCellKind::Box => NO_OBJECT,
        PvsCellKind::Object(object) => object,
    };
    out.extend(object.to_le_bytes());
    let (code, below) = accuracy_code(row.accuracy);
    out.extend(code.to_le_bytes());
    out.extend(below.to_le_bytes());
    for block in [&row.bitmaps, &row.witnesses] {
        out.extend((block.range.start as u64).to_le_bytes());
        out.extend((block.range.len() as u64).to_le_bytes());
        out.extend(block.checksum.to_le_bytes());
    }
    out.extend(row.witness_count.to_le_bytes());
    out.extend([0; 4]);
}

/// The table; `Err` names the bad row (or the count of rows, if the table has a wrong size).
pub(super) fn decode(
    bytes: &[u8],
    objects: usize,
    bits: usize,
    witnesses: usize,
) -> Result<Vec<Row>, usize> {
    if !bytes.len().is_multiple_of(ENTRY) {
        return Err(bytes.len() / ENTRY);
    }
    let rows = bytes.chunks_exact(ENTRY).enumerate();
    rows.map(|(i, row)| decode_row(row, objects, bits, witnesses).ok_or(i))
        .collect()
}

fn decode_row(bytes: &[u8], objects: usize, bits: usize, witnesses: usize) -> Option<Row> {
    let mut cursor = Cursor::new(bytes);
    let min = point(&mut cursor)?;
    let max = point(&mut cursor)?;
    if min.x > max.x || min.y > max.y || min.z > max.z {
        return None;
    }
    let kind = match cursor.u32()? {
        NO_OBJECT => PvsCellKind::Box,
        object if (object as usize) < objects => PvsCellKind::Object(object),
        _ => return None,
    };
    let code = cursor.u32()?;
    let accuracy = accuracy(code, cursor.f64()?)?;
    let bitmaps = block(&mut cursor, bits)?;
    let witnesses = block(&mut cursor, witnesses)?;
    let witness_count = cursor.u32()?;
    (cursor.u32()? == 0).then_some(Row {
        bounds: Aabb::new(min, max),
        kind,
        accuracy,
        bitmaps,
        witnesses,
        witness_count,
    })
}

fn point(cursor: &mut Cursor<'_>) -> Option<Point> {
    let p = [cursor.i32()?, cursor.i32()?, cursor.i32()?];
    p.iter()
        .all(|c| (-LIMIT..=LIMIT).contains(c))
        .then(|| Point::from(p))
}

fn block(cursor: &mut Cursor<'_>, section: usize) -> Option<Block> {
    let start = usize::try_from(cursor.u64()?).ok()?;
    let length = usize::try_from(cursor.u64()?).ok()?;
    let end = start.checked_add(length).filter(|end| *end <= section)?;
    Some(Block {
        range: start..end,
        checksum: cursor.u64()?,
    })
}

pub(super) fn accuracy_code(accuracy: Accuracy) -> (u32, f64) {
    match accuracy {
        Accuracy::Exact => (0, 0.0),
        Accuracy::Conservative => (1, 0.0),
        Accuracy::AggressiveBelow(angle) => (2, angle),
        Accuracy::Approximate => (3, 0.0),
    }
}

pub(super) fn accuracy(code: u32, below: f64) -> Option<Accuracy> {
    Some(match code {
        0 => Accuracy::Exact,
        1 => Accuracy::Conservative,
        2 if below.is_finite() => Accuracy::AggressiveBelow(below),
        3 => Accuracy::Approximate,
        _ => return None,
    })
}
