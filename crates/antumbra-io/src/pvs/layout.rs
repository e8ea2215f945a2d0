//! The frame of a `.pvs` file: a header, a table of sections, the sections; each with a checksum.

use std::ops::Range;

use super::error::PvsError;
use crate::bytes::Cursor;

/// As in PNG: a byte no text begins with, the name, and line ends that a careless copy would
/// change.
pub(super) const MAGIC: [u8; 8] = *b"\x89PVS\r\n\x1a\n";
pub(super) const VERSION: u32 = 1;
const HEADER: usize = 32;
const ENTRY: usize = 32;
/// Sections begin at multiples of this.
const ALIGN: usize = 8;

/// The sections, in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub(super) enum Section {
    /// Provenance as JSON.
    Provenance,
    /// Object names.
    Names,
    /// Three corners of each polygon, compressed.
    Planes,
    /// The table of cells.
    Cells,
    /// Cell names.
    CellNames,
    /// Box hierarchy for looking up points.
    Lookup,
    /// Bitmaps of each cell.
    Bitmaps,
    /// Witnesses of each cell, compressed.
    Witnesses,
}

pub(super) const SECTIONS: [(Section, &[u8; 4]); 8] = [
    (Section::Provenance, b"PROV"),
    (Section::Names, b"NAME"),
    (Section::Planes, b"PLAN"),
    (Section::Cells, b"CELL"),
    (Section::CellNames, b"CNAM"),
    (Section::Lookup, b"LOOK"),
    (Section::Bitmaps, b"BITS"),
    (Section::Witnesses, b"WITN"),
];

/// Where a section lies, and what its bytes must sum up to.
#[derive(Clone, Debug)]
pub(super) struct Extent {
    pub(super) range: Range<usize>,
    pub(super) checksum: u64,
}

/// A BLAKE3 hash.
pub(crate) fn hash(bytes: &[u8]) -> [u8; 32] {
    *blake3::hash(bytes).as_bytes()
}

/// The first eight bytes of the BLAKE3 hash, little-endian.
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let hash = hash(bytes);
    u64::from_le_bytes([
        hash[0], hash[1], hash[2], hash[3], hash[4], hash[5], hash[6], hash[7],
    ])
}

/// Puts sections together to a file.
pub(super) fn assemble(sections: [&[u8]; 8]) -> Vec<u8> {
    let start = HEADER + ENTRY * SECTIONS.len();
    let mut table = Vec::new();
    let mut at = start;
    for ((_, tag), data) in SECTIONS.iter().zip(sections) {
        table.extend(*tag);
        table.extend([0; 4]);
        table.extend((at as u64).to_le_bytes());
        table.extend((data.len() as u64).to_le_bytes());
        table.extend(checksum(data).to_le_bytes());
        at = (at + data.len()).next_multiple_of(ALIGN);
    }
    let mut out = Vec::with_capacity(at);
    out.extend(MAGIC);
    out.extend(VERSION.to_le_bytes());
    out.extend((SECTIONS.len() as u32).to_le_bytes());
    out.extend((at as u64).to_le_bytes());
    let sum = checksum(&[&out[..], &table].concat());
    out.extend(sum.to_le_bytes());
    out.extend(table);
    for data in sections {
        out.extend(data);
        out.resize(out.len().next_multiple_of(ALIGN), 0);
    }
    out
}

