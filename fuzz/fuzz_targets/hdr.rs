//! Loads whatever bytes as a panorama.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::hdr(bytes));
