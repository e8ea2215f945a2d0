//! The journal of an unfinished bake, `F.pvs.part`: finished cells in the order they came.
//!
//! A header binds it to one bake. Each record carries its length and checksum, so that a kill
//! in the middle of a write costs that record and nothing else.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::cells::{accuracy, accuracy_code};
use super::encode::{EncodedCell, identity, io_error};
use super::error::PvsError;
use super::layout::checksum;
use super::model::PvsHeader;
use crate::bytes::Cursor;

const MAGIC: [u8; 8] = *b"\x89PVJ\r\n\x1a\n";
const VERSION: u32 = 1;
/// Before each record: length, cell, zero, checksum of all that and the payload.
const RECORD: usize = 24;

/// A cell with its certificate, compressed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) cell: EncodedCell,
    pub(super) proof: Vec<u8>,
    /// Length of the certificate before compression.
    pub(super) proof_length: u64,
}

/// An open journal.
#[derive(Debug)]
pub(super) struct Journal {
    file: File,
    path: PathBuf,
    /// Where the payload of each cell lies: offset and length.
    places: BTreeMap<u32, (u64, usize)>,
    end: u64,
}

impl Journal {
    /// Begins a journal, replacing what was there.
    pub(super) fn create(path: &Path, header: &PvsHeader) -> Result<Self, PvsError> {
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        let file = file.map_err(|cause| io_error(path, "written", cause))?;
        lock(&file, path)?;
        let head = head(header);
        let written = file.set_len(0).and_then(|()| (&file).write_all(&head));
        written.map_err(|cause| io_error(path, "written", cause))?;
        Ok(Self {
            file,
            path: path.to_owned(),
            places: BTreeMap::new(),
            end: head.len() as u64,
        })
    }

    /// Goes on with a journal, dropping a record that was cut off; `None` if there is none.
    pub(super) fn resume(path: &Path, header: &PvsHeader) -> Result<Option<Self>, PvsError> {
        let file = match OpenOptions::new().read(true).write(true).open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(cause) => return Err(io_error(path, "read", cause)),
        };
        lock(&file, path)?;
        let mut bytes = Vec::new();
        (&file)
            .read_to_end(&mut bytes)
            .map_err(|cause| io_error(path, "read", cause))?;
        let head = head(header);
        if !bytes.starts_with(&head) {
            return Err(foreign(path, &bytes, &head, header));
        }
        let (places, end) = scan(&bytes, head.len(), header.cells.len());
        file.set_len(end as u64)
            .map_err(|cause| io_error(path, "written", cause))?;
        Ok(Some(Self {
            file,
            path: path.to_owned(),
            places,
            end: end as u64,
        }))
    }

    pub(super) fn cells(&self) -> impl Iterator<Item = u32> {
        self.places.keys().copied()
    }

    pub(super) fn contains(&self, cell: u32) -> bool {
        self.places.contains_key(&cell)
    }

    /// Appends a cell. After an error the journal stands as before.
    pub(super) fn push(&mut self, index: u32, entry: &Entry) -> Result<(), PvsError> {
        let payload = entry.encode();
        let mut record = (payload.len() as u64).to_le_bytes().to_vec();
        record.extend(index.to_le_bytes());
        record.extend([0; 4]);
        let sum = checksum(&[&record[..], &payload].concat());
        record.extend(sum.to_le_bytes());
        record.extend(&payload);
        let written = self
            .file
            .seek(SeekFrom::Start(self.end))
            .and_then(|_| self.file.write_all(&record));
        if let Err(cause) = written {
            // What is left of a failed write is dropped now, or else by the next resume.
            let _ = self.file.set_len(self.end);
            return Err(io_error(&self.path, "written", cause));
        }
        self.places
            .insert(index, (self.end + RECORD as u64, payload.len()));
        self.end += record.len() as u64;
        Ok(())
    }

    /// Reads a cell back; it must have been pushed.
    pub(super) fn entry(&mut self, index: u32) -> Result<Entry, PvsError> {
        let file = self.path.display().to_string();
        let damaged = || {
            PvsError::damaged(
                &file,
                format!("cell {index}"),
                "the record was altered since it was written",
            )
        };
        let (offset, length) = *self.places.get(&index).ok_or_else(damaged)?;
        let mut record = vec![0; RECORD + length];
        let start = SeekFrom::Start(offset - RECORD as u64);
        let read = self
            .file
            .seek(start)
            .and_then(|_| self.file.read_exact(&mut record));
        read.map_err(|cause| io_error(&self.path, "read", cause))?;
        let (_, payload, _) = next_record(&record).ok_or_else(damaged)?;
        Entry::decode(payload).ok_or_else(damaged)
    }

    /// Deletes the file.
    pub(super) fn remove(self) -> Result<(), PvsError> {
        std::fs::remove_file(&self.path).map_err(|cause| io_error(&self.path, "removed", cause))
    }
}

