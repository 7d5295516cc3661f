//! The tests of experiments, one subject per file, in one program.

mod benchmark;
mod comparison;
