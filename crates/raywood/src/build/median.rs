//! Object median splits: halves by number, whatever the geometry.

use super::driver::{Set, Split, Splitter, split_at_median};
use crate::BuildOptions;

/// Halves the set along the axis on which the centroids spread most, until it is small enough to be a leaf: the balanced tree.
pub(super) struct Median {
    max_leaf_size: usize,
}

impl Median {
    pub(super) fn new(options: &BuildOptions) -> Self {
        Self { max_leaf_size: options.clamped().max_leaf_size }
    }
}

impl Splitter for Median {
    fn split(&self, set: &mut Set<'_>) -> Option<Split> {
        (set.primitives.len() > self.max_leaf_size).then(|| split_at_median(set))
    }
}
