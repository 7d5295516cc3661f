//! Loads whatever bytes as an STL file.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::stl(bytes));
