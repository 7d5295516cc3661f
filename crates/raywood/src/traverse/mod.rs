//! Traversals of the binary tree, one question per file. Written once: generic over the geometry and over a probe
//! that counts what happens and costs nothing when absent.

pub(crate) mod closest;
pub(crate) mod mailbox;
pub(crate) mod margins;
pub(crate) mod nearest;
pub(crate) mod occluded;
mod probe;
pub(crate) mod slab;
pub(crate) mod stack;

pub use probe::{Counts, Probe};
