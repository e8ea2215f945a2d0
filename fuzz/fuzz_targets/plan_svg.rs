//! Reads any bytes as a plan of SVG.
#![no_main]

mod plan;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| plan::read(bytes, "fuzz.svg"));
