//! The results of one cell as bytes: three bitmaps, and the witnesses.

use std::io::Read;

use roaring::RoaringBitmap;

use super::model::{CellRecord, PvsHeader, WitnessRecord};
use crate::bytes::Cursor;

/// Bytes of a witness before compression.
const WITNESS: usize = 60;
/// Strong enough for the many equal high bytes; more gained less than 2 %.
const LEVEL: i32 = 6;

/// The objects of one cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bitmaps {
    /// All that must not be culled: visible, touching and unknown objects.
    pub(super) visible: RoaringBitmap,
    pub(super) touching: RoaringBitmap,
    pub(super) unknown: RoaringBitmap,
}

/// Says what is wrong with a record, if anything.
pub(super) fn fault(record: &CellRecord, header: &PvsHeader) -> Option<String> {
    let objects = header.objects.len() as u32;
    let visible = record.visible.iter().map(|v| v.object);
    if !visible.clone().is_sorted_by(|a, b| a < b) || !record.unknown.is_sorted_by(|a, b| a < b) {
        return Some("the objects are not in ascending order, each once".to_owned());
    }
    if let Some(bad) = visible
        .chain(record.unknown.iter().copied())
        .find(|o| *o >= objects)
    {
        return Some(format!("object {bad} does not exist, there are {objects}"));
    }
    let seen = |object: &u32| {
        record
            .visible
            .binary_search_by_key(object, |v| v.object)
            .is_ok()
    };
    if let Some(both) = record.unknown.iter().find(|o| seen(o)) {
        return Some(format!("object {both} is both visible and unknown"));
    }
    let polygons = header.planes.len() as u32;
    let witnesses = record.visible.iter().filter_map(|v| v.witness);
    let bad = witnesses
        .map(|w| w.polygon)
        .find(|p| polygons > 0 && *p >= polygons);
    bad.map(|bad| format!("a witness ends on polygon {bad}, but there are {polygons}"))
}

pub(super) fn encode_bitmaps(record: &CellRecord) -> Vec<u8> {
    let touching: RoaringBitmap = record
        .visible
        .iter()
        .filter(|v| v.witness.is_none())
        .map(|v| v.object)
        .collect();
    let unknown: RoaringBitmap = record.unknown.iter().copied().collect();
    let mut visible: RoaringBitmap = record.visible.iter().map(|v| v.object).collect();
    visible |= &unknown;
    let mut lengths = Vec::new();
    let mut bodies = Vec::new();
    for mut bitmap in [visible, touching, unknown] {
        // Runs where they are shorter: one form for one set.
        bitmap.optimize();
        let start = bodies.len();
        // Writing to a vector cannot fail.
        let _ = bitmap.serialize_into(&mut bodies);
        lengths.extend(((bodies.len() - start) as u32).to_le_bytes());
    }
    lengths.extend(bodies);
    lengths
}

/// The bitmaps, or `None` if the bytes are damaged or name an object that does not exist.
pub(super) fn decode_bitmaps(bytes: &[u8], objects: usize) -> Option<Bitmaps> {
    let [visible, touching, unknown] = split(bytes)?;
    let bitmaps = Bitmaps {
        visible: bitmap(visible, objects)?,
        touching: bitmap(touching, objects)?,
        unknown: bitmap(unknown, objects)?,
    };
    let nested = bitmaps.touching.is_subset(&bitmaps.visible)
        && bitmaps.unknown.is_subset(&bitmaps.visible)
        && bitmaps.touching.is_disjoint(&bitmaps.unknown);
    nested.then_some(bitmaps)
}

/// The first of the bitmaps alone: what a renderer asks for in every frame.
pub(super) fn decode_visible(bytes: &[u8], objects: usize) -> Option<RoaringBitmap> {
    bitmap(split(bytes)?[0], objects)
}

fn split(bytes: &[u8]) -> Option<[&[u8]; 3]> {
    let mut cursor = Cursor::new(bytes);
    let lengths = [cursor.u32()?, cursor.u32()?, cursor.u32()?];
    let mut next = |length: u32| cursor.take(length as usize);
    let bodies = [next(lengths[0])?, next(lengths[1])?, next(lengths[2])?];
    (cursor.remaining() == 0).then_some(bodies)
}

fn bitmap(mut bytes: &[u8], objects: usize) -> Option<RoaringBitmap> {
    let bitmap = RoaringBitmap::deserialize_from(&mut bytes).ok()?;
    let in_range = bitmap.max().is_none_or(|max| (max as usize) < objects);
    (bytes.is_empty() && in_range).then_some(bitmap)
}

/// The witnesses, compressed; nothing at all if there are none.
pub(super) fn encode_witnesses(record: &CellRecord) -> (Vec<u8>, u32) {
    let mut raw = Vec::new();
    for visible in &record.visible {
        let Some(witness) = visible.witness else {
            continue;
        };
        raw.extend(visible.object.to_le_bytes());
        raw.extend(witness.polygon.to_le_bytes());
        raw.extend(witness.source.to_le_bytes());
        raw.extend(
            witness
                .from
                .iter()
                .chain(&witness.through)
                .flat_map(|c| c.to_le_bytes()),
        );
    }
    let count = (raw.len() / WITNESS) as u32;
    (compress(&raw), count)
}

/// The witnesses with their objects, or `None` if the bytes are damaged.
pub(super) fn decode_witnesses(bytes: &[u8], count: u32) -> Option<Vec<(u32, WitnessRecord)>> {
    let raw = decompress(bytes, u64::from(count) * WITNESS as u64)?;
    let mut cursor = Cursor::new(&raw);
    let mut out = Vec::with_capacity(raw.len() / WITNESS);
    while cursor.remaining() > 0 {
        let object = cursor.u32()?;
        let polygon = cursor.u32()?;
        let source = cursor.u32()?;
        let mut three = || Some([cursor.i64()?, cursor.i64()?, cursor.i64()?]);
        out.push((
            object,
            WitnessRecord {
                polygon,
                source,
                from: three()?,
                through: three()?,
            },
        ));
    }
    Some(out)
}

/// Zstandard; nothing stays nothing. The same bytes give the same bytes.
pub(crate) fn compress(raw: &[u8]) -> Vec<u8> {
    if raw.is_empty() {
        return Vec::new();
    }
    // Compressing memory to memory has no way to fail.
    zstd::bulk::compress(raw, LEVEL).unwrap_or_default()
}

/// The `length` bytes that were compressed; `None` if they are damaged or of another length.
/// Sets no more memory aside than the data really unpacks to, whatever `length` claims.
pub(crate) fn decompress(bytes: &[u8], length: u64) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    if !bytes.is_empty() {
        let decoder = zstd::stream::read::Decoder::with_buffer(bytes).ok()?;
        decoder
            .take(length.checked_add(1)?)
            .read_to_end(&mut out)
            .ok()?;
    }
    (out.len() as u64 == length).then_some(out)
}
