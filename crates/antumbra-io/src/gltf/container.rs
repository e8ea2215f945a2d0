//! The binary container: a header, a JSON chunk, a binary chunk.

use crate::bytes::Cursor;
use crate::error::{Damage, Place};

pub(super) const MAGIC: &[u8; 4] = b"glTF";
pub(super) const JSON_CHUNK: u32 = 0x4E4F_534A;
pub(super) const BINARY_CHUNK: u32 = 0x004E_4942;

/// The JSON text and, if there is one, the binary chunk.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Damage> {
    let mut cursor = Cursor::new(bytes);
    let short = || {
        let found = format!(
            "the file ends after {} bytes, inside its header",
            bytes.len()
        );
        Damage::broken(Place::Byte(bytes.len() as u64), found)
    };
    if cursor.take(MAGIC.len()).ok_or_else(short)? != MAGIC {
        return Err(Damage::new(
            Place::Byte(0),
            "this is no GLB file, which begins with the letters glTF",
            "give a glTF, GLB, OBJ, PLY or STL file",
        ));
    }
    let version = cursor.u32().ok_or_else(short)?;
    if version != 2 {
        let found = format!("GLB version {version}, expected 2");
        return Err(Damage::new(Place::Byte(4), found, "convert it to glTF 2.0"));
    }
    let length = cursor.u32().ok_or_else(short)?;
    if length as usize > bytes.len() {
        let found = format!(
            "the header promises {length} bytes, but the file ends after {}",
            bytes.len()
        );
        return Err(Damage::broken(Place::Byte(bytes.len() as u64), found));
    }
    let mut cursor = Cursor::new(&bytes[..length as usize]);
    cursor.take(12).ok_or_else(short)?;
    let (kind, json) = chunk(&mut cursor)?;
    if kind != JSON_CHUNK {
        let found = format!("the first chunk has type {kind:#010x}, expected JSON");
        return Err(Damage::broken(Place::Byte(16), found));
    }
    // Chunks of unknown type may follow and are passed over.
    while cursor.remaining() > 0 {
        if let (BINARY_CHUNK, binary) = chunk(&mut cursor)? {
            return Ok((json, Some(binary)));
        }
    }
    Ok((json, None))
}

fn chunk<'a>(cursor: &mut Cursor<'a>) -> Result<(u32, &'a [u8]), Damage> {
    let start = cursor.offset() as u64;
    let cut = |found: String| Damage::broken(Place::Byte(start), found);
    let ended = || cut("a chunk begins here, but its header is cut off".to_owned());
    let length = cursor.u32().ok_or_else(ended)?;
    let kind = cursor.u32().ok_or_else(ended)?;
    let room = cursor.remaining();
    let data = cursor
        .take(length as usize)
        .ok_or_else(|| cut(format!("a chunk of {length} bytes, but only {room} follow")))?;
    Ok((kind, data))
}
