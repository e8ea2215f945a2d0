//! Reads any bytes as OBJ.
#![no_main]

mod scene;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| scene::read(bytes, "fuzz.obj"));