/// One bake at a time may write a journal. Where the file system knows no locks, none is needed.
fn lock(file: &File, path: &Path) -> Result<(), PvsError> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(PvsError::Mismatch {
            file: path.display().to_string(),
            found: "another bake is writing this file".to_owned(),
            advice: "wait for it, or choose another output",
        }),
        _ => Ok(()),
    }
}

fn head(header: &PvsHeader) -> Vec<u8> {
    let provenance = serde_json::to_vec(&header.provenance()).unwrap_or_default();
    let mut head = MAGIC.to_vec();
    head.extend(VERSION.to_le_bytes());
    head.extend((provenance.len() as u32).to_le_bytes());
    head.extend(identity(header));
    head.extend(provenance);
    let sum = checksum(&head);
    head.extend(sum.to_le_bytes());
    head
}

/// Says why a journal cannot be continued.
fn foreign(path: &Path, bytes: &[u8], head: &[u8], header: &PvsHeader) -> PvsError {
    let file = path.display().to_string();
    if !bytes.starts_with(&MAGIC) && !MAGIC.starts_with(bytes) {
        return PvsError::Mismatch {
            file,
            found: "this is no journal of a bake".to_owned(),
            advice: "choose another output, or delete it",
        };
    }
    let theirs: Option<super::model::PvsProvenance> = (|| {
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        serde_json::from_slice(bytes.get(48..48_usize.checked_add(length)?)?).ok()
    })();
    let ours = header.provenance();
    let found = match theirs {
        _ if bytes.len() < head.len() && head.starts_with(bytes) => {
            "it ends before its first cell".to_owned()
        }
        None => "its header is damaged".to_owned(),
        Some(theirs) if theirs.scene != ours.scene => "it was begun with another scene".to_owned(),
        Some(theirs) if theirs.options != ours.options => {
            format!(
                "it was begun with the options {:?}, now they are {:?}",
                theirs.options, ours.options
            )
        }
        Some(theirs) if theirs != ours => {
            "it was begun with another grid, program version or choice of proofs".to_owned()
        }
        Some(_) => "it was begun with other cells or objects".to_owned(),
    };
    PvsError::Mismatch {
        file,
        found,
        advice: "resume with the same scene and options, or delete it and start anew",
    }
}

/// The whole records after the header, and where they end.
fn scan(bytes: &[u8], start: usize, cells: usize) -> (BTreeMap<u32, (u64, usize)>, usize) {
    let mut places = BTreeMap::new();
    let mut at = start;
    while let Some((index, payload, length)) = next_record(&bytes[at..]) {
        if index as usize >= cells || Entry::decode(payload).is_none() {
            break;
        }
        places
            .entry(index)
            .or_insert(((at + RECORD) as u64, payload.len()));
        at += length;
    }
    (places, at)
}

/// Cell, payload and whole length of the record at the front, if it is whole.
fn next_record(bytes: &[u8]) -> Option<(u32, &[u8], usize)> {
    let mut cursor = Cursor::new(bytes);
    let length = usize::try_from(cursor.u64()?).ok()?;
    let index = cursor.u32()?;
    let zero = cursor.u32()?;
    let sum = cursor.u64()?;
    let payload = cursor.take(length)?;
    let intact = zero == 0 && checksum(&[&bytes[..RECORD - 8], payload].concat()) == sum;
    intact.then_some((index, payload, RECORD + length))
}

impl Entry {
    fn encode(&self) -> Vec<u8> {
        let (code, below) = accuracy_code(self.cell.accuracy);
        let mut out = code.to_le_bytes().to_vec();
        out.extend(self.cell.witness_count.to_le_bytes());
        out.extend(below.to_le_bytes());
        out.extend(self.proof_length.to_le_bytes());
        for part in [&self.cell.bitmaps, &self.cell.witnesses, &self.proof] {
            out.extend((part.len() as u64).to_le_bytes());
            out.extend(part);
        }
        out
    }

    fn decode(bytes: &[u8]) -> Option<Self> {
        let mut cursor = Cursor::new(bytes);
        let code = cursor.u32()?;
        let witness_count = cursor.u32()?;
        let accuracy = accuracy(code, cursor.f64()?)?;
        let proof_length = cursor.u64()?;
        let mut part = || {
            let length = usize::try_from(cursor.u64()?).ok()?;
            cursor.take(length).map(<[u8]>::to_vec)
        };
        let (bitmaps, witnesses, proof) = (part()?, part()?, part()?);
        let cell = EncodedCell {
            accuracy,
            bitmaps,
            witnesses,
            witness_count,
        };
        (cursor.remaining() == 0).then_some(Self {
            cell,
            proof,
            proof_length,
        })
    }
}
