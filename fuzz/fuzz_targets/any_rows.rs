//! Reads whatever bytes as rays or points of `raywood query`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::any_rows(bytes));
