//! Reads `.pvs` files.

use std::ops::Range;
use std::path::Path;

use antumbra_kernel::Grid;
use roaring::RoaringBitmap;

use super::cells::{self, Block, Row};
use super::encode::io_error;
use super::error::PvsError;
use super::layout::{Extent, Section, checked, checksum, decode_texts, dissect, hash};
use super::lookup;
use super::map::Bytes;
use super::model::{Accuracy, CellRecord, PvsCell, PvsProvenance, VisibleRecord, WitnessRecord};
use super::record::{self, Bitmaps, decompress};
use crate::bytes::Cursor;

/// The number of a view cell of a `.pvs` file, zero-based.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellIndex(pub u32);

/// An open `.pvs` file.
///
/// Opening checks the table of cells, the names and the lookup structure. What a cell sees is
/// checked when it is asked for: an altered file gives an error, never a wrong answer.
///
/// ```
/// use antumbra_io::PvsFile;
/// use antumbra_io::pvs::{Accuracy, CellRecord, PvsCell, PvsCellKind, PvsHeader, VisibleRecord, encode_pvs};
/// use antumbra_kernel::{Aabb, Grid, Point};
///
/// let bounds = Aabb::new(Point::new(0, 0, 0), Point::new(10, 10, 10));
/// let header = PvsHeader {
///     scene_hash: [7; 32],
///     grid: Grid::new([0.0; 3], 0.5).unwrap(),
///     options: "cells=auto".into(),
///     proofs: false,
///     objects: vec!["wall".into(), "chair".into()],
///     planes: vec![],
///     cells: vec![PvsCell { name: "hall".into(), bounds, kind: PvsCellKind::Box }],
/// };
/// let chair = VisibleRecord { object: 1, witness: None };
/// let record = CellRecord { accuracy: Accuracy::Exact, visible: vec![chair], unknown: vec![] };
/// let file = PvsFile::from_bytes(encode_pvs(&header, &[record])?, "hall.pvs")?;
///
/// let cell = file.cell_at([2.0, 3.0, 5.0]).unwrap();
/// assert_eq!(file.visible(cell)?.iter().collect::<Vec<_>>(), [1]);
/// assert_eq!(file.object_name(1), Some("chair"));
/// assert_eq!(file.cell_at([2.0, 3.0, 5.5]), None);
/// # Ok::<(), antumbra_io::PvsError>(())
/// ```
#[derive(Debug)]
pub struct PvsFile {
    bytes: Bytes,
    file: String,
    extents: Vec<Extent>,
    provenance: PvsProvenance,
    grid: Grid,
    /// Where each object's name lies in the file.
    names: Vec<Range<usize>>,
    cell_names: Vec<Range<usize>>,
    rows: Vec<Row>,
    lookup: lookup::Shape,
}

impl PvsFile {
    /// Maps a file into memory and checks it.
    ///
    /// # Errors
    /// If the path cannot be read, or the file is no `.pvs` file, cut off or altered.
    pub fn open(path: &Path) -> Result<Self, PvsError> {
        let bytes = Bytes::map(path).map_err(|cause| io_error(path, "read", cause))?;
        Self::new(bytes, path.display().to_string())
    }

    /// Checks a file that is in memory; `file` names it in messages.
    ///
    /// # Errors
    /// If it is no `.pvs` file, cut off or altered.
    pub fn from_bytes(bytes: Vec<u8>, file: &str) -> Result<Self, PvsError> {
        Self::new(Bytes::Owned(bytes), file.to_owned())
    }

    fn new(bytes: Bytes, file: String) -> Result<Self, PvsError> {
        let extents = dissect(&file, &bytes)?;
        let section = |section| checked(&file, &bytes, &extents, section);
        let damaged = |place: &str, found: String| PvsError::damaged(&file, place, found);

        let provenance: PvsProvenance = serde_json::from_slice(section(Section::Provenance)?)
            .map_err(|error| damaged("section PROV", error.to_string()))?;
        let grid = Grid::new(provenance.grid.origin, provenance.grid.step)
            .ok_or_else(|| damaged("section PROV", "the grid has no positive step".to_owned()))?;
        let texts = |which: Section, place: &str| {
            let start = extents[which as usize].range.start;
            let ranges = decode_texts(section(which)?);
            let ranges =
                ranges.ok_or_else(|| damaged(place, "the names are damaged".to_owned()))?;
            Ok(ranges
                .into_iter()
                .map(|r| start + r.start..start + r.end)
                .collect::<Vec<_>>())
        };
        let names = texts(Section::Names, "section NAME")?;
        let cell_names = texts(Section::CellNames, "section CNAM")?;
        let length = |which: Section| extents[which as usize].range.len();
        let (bits, witnesses) = (length(Section::Bitmaps), length(Section::Witnesses));
        let rows = cells::decode(section(Section::Cells)?, names.len(), bits, witnesses)
            .map_err(|cell| damaged("section CELL", format!("cell {cell} is damaged")))?;
        if rows.len() != cell_names.len() {
            let found = format!("{} cells, but {} cell names", rows.len(), cell_names.len());
            return Err(damaged("section CNAM", found));
        }
        let lookup = lookup::check(section(Section::Lookup)?, &rows)
            .ok_or_else(|| damaged("section LOOK", "the boxes form no hierarchy".to_owned()))?;
        Ok(Self {
            bytes,
            file,
            extents,
            provenance,
            grid,
            names,
            cell_names,
            rows,
            lookup,
        })
    }

