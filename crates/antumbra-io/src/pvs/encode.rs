//! From a header and the cells' results to the bytes of a `.pvs` file.

use std::io;
use std::path::Path;

use super::cells::{self, Block, Row};
use super::error::PvsError;
use super::layout::{assemble, checksum, encode_texts};
use super::lookup;
use super::model::{Accuracy, CellRecord, PvsHeader};
use super::record::{self, compress};

/// The results of one cell, encoded and ready to be put in place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EncodedCell {
    pub(super) accuracy: Accuracy,
    pub(super) bitmaps: Vec<u8>,
    pub(super) witnesses: Vec<u8>,
    pub(super) witness_count: u32,
}

impl EncodedCell {
    /// Encodes a record after checking it against the header.
    pub(super) fn new(
        header: &PvsHeader,
        index: u32,
        record: &CellRecord,
    ) -> Result<Self, PvsError> {
        let fault = |found: String| PvsError::Record { cell: index, found };
        if index as usize >= header.cells.len() {
            return Err(fault(format!(
                "it does not exist, there are {} cells",
                header.cells.len()
            )));
        }
        if let Some(found) = record::fault(record, header) {
            return Err(fault(found));
        }
        let (witnesses, witness_count) = record::encode_witnesses(record);
        let bitmaps = record::encode_bitmaps(record);
        Ok(Self {
            accuracy: record.accuracy,
            bitmaps,
            witnesses,
            witness_count,
        })
    }
}

/// The bytes of a `.pvs` file with these cells, one record a cell, in order. Equal input gives
/// equal bytes.
///
/// # Errors
/// If a record contradicts itself or the header, or their number is not that of the cells.
pub fn encode_pvs(header: &PvsHeader, records: &[CellRecord]) -> Result<Vec<u8>, PvsError> {
    let mut file = Assembly::new(header);
    for (i, record) in records.iter().enumerate() {
        file.push(&EncodedCell::new(header, i as u32, record)?);
    }
    file.finish()
}

/// A file in the making: cells are appended in order.
pub(super) struct Assembly<'a> {
    header: &'a PvsHeader,
    table: Vec<u8>,
    bitmaps: Vec<u8>,
    witnesses: Vec<u8>,
    cells: u32,
}

impl<'a> Assembly<'a> {
    pub(super) fn new(header: &'a PvsHeader) -> Self {
        Self {
            header,
            table: Vec::new(),
            bitmaps: Vec::new(),
            witnesses: Vec::new(),
            cells: 0,
        }
    }

    pub(super) fn push(&mut self, cell: &EncodedCell) {
        let Some(info) = self.header.cells.get(self.cells as usize) else {
            return;
        };
        let block = |section: &mut Vec<u8>, data: &[u8]| {
            let start = section.len();
            section.extend(data);
            Block {
                range: start..section.len(),
                checksum: checksum(data),
            }
        };
        let row = Row {
            bounds: info.bounds,
            kind: info.kind,
            accuracy: cell.accuracy,
            bitmaps: block(&mut self.bitmaps, &cell.bitmaps),
            witnesses: block(&mut self.witnesses, &cell.witnesses),
            witness_count: cell.witness_count,
        };
        cells::encode(&mut self.table, info, &row);
        self.cells += 1;
    }

    pub(super) fn finish(self) -> Result<Vec<u8>, PvsError> {
        let expected = self.header.cells.len();
        if self.cells as usize != expected {
            let found = format!("results end here, but there are {expected} cells");
            return Err(PvsError::Record {
                cell: self.cells,
                found,
            });
        }
        let fixed = FixedSections::new(self.header);
        Ok(assemble([
            &fixed.provenance,
            &fixed.names,
            &fixed.planes,
            &self.table,
            &fixed.cell_names,
            &fixed.lookup,
            &self.bitmaps,
            &self.witnesses,
        ]))
    }
}

/// The sections that are known before any cell is.
pub(super) struct FixedSections {
    pub(super) provenance: Vec<u8>,
    pub(super) names: Vec<u8>,
    pub(super) planes: Vec<u8>,
    pub(super) cell_names: Vec<u8>,
    pub(super) lookup: Vec<u8>,
}

impl FixedSections {
    pub(super) fn new(header: &PvsHeader) -> Self {
        let mut planes = (header.planes.len() as u32).to_le_bytes().to_vec();
        let raw: Vec<u8> = header
            .planes
            .iter()
            .flatten()
            .flatten()
            .flat_map(|c| c.to_le_bytes())
            .collect();
        planes.extend(compress(&raw));
        let cells: Vec<_> = header
            .cells
            .iter()
            .map(|cell| (cell.bounds, cell.kind))
            .collect();
        Self {
            // Plain numbers and text: writing them as JSON cannot fail.
            provenance: serde_json::to_vec(&header.provenance()).unwrap_or_default(),
            names: encode_texts(header.objects.iter().map(String::as_str)),
            planes,
            cell_names: encode_texts(header.cells.iter().map(|cell| cell.name.as_str())),
            lookup: lookup::encode(&cells),
        }
    }
}

/// What two bakes must share to continue one another.
pub(super) fn identity(header: &PvsHeader) -> [u8; 32] {
    let fixed = FixedSections::new(header);
    let mut table = Vec::new();
    for cell in &header.cells {
        let nothing = Block {
            range: 0..0,
            checksum: 0,
        };
        let row = Row {
            bounds: cell.bounds,
            kind: cell.kind,
            accuracy: Accuracy::Exact,
            bitmaps: nothing.clone(),
            witnesses: nothing,
            witness_count: 0,
        };
        cells::encode(&mut table, cell, &row);
    }
    let mut hasher = blake3::Hasher::new();
    for section in [
        &fixed.provenance,
        &fixed.names,
        &fixed.planes,
        &fixed.cell_names,
        &table,
    ] {
        hasher.update(&(section.len() as u64).to_le_bytes());
        hasher.update(section);
    }
    *hasher.finalize().as_bytes()
}

pub(crate) fn io_error(path: &Path, action: &'static str, cause: io::Error) -> PvsError {
    PvsError::Path {
        file: path.display().to_string(),
        action,
        cause,
    }
}
