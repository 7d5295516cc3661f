//! What a structure is like: counts, depth, memory, quality.

use std::fmt;

use crate::structures::Bvh2;
use crate::{Aabb, BuildOptions};

/// Counts and quality of a structure.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StructureStats {
    /// Primitives of the geometry.
    pub primitives: usize,
    /// References to primitives: more than primitives where space is divided and a primitive lies in several cells.
    pub references: usize,
    /// All nodes of a hierarchy, all cells of a grid.
    pub nodes: usize,
    /// Leaves among them; of a grid the cells that are not empty.
    pub leaves: usize,
    /// Levels, the root's counted; 0 where there are none.
    pub depth: usize,
    /// The largest number of references in a leaf.
    pub max_leaf_primitives: usize,
    /// The mean number of references in a leaf.
    pub mean_leaf_primitives: f64,
    /// Bytes of the structure, without the geometry.
    pub bytes: usize,
    /// The expected cost of a ray that hits the root's box, `Q = sum over nodes of P(node) * (C_aabb + N_tri * C_tri)`
    /// with `P` the node's surface area over the root's (Goldsmith and Salmon 1987; MacDonald and Booth 1990).
    /// `None` where there is no hierarchy.
    pub q: Option<f64>,
}

impl StructureStats {
    /// Measures a tree; the options give the costs in `Q`.
    pub(crate) fn of_tree(tree: &Bvh2, options: &BuildOptions) -> Self {
        let (c_aabb, c_tri) = (f64::from(options.node_cost), f64::from(options.primitive_cost));
        let mut stats = Self {
            primitives: tree.primitive_indices().len(),
            references: tree.primitive_indices().len(),
            nodes: tree.nodes().len(),
            bytes: size_of_val(tree.nodes()) + size_of_val(tree.primitive_indices()),
            ..Self::default()
        };
        let root_area = half_area(&tree.bounds());
        let mut q = 0.0;

        // Depth first, with each node's level.
        let mut pending = Vec::new();
        pending.extend(tree.nodes().first().map(|root| (root, 1)));
        while let Some((node, level)) = pending.pop() {
            let probability =
                if root_area > 0.0 { half_area(&node.bounds()) / root_area } else { 1.0 };
            q += probability * (c_aabb + f64::from(node.count()) * c_tri);
            stats.depth = stats.depth.max(level);
            if node.is_leaf() {
                stats.leaves += 1;
                stats.max_leaf_primitives = stats.max_leaf_primitives.max(node.count() as usize);
            } else {
                pending.extend(tree.children(node).map(|child| (child, level + 1)));
            }
        }
        stats.q = Some(q);
        stats.mean_leaf_primitives = stats.references as f64 / stats.leaves.max(1) as f64;
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

impl fmt::Display for StructureStats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { primitives, nodes, leaves, depth, .. } = self;
        write!(f, "{primitives} primitives, {nodes} nodes")?;
        write!(f, " ({leaves} leaves of {:.1} primitives", self.mean_leaf_primitives)?;
        write!(f, " on average, {} at most), depth {depth}", self.max_leaf_primitives)?;
        write!(f, ", {:.1} MB", self.bytes as f64 / 1e6)?;
        if self.references != self.primitives {
            write!(
                f,
                ", {:.2} references a primitive",
                self.references as f64 / *primitives as f64
            )?;
        }
        match self.q {
            Some(q) => write!(f, ", Q {q:.1}"),
            None => Ok(()),
        }
    }
}
