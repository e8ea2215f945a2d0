//! Opens any bytes as a `.proof` file and unpacks every certificate.
#![no_main]

use antumbra_io::pvs::CellIndex;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = antumbra_io::ProofFile::from_bytes(bytes.to_vec(), "fuzz.proof") {
        for cell in 0..file.cell_count() as u32 {
            let _ = file.proof(CellIndex(cell));
        }
    }
});
