//! Loads whatever bytes as a scene file.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::scene_file(bytes));