    /// Where the file comes from.
    #[must_use]
    pub fn provenance(&self) -> &PvsProvenance {
        &self.provenance
    }

    /// The grid that its integers refer to.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Its size in bytes.
    #[must_use]
    pub fn byte_len(&self) -> usize {
        self.bytes.len()
    }

    /// The BLAKE3 hash of all its bytes; a `.proof` file is bound to it.
    #[must_use]
    pub fn hash(&self) -> [u8; 32] {
        hash(&self.bytes)
    }

    /// How many objects the scene has.
    #[must_use]
    pub fn object_count(&self) -> usize {
        self.names.len()
    }

    /// The name of an object; `None` if there is no such object.
    #[must_use]
    pub fn object_name(&self, object: u32) -> Option<&str> {
        self.text(self.names.get(object as usize)?)
    }

    /// How many cells there are.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.rows.len()
    }

    /// All cells' numbers.
    pub fn cells(&self) -> impl Iterator<Item = CellIndex> + use<> {
        (0..self.rows.len() as u32).map(CellIndex)
    }

    /// Name, box and kind of a cell; `None` if there is no such cell.
    #[must_use]
    pub fn cell(&self, cell: CellIndex) -> Option<PvsCell> {
        let row = self.rows.get(cell.0 as usize)?;
        let name = self.text(self.cell_names.get(cell.0 as usize)?)?.to_owned();
        Some(PvsCell {
            name,
            bounds: row.bounds,
            kind: row.kind,
        })
    }

    /// The accuracy class of a cell; `None` if there is no such cell.
    #[must_use]
    pub fn accuracy(&self, cell: CellIndex) -> Option<Accuracy> {
        self.rows.get(cell.0 as usize).map(|row| row.accuracy)
    }

    /// The cell that a point in scene units lies in: the first of them, if several share it.
    ///
    /// The point is snapped to the nearest grid point, as everything is; then it is compared
    /// exactly with the closed boxes. Cells whose source is an object contain no points.
    /// Logarithmic in the number of cells, if they do not overlap much; well under a microsecond.
    #[must_use]
    pub fn cell_at(&self, point: [f64; 3]) -> Option<CellIndex> {
        let point = self.grid.snap(point).ok()?;
        let lookup = &self.bytes[self.extents[Section::Lookup as usize].range.clone()];
        self.lookup.find(lookup, &self.rows, point).map(CellIndex)
    }

    /// The objects that must not be culled in a cell: all that is visible, touches the cell, or
    /// was not decided.
    ///
    /// # Errors
    /// If there is no such cell, or its bytes were altered.
    pub fn visible(&self, cell: CellIndex) -> Result<RoaringBitmap, PvsError> {
        let bytes = self.block(Section::Bitmaps, &self.row(cell)?.bitmaps, cell)?;
        record::decode_visible(bytes, self.names.len())
            .ok_or_else(|| self.damaged(cell, "its bitmaps are damaged"))
    }

    /// The objects that touch a cell; all of them are in [`PvsFile::visible`].
    ///
    /// # Errors
    /// As for [`PvsFile::visible`].
    pub fn touching(&self, cell: CellIndex) -> Result<RoaringBitmap, PvsError> {
        Ok(self.bitmaps(cell)?.touching)
    }

    /// The objects that were not decided; all of them are in [`PvsFile::visible`].
    ///
    /// # Errors
    /// As for [`PvsFile::visible`].
    pub fn unknown(&self, cell: CellIndex) -> Result<RoaringBitmap, PvsError> {
        Ok(self.bitmaps(cell)?.unknown)
    }

    /// All results of a cell, as they were written.
    ///
    /// # Errors
    /// If there is no such cell, or its bytes were altered.
    pub fn record(&self, cell: CellIndex) -> Result<CellRecord, PvsError> {
        let bitmaps = self.bitmaps(cell)?;
        let row = self.row(cell)?;
        let bytes = self.block(Section::Witnesses, &row.witnesses, cell)?;
        let witnesses = record::decode_witnesses(bytes, row.witness_count);
        let witnesses = witnesses.ok_or_else(|| self.damaged(cell, "its witnesses are damaged"))?;
        let mut next = witnesses.into_iter();
        let mut visible = Vec::new();
        for object in &bitmaps.visible - &bitmaps.unknown {
            let witness = if bitmaps.touching.contains(object) {
                None
            } else {
                let found = next.next().filter(|(o, _)| *o == object);
                let (_, witness) =
                    found.ok_or_else(|| self.damaged(cell, "a visible object has no witness"))?;
                Some(witness)
            };
            visible.push(VisibleRecord { object, witness });
        }
        if next.next().is_some() {
            return Err(self.damaged(cell, "a witness without a visible object"));
        }
        Ok(CellRecord {
            accuracy: row.accuracy,
            visible,
            unknown: bitmaps.unknown.iter().collect(),
        })
    }

    /// The witness of each visible object that does not touch the cell, by ascending object.
    ///
    /// # Errors
    /// As for [`PvsFile::record`].
    pub fn witnesses(&self, cell: CellIndex) -> Result<Vec<(u32, WitnessRecord)>, PvsError> {
        let visible = self.record(cell)?.visible;
        Ok(visible
            .into_iter()
            .filter_map(|v| Some((v.object, v.witness?)))
            .collect())
    }

    /// Three corners of each polygon, in grid coordinates; empty if the file does not hold them.
    ///
    /// # Errors
    /// If the bytes were altered.
    pub fn planes(&self) -> Result<Vec<[[i32; 3]; 3]>, PvsError> {
        let bytes = checked(&self.file, &self.bytes, &self.extents, Section::Planes)?;
        decode_planes(bytes)
            .ok_or_else(|| PvsError::damaged(&self.file, "section PLAN", "the planes are damaged"))
    }

    /// Checks every byte that has a meaning, by reading everything once.
    ///
    /// # Errors
    /// If anything was altered.
    pub fn verify(&self) -> Result<(), PvsError> {
        self.planes()?;
        for section in [Section::Bitmaps, Section::Witnesses] {
            checked(&self.file, &self.bytes, &self.extents, section)?;
        }
        self.cells()
            .try_for_each(|cell| self.record(cell).map(drop))
    }

    /// The file's name, as given.
    #[must_use]
    pub fn file_name(&self) -> &str {
        &self.file
    }

    fn bitmaps(&self, cell: CellIndex) -> Result<Bitmaps, PvsError> {
        let row = self.row(cell)?;
        let bytes = self.block(Section::Bitmaps, &row.bitmaps, cell)?;
        record::decode_bitmaps(bytes, self.names.len())
            .ok_or_else(|| self.damaged(cell, "its bitmaps are damaged"))
    }

    fn row(&self, cell: CellIndex) -> Result<&Row, PvsError> {
        self.rows
            .get(cell.0 as usize)
            .ok_or_else(|| PvsError::Mismatch {
                file: self.file.clone(),
                found: format!(
                    "cell {} does not exist, there are {}",
                    cell.0,
                    self.rows.len()
                ),
                advice: "give the number of an existing cell",
            })
    }

    fn block(&self, section: Section, block: &Block, cell: CellIndex) -> Result<&[u8], PvsError> {
        let section = &self.bytes[self.extents[section as usize].range.clone()];
        let data = &section[block.range.clone()];
        if checksum(data) == block.checksum {
            return Ok(data);
        }
        Err(self.damaged(cell, "the checksum does not match, bytes were altered"))
    }

    fn damaged(&self, cell: CellIndex, found: &str) -> PvsError {
        PvsError::damaged(&self.file, format!("cell {}", cell.0), found)
    }

    fn text(&self, range: &Range<usize>) -> Option<&str> {
        std::str::from_utf8(&self.bytes[range.clone()]).ok()
    }
}

fn decode_planes(bytes: &[u8]) -> Option<Vec<[[i32; 3]; 3]>> {
    let mut cursor = Cursor::new(bytes);
    let count = cursor.u32()?;
    let raw = decompress(cursor.take(cursor.remaining())?, u64::from(count) * 36)?;
    let mut cursor = Cursor::new(&raw);
    let mut point = || Some([cursor.i32()?, cursor.i32()?, cursor.i32()?]);
    (0..count)
        .map(|_| Some([point()?, point()?, point()?]))
        .collect()
}
