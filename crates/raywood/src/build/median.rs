//! Object median splits: halves by number, whatever the geometry.

use super::PackedAabb;
use super::driver::{Split, Splitter, split_at_median};
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
    fn split(&self, bounds: &[PackedAabb], indices: &mut [u32], _: &PackedAabb) -> Option<Split> {
        (indices.len() > self.max_leaf_size).then(|| split_at_median(bounds, indices))
    }
}