/// Reads and checks the header and the table; the sections' own checksums are for the caller.
pub(super) fn dissect(file: &str, bytes: &[u8]) -> Result<Vec<Extent>, PvsError> {
    let damaged = |place: &str, found: String| PvsError::damaged(file, place, found);
    if !bytes.starts_with(&MAGIC) {
        return Err(PvsError::Damaged {
            file: file.to_owned(),
            place: "byte 0".to_owned(),
            found: if bytes.is_empty() {
                "the file is empty"
            } else {
                "this is no .pvs file"
            }
            .to_owned(),
            advice: "give a file that `antumbra bake` wrote",
        });
    }
    let mut cursor = Cursor::new(bytes);
    cursor.take(MAGIC.len());
    let short = || {
        damaged(
            "the header",
            format!("the file ends after {} bytes", bytes.len()),
        )
    };
    let version = cursor.u32().ok_or_else(short)?;
    if version != VERSION {
        return Err(PvsError::Damaged {
            file: file.to_owned(),
            place: "byte 8".to_owned(),
            found: format!("format version {version}, this program reads version {VERSION}"),
            advice: "use a newer program or bake the scene anew",
        });
    }
    let count = cursor.u32().ok_or_else(short)?;
    let length = cursor.u64().ok_or_else(short)?;
    let sum = cursor.u64().ok_or_else(short)?;
    if count as usize != SECTIONS.len() {
        return Err(damaged(
            "byte 12",
            format!("{count} sections, expected {}", SECTIONS.len()),
        ));
    }
    if length != bytes.len() as u64 {
        let found = format!(
            "{length} bytes are promised, but the file has {}",
            bytes.len()
        );
        return Err(damaged("the header", found));
    }
    let table = cursor.take(ENTRY * SECTIONS.len()).ok_or_else(short)?;
    if checksum(&[&bytes[..HEADER - 8], table].concat()) != sum {
        return Err(damaged(
            "the header",
            "the checksum does not match".to_owned(),
        ));
    }
    let mut cursor = Cursor::new(table);
    let mut extents = Vec::with_capacity(SECTIONS.len());
    for (_, tag) in SECTIONS {
        let name = String::from_utf8_lossy(tag);
        let place = format!("section {name}");
        let found_tag = cursor.array::<4>().ok_or_else(short)?;
        let zero = cursor.u32().ok_or_else(short)?;
        let offset = cursor.u64().ok_or_else(short)?;
        let length = cursor.u64().ok_or_else(short)?;
        let checksum = cursor.u64().ok_or_else(short)?;
        if found_tag != *tag || zero != 0 {
            return Err(damaged(
                &place,
                "another section stands in its place".to_owned(),
            ));
        }
        let end = offset
            .checked_add(length)
            .filter(|end| *end <= bytes.len() as u64);
        let end =
            end.ok_or_else(|| damaged(&place, "it runs past the end of the file".to_owned()))?;
        extents.push(Extent {
            range: offset as usize..end as usize,
            checksum,
        });
    }
    Ok(extents)
}

/// The bytes of a section, once its checksum has been compared.
pub(super) fn checked<'b>(
    file: &str,
    bytes: &'b [u8],
    extents: &[Extent],
    section: Section,
) -> Result<&'b [u8], PvsError> {
    let extent = &extents[section as usize];
    let data = &bytes[extent.range.clone()];
    if checksum(data) == extent.checksum {
        return Ok(data);
    }
    let name = String::from_utf8_lossy(SECTIONS[section as usize].1);
    Err(PvsError::damaged(
        file,
        format!("section {name}"),
        "the checksum does not match, bytes were altered",
    ))
}

/// A list of texts: their count, the end of each, then the texts.
pub(super) fn encode_texts<'a>(texts: impl Iterator<Item = &'a str> + Clone) -> Vec<u8> {
    let mut out = (texts.clone().count() as u32).to_le_bytes().to_vec();
    let mut end = 0_u32;
    for text in texts.clone() {
        end += text.len() as u32;
        out.extend(end.to_le_bytes());
    }
    for text in texts {
        out.extend(text.as_bytes());
    }
    out
}

/// Where each text of a list lies, relative to the list's bytes; `None` if the list is damaged.
pub(super) fn decode_texts(bytes: &[u8]) -> Option<Vec<Range<usize>>> {
    let mut cursor = Cursor::new(bytes);
    let count = cursor.u32()? as usize;
    let mut ends = Cursor::new(cursor.take(count.checked_mul(4)?)?);
    let base = cursor.offset();
    let mut start = base;
    let mut ranges = Vec::with_capacity(count);
    for _ in 0..count {
        let end = base + ends.u32()? as usize;
        std::str::from_utf8(bytes.get(start..end)?).ok()?;
        ranges.push(start..end);
        start = end;
    }
    (start == bytes.len()).then_some(ranges)
}
