//! Loads whatever bytes as a glTF file, text or binary.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::gltf(bytes));
