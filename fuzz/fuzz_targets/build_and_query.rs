//! Bytes as a program against the library: builds, queries, changes; see `crates/raywood/tests/library/build_and_query.rs`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| raywood_fuzz::build_and_query(bytes));
