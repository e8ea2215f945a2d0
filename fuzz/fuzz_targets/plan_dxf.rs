//! Reads any bytes as a plan of DXF.
#![no_main]

mod plan;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| plan::read(bytes, "fuzz.dxf"));
