//! What a tree is like: counts, depth, memory, quality.

use std::fmt;

use crate::structures::Bvh2;
use crate::{Aabb, BuildOptions};

/// Counts and quality of a tree.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TreeStats {
    /// Primitives in the tree.
    pub primitives: usize,
    /// All nodes.
    pub nodes: usize,
    /// Leaves among them.
    pub leaves: usize,
    /// Levels, the root's counted; 0 for an empty tree.
    pub depth: usize,
    /// The largest number of primitives in a leaf.
    pub max_leaf_primitives: usize,
    /// The mean number of primitives in a leaf.
    pub mean_leaf_primitives: f64,
    /// Bytes of nodes and primitive indices.
    pub bytes: usize,
    /// The expected cost of a ray that hits the root's box, `Q = sum over nodes of P(node) * (C_aabb + N_tri * C_tri)`
    /// with `P` the node's surface area over the root's (Goldsmith and Salmon 1987; MacDonald and Booth 1990).
    pub q: f64,
}

impl TreeStats {
    /// Measures a tree; the options give the costs in `Q`.
    pub fn of(tree: &Bvh2, options: &BuildOptions) -> Self {
        let (c_aabb, c_tri) = (f64::from(options.node_cost), f64::from(options.primitive_cost));
        let mut stats = Self {
            primitives: tree.primitive_indices().len(),
            nodes: tree.nodes().len(),
            bytes: size_of_val(tree.nodes()) + size_of_val(tree.primitive_indices()),
            ..Self::default()
        };
        let root_area = half_area(&tree.bounds());

        // Depth first, with each node's level.
        let mut pending = Vec::new();
        pending.extend(tree.nodes().first().map(|root| (root, 1)));
        while let Some((node, level)) = pending.pop() {
            let probability =
                if root_area > 0.0 { half_area(&node.bounds()) / root_area } else { 1.0 };
            stats.q += probability * (c_aabb + f64::from(node.count()) * c_tri);
            stats.depth = stats.depth.max(level);
            if node.is_leaf() {
                stats.leaves += 1;
                stats.max_leaf_primitives = stats.max_leaf_primitives.max(node.count() as usize);
            } else {
                pending.extend(tree.children(node).map(|child| (child, level + 1)));
            }
        }
        stats.mean_leaf_primitives = stats.primitives as f64 / stats.leaves.max(1) as f64;
        stats
    }
}

/// Half the surface area in double precision, zero when empty.
fn half_area(bounds: &Aabb) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let [x, y, z] = [0, 1, 2].map(|axis| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]));
    x * y + y * z + z * x
}

impl fmt::Display for TreeStats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} primitives, {} nodes ({} leaves of {:.1} primitives on average, {} at most), depth {}, {:.1} MB, Q {:.1}",
            self.primitives,
            self.nodes,
            self.leaves,
            self.mean_leaf_primitives,
            self.max_leaf_primitives,
            self.depth,
            self.bytes as f64 / 1e6,
            self.q
        )
    }
}
