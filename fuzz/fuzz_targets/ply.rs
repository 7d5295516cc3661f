//! Loads whatever bytes as a PLY file.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::ply(bytes));
