//! Writes a `.pvs` file cell by cell, in any order, so that nothing finished is ever lost.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::encode::{Assembly, EncodedCell, io_error};
use super::error::PvsError;
use super::journal::{Entry, Journal};
use super::layout::hash;
use super::model::{CellRecord, PvsHeader};
use super::record::compress;
use crate::proof::ProofAssembly;

/// A `.pvs` file in the making.
///
/// Finished cells go to a journal beside it, `F.pvs.part`; [`PvsWriter::finish`] turns the journal
/// into `F.pvs` and `F.proof`. Until then nothing exists under the final names. The result is the
/// same bytes for any order of cells and any number of interruptions. Many threads may push at
/// once: cells are encoded and compressed outside of the lock.
///
/// ```no_run
/// # use antumbra_io::{PvsWriter, PvsError};
/// # fn bake(header: antumbra_io::pvs::PvsHeader, bake_cell: impl Fn(u32) -> (antumbra_io::pvs::CellRecord, Vec<u8>)) -> Result<(), PvsError> {
/// let cells = header.cells.len() as u32;
/// let (writer, done) = PvsWriter::resume("level.pvs".as_ref(), header)?;
/// for cell in (0..cells).filter(|cell| !done.contains(cell)) {
///     let (record, proof) = bake_cell(cell);
///     writer.push_cell(cell, &record, &proof)?;
/// }
/// writer.finish()?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct PvsWriter {
    header: PvsHeader,
    path: PathBuf,
    journal: Mutex<Journal>,
}

/// What [`PvsWriter::finish`] wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finished {
    /// Size of the `.pvs` file.
    pub pvs_bytes: u64,
    /// Size of the `.proof` file, if there is one.
    pub proof_bytes: Option<u64>,
    /// Where the `.proof` file is, if there is one.
    pub proof: Option<PathBuf>,
}

impl PvsWriter {
    /// Begins a new bake to `path`. An older journal of that path is discarded; an older result
    /// stays until the new one is finished.
    ///
    /// # Errors
    /// If the journal cannot be written, or another bake is writing it.
    pub fn create(path: &Path, header: PvsHeader) -> Result<Self, PvsError> {
        check_path(path)?;
        let journal = Journal::create(&Self::journal_path(path), &header)?;
        Ok(Self {
            header,
            path: path.to_owned(),
            journal: Mutex::new(journal),
        })
    }

    /// Goes on with an interrupted bake and says which cells are finished; begins a new one if
    /// there is no journal.
    ///
    /// # Errors
    /// If the journal belongs to another scene, other options or other cells, or cannot be read
    /// and written.
    pub fn resume(path: &Path, header: PvsHeader) -> Result<(Self, BTreeSet<u32>), PvsError> {
        check_path(path)?;
        let Some(journal) = Journal::resume(&Self::journal_path(path), &header)? else {
            return Ok((Self::create(path, header)?, BTreeSet::new()));
        };
        let done = journal.cells().collect();
        Ok((
            Self {
                header,
                path: path.to_owned(),
                journal: Mutex::new(journal),
            },
            done,
        ))
    }

    /// Where the journal of a bake to `path` is kept.
    #[must_use]
    pub fn journal_path(path: &Path) -> PathBuf {
        with_suffix(path, ".part")
    }

    /// Where the proofs of a bake to `path` are kept: `F.proof` for `F.pvs`.
    #[must_use]
    pub fn proof_path(path: &Path) -> PathBuf {
        path.with_extension("proof")
    }

    /// Adds the results of a cell and its certificate (ignored if the header wants no proofs).
    /// On return they are in the hands of the operating system.
    ///
    /// # Errors
    /// If the record contradicts itself or the header, the cell was added before, or the journal
    /// cannot be written.
    pub fn push_cell(&self, index: u32, record: &CellRecord, proof: &[u8]) -> Result<(), PvsError> {
        let cell = EncodedCell::new(&self.header, index, record)?;
        let proof = if self.header.proofs { proof } else { &[] };
        let entry = Entry {
            cell,
            proof: compress(proof),
            proof_length: proof.len() as u64,
        };
        let mut journal = self.journal();
        if journal.contains(index) {
            return Err(PvsError::Record {
                cell: index,
                found: "it was added before".to_owned(),
            });
        }
        journal.push(index, &entry)
    }

    /// Writes the final files and removes the journal. Both are written under temporary names
    /// and renamed, the proofs first: who finds `F.pvs` finds it whole, with its proofs.
    ///
    /// # Errors
    /// If a cell is missing or a file cannot be written; the journal stays, so that
    /// [`PvsWriter::resume`] can try again.
    pub fn finish(self) -> Result<Finished, PvsError> {
        let Self {
            header,
            path,
            journal,
        } = self;
        let mut journal = journal.into_inner().unwrap_or_else(PoisonError::into_inner);
        let cells = 0..header.cells.len() as u32;
        if let Some(missing) = cells.clone().find(|cell| !journal.contains(*cell)) {
            let found = "its results are missing".to_owned();
            return Err(PvsError::Record {
                cell: missing,
                found,
            });
        }
        let mut assembly = Assembly::new(&header);
        for cell in cells.clone() {
            assembly.push(&journal.entry(cell)?.cell);
        }
        let bytes = assembly.finish()?;
        let proof_path = Self::proof_path(&path);
        let proof_bytes = if header.proofs {
            let mut size = 0;
            replace(&proof_path, |out| {
                let mut proofs = ProofAssembly::begin(out, hash(&bytes))?;
                for cell in cells {
                    let entry = journal.entry(cell).map_err(std::io::Error::other)?;
                    proofs.push(&entry.proof, entry.proof_length)?;
                }
                size = proofs.finish()?;
                Ok(())
            })?;
            Some(size)
        } else {
            // Proofs of an older result would belong to nothing.
            let removed = fs::remove_file(&proof_path);
            removed
                .or_else(|e| {
                    if e.kind() == std::io::ErrorKind::NotFound {
                        Ok(())
                    } else {
                        Err(e)
                    }
                })
                .map_err(|cause| io_error(&proof_path, "removed", cause))?;
            None
        };
        replace(&path, |out| out.write_all(&bytes))?;
        journal.remove()?;
        Ok(Finished {
            pvs_bytes: bytes.len() as u64,
            proof_bytes,
            proof: proof_bytes.map(|_| proof_path),
        })
    }

    fn journal(&self) -> MutexGuard<'_, Journal> {
        // A journal stands whole after every step, so a panic elsewhere does not harm it.
        self.journal.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The proofs need a name of their own.
fn check_path(path: &Path) -> Result<(), PvsError> {
    if PvsWriter::proof_path(path) != path {
        return Ok(());
    }
    Err(PvsError::Mismatch {
        file: path.display().to_string(),
        found: "this name is taken by the proofs of the result".to_owned(),
        advice: "choose a name that ends in .pvs",
    })
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

/// Writes a file under a temporary name and renames it, so that no half of it is ever seen.
fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), PvsError> {
    let temporary = with_suffix(path, ".tmp");
    let attempt = || {
        let mut out = BufWriter::new(File::create(&temporary)?);
        write(&mut out)?;
        out.into_inner()
            .map_err(|error| error.into_error())?
            .sync_all()?;
        fs::rename(&temporary, path)
    };
    attempt().map_err(|cause| {
        let _ = fs::remove_file(&temporary);
        io_error(path, "written", cause)
    })
}
