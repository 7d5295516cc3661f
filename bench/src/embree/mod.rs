//! Embree 4, loaded at run time from a shared library: what the benchmark needs of it, and no more.

mod ffi;

pub(crate) use ffi::{
    Coherence, Library, Packet, Quality, Record, Robustness, Scene, SharedMesh, Single,
};
