//! Loads whatever bytes as the image of textures.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::image(bytes));
