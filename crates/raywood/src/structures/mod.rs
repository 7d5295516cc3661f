//! Acceleration structures, one per file.

mod bvh2;

pub use bvh2::{Bvh2, Node};

/// The most levels a tree may have, the root's counted: what the traversals' stacks hold.
pub(crate) const MAX_DEPTH: usize = 64;
