//! Loads whatever bytes as an OBJ file and, after a byte of zero, its material library.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::obj(bytes));
