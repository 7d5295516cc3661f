//! Traversals of the binary tree, one question per file, and of packets of rays. Written once: generic over the geometry and over a probe
//! that counts what happens and costs nothing when absent.

pub(crate) mod closest;
mod coherence;
pub(crate) mod mailbox;
pub(crate) mod margins;
pub(crate) mod nearest;
pub(crate) mod occluded;
mod packet;
mod probe;
pub(crate) mod slab;
pub(crate) mod stack;

pub use coherence::Coherence;
pub use probe::{Counts, Probe};
