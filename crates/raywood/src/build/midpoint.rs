//! Midpoint splits: the lecture's first builder.

use super::driver::{Set, Split, Splitter, partition_by, split_at_median};
use crate::{Aabb, BuildOptions};

/// Splits in the middle of the node's longest axis, until a set is small enough to be a leaf.
pub(super) struct Midpoint {
    max_leaf_size: usize,
}

impl Midpoint {
    pub(super) fn new(options: &BuildOptions) -> Self {
        Self { max_leaf_size: options.clamped().max_leaf_size }
    }
}

impl Splitter for Midpoint {
    fn split(&self, set: &mut Set<'_>) -> Option<Split> {
        if set.primitives.len() <= self.max_leaf_size {
            return None;
        }
        let node = Aabb::from(set.around.bounds);
        let axis = (0.5 * node.max - 0.5 * node.min).max_axis();
        let middle = node.center()[axis];
        let split = partition_by(set, |primitive| primitive.center()[axis] < middle);
        // Everything on one side: as good as no split.
        Some(split.unwrap_or_else(|| split_at_median(set)))
    }
}
