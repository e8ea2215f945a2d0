//! Opens any bytes as a `.pvs` file and asks for everything in it; once as they are, once with
//! all checksums made right, so that what is behind them is reached.
#![no_main]

use antumbra_io::PvsFile;
use antumbra_io::export::export;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    ask(bytes.to_vec());
    let mut mended = bytes.to_vec();
    if mend(&mut mended).is_some() {
        ask(mended);
    }
});

fn ask(bytes: Vec<u8>) {
    if let Ok(file) = PvsFile::from_bytes(bytes, "fuzz.pvs") {
        let _ = file.verify();
        let _ = export(&file, true);
        for i in -8..8 {
            let _ = file.cell_at([f64::from(i), f64::from(i * i), 0.5]);
        }
    }
}

/// The layout is that of `docs/formats/pvs.md`: 8 sections, cells of 96 bytes in section 3 with
/// their bitmaps in section 6 and their witnesses in section 7.
fn mend(bytes: &mut [u8]) -> Option<()> {
    let section = |bytes: &[u8], i: usize| {
        let (start, length) = (
            number(bytes, 32 + 32 * i + 8)?,
            number(bytes, 32 + 32 * i + 16)?,
        );
        Some((
            start,
            start
                .checked_add(length)
                .filter(|end| *end <= bytes.len())?,
        ))
    };
    let (cells, cells_end) = section(bytes, 3)?;
    for row in (cells..cells_end.checked_sub(95)?).step_by(96) {
        for (which, at) in [(6, row + 32), (7, row + 56)] {
            let (start, end) = section(bytes, which)?;
            let from = start.checked_add(number(bytes, at)?)?;
            let to = from
                .checked_add(number(bytes, at + 8)?)
                .filter(|to| *to <= end)?;
            put(bytes, at + 16, sum(bytes.get(from..to)?))?;
        }
    }
    for i in 0..8 {
        let (start, end) = section(bytes, i)?;
        put(bytes, 32 + 32 * i + 24, sum(bytes.get(start..end)?))?;
    }
    let head = [bytes.get(..24)?, bytes.get(32..288)?].concat();
    put(bytes, 24, sum(&head))
}

fn number(bytes: &[u8], at: usize) -> Option<usize> {
    let field = bytes.get(at..at.checked_add(8)?)?;
    usize::try_from(u64::from_le_bytes(field.try_into().ok()?)).ok()
}

fn sum(bytes: &[u8]) -> [u8; 32] {
    *blake3::hash(bytes).as_bytes()
}

fn put(bytes: &mut [u8], at: usize, sum: [u8; 32]) -> Option<()> {
    bytes
        .get_mut(at..at.checked_add(8)?)?
        .copy_from_slice(&sum[..8]);
    Some(())
}
