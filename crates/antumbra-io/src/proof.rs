//! The `.proof` container: a certificate for each view cell of a `.pvs` file, compressed.
//!
//! This crate does not know what is in a certificate. The bytes of the container are described in
//! `docs/formats/proof.md`.

use std::io::{self, Write};
use std::path::Path;

use crate::bytes::Cursor;
use crate::pvs::record::decompress;
use crate::pvs::{Bytes, CellIndex, PvsError, PvsFile, checksum, io_error};

const MAGIC: [u8; 8] = *b"\x89PRF\r\n\x1a\n";
const VERSION: u32 = 1;
const HEADER: usize = 48;
const ENTRY: usize = 32;
const FOOTER: usize = 32;

/// An open `.proof` file.
#[derive(Debug)]
pub struct ProofFile {
    bytes: Bytes,
    file: String,
    pvs_hash: [u8; 32],
    entries: Vec<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    offset: u64,
    length: u64,
    raw_length: u64,
    checksum: u64,
}

impl ProofFile {
    /// Maps a file into memory and checks its index.
    ///
    /// # Errors
    /// If the path cannot be read, or the file is no `.proof` file, cut off or altered.
    pub fn open(path: &Path) -> Result<Self, PvsError> {
        let bytes = Bytes::map(path).map_err(|cause| io_error(path, "read", cause))?;
        Self::new(bytes, path.display().to_string())
    }

    /// Checks a file that is in memory; `file` names it in messages.
    ///
    /// # Errors
    /// If it is no `.proof` file, cut off or altered.
    pub fn from_bytes(bytes: Vec<u8>, file: &str) -> Result<Self, PvsError> {
        Self::new(Bytes::Owned(bytes), file.to_owned())
    }

    fn new(bytes: Bytes, file: String) -> Result<Self, PvsError> {
        if !bytes.starts_with(&MAGIC) {
            return Err(PvsError::damaged(&file, "byte 0", "this is no .proof file"));
        }
        let version = bytes
            .get(8..12)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        if version.is_some_and(|version| version != VERSION) {
            let found = format!(
                "format version {}, this program reads {VERSION}",
                version.unwrap_or(0)
            );
            return Err(PvsError::damaged(&file, "byte 8", found));
        }
        let (pvs_hash, entries) = read_index(&bytes).ok_or_else(|| {
            PvsError::damaged(
                &file,
                "the index at the end",
                "the file was cut off or altered",
            )
        })?;
        Ok(Self {
            bytes,
            file,
            pvs_hash,
            entries,
        })
    }

    /// The hash of the `.pvs` file that these proofs belong to.
    #[must_use]
    pub fn pvs_hash(&self) -> [u8; 32] {
        self.pvs_hash
    }

    /// How many cells there are.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.entries.len()
    }

    /// Its size in bytes.
    #[must_use]
    pub fn byte_len(&self) -> usize {
        self.bytes.len()
    }

    /// Makes sure that these are the proofs of `pvs`, not of another bake.
    ///
    /// # Errors
    /// If they are not.
    pub fn check_belongs_to(&self, pvs: &PvsFile) -> Result<(), PvsError> {
        if self.pvs_hash == pvs.hash() && self.entries.len() == pvs.cell_count() {
            return Ok(());
        }
        Err(PvsError::Mismatch {
            file: self.file.clone(),
            found: format!("these are not the proofs of {}", pvs.file_name()),
            advice: "keep the two files of one bake together, or bake anew",
        })
    }

    /// The certificate of a cell, unpacked.
    ///
    /// # Errors
    /// If there is no such cell, or its bytes were altered.
    pub fn proof(&self, cell: CellIndex) -> Result<Vec<u8>, PvsError> {
        let damaged =
            |found: &str| PvsError::damaged(&self.file, format!("cell {}", cell.0), found);
        let entry = self
            .entries
            .get(cell.0 as usize)
            .ok_or_else(|| damaged("it has no proof"))?;
        // The index was checked when the file was opened.
        let data = &self.bytes[entry.offset as usize..(entry.offset + entry.length) as usize];
        if checksum(data) != entry.checksum {
            return Err(damaged("the checksum does not match, bytes were altered"));
        }
        decompress(data, entry.raw_length).ok_or_else(|| damaged("the compressed data is damaged"))
    }
}

fn read_index(bytes: &[u8]) -> Option<([u8; 32], Vec<Entry>)> {
    let footer = bytes.len().checked_sub(FOOTER).filter(|at| *at >= HEADER)?;
    let mut cursor = Cursor::new(&bytes[footer..]);
    let index = usize::try_from(cursor.u64()?).ok()?;
    let count = usize::try_from(cursor.u64()?).ok()?;
    let sum = cursor.u64()?;
    if cursor.array()? != MAGIC
        || index < HEADER
        || count.checked_mul(ENTRY)?.checked_add(index)? != footer
    {
        return None;
    }
    let table = &bytes[index..footer];
    if checksum(&[&bytes[..HEADER], table, &bytes[footer..footer + 16]].concat()) != sum {
        return None;
    }
    let pvs_hash = bytes[16..HEADER].try_into().ok()?;
    let mut cursor = Cursor::new(table);
    let mut entries = Vec::with_capacity(count);
    let mut at = HEADER as u64;
    for _ in 0..count {
        let entry = Entry {
            offset: cursor.u64()?,
            length: cursor.u64()?,
            raw_length: cursor.u64()?,
            checksum: cursor.u64()?,
        };
        if entry.offset != at {
            return None;
        }
        at = at
            .checked_add(entry.length)
            .filter(|end| *end <= index as u64)?;
        entries.push(entry);
    }
    (at == index as u64).then_some((pvs_hash, entries))
}

/// A `.proof` file in the making: cells are appended in order.
pub(crate) struct ProofAssembly<W> {
    out: W,
    header: Vec<u8>,
    index: Vec<u8>,
    at: u64,
}

impl<W: Write> ProofAssembly<W> {
    pub(crate) fn begin(mut out: W, pvs_hash: [u8; 32]) -> io::Result<Self> {
        let mut header = MAGIC.to_vec();
        header.extend(VERSION.to_le_bytes());
        header.extend([0; 4]);
        header.extend(pvs_hash);
        out.write_all(&header)?;
        Ok(Self {
            out,
            header,
            index: Vec::new(),
            at: HEADER as u64,
        })
    }

    /// Adds a certificate that is compressed already.
    pub(crate) fn push(&mut self, compressed: &[u8], raw_length: u64) -> io::Result<()> {
        self.out.write_all(compressed)?;
        let length = compressed.len() as u64;
        for value in [self.at, length, raw_length, checksum(compressed)] {
            self.index.extend(value.to_le_bytes());
        }
        self.at += length;
        Ok(())
    }

    /// Writes the index and returns the size of the file.
    pub(crate) fn finish(mut self) -> io::Result<u64> {
        let mut footer = self.at.to_le_bytes().to_vec();
        footer.extend(((self.index.len() / ENTRY) as u64).to_le_bytes());
        let sum = checksum(&[&self.header[..], &self.index, &footer].concat());
        footer.extend(sum.to_le_bytes());
        footer.extend(MAGIC);
        self.out.write_all(&self.index)?;
        self.out.write_all(&footer)?;
        Ok(self.at + (self.index.len() + footer.len()) as u64)
    }
}
