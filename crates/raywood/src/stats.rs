//! What a structure is like: counts, levels, memory, quality. Measured in one way for all structures, from the nodes they show.

use std::fmt;

use crate::structures::AccelerationStructure;
use crate::{Aabb, BuildOptions};

/// A node of a hierarchy or a cell of a grid, as [`AccelerationStructure::visit_nodes`] shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeView {
    /// The node's box, or the cell.
    pub bounds: Aabb,
    /// The root's level is 0.
    pub level: usize,
    /// How many primitives a leaf refers to, which may be none; `None` where there are further nodes inside.
    pub references: Option<usize>,
}

/// What lies on a level of a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Level {
    /// Nodes, leaves counted.
    pub nodes: usize,
    /// Leaves, empty ones counted.
    pub leaves: usize,
    /// References in these leaves.
    pub references: usize,
}

/// Counts and quality of a structure.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StructureStats {
    /// Primitives of the geometry.
    pub primitives: usize,
    /// References to primitives: more than primitives where space is divided and a primitive lies in several cells.
    pub references: usize,
    /// All nodes. A grid counts as one, and so does each of its cells; brute force has one, with everything in it.
    pub nodes: usize,
    /// Leaves among them, empty ones counted.
    pub leaves: usize,
    /// Leaves that refer to nothing.
    pub empty_leaves: usize,
    /// Levels, the root's counted; 0 if there is nothing.
    pub depth: usize,
    /// What lies on each level, the root's first.
    pub levels: Vec<Level>,
    /// The largest number of references in a leaf.
    pub max_leaf_primitives: usize,
    /// The mean number of references in a leaf that is not empty.
    pub mean_leaf_primitives: f64,
    /// Bytes of the structure, without the geometry.
    pub bytes: usize,
    /// The expected cost of a ray that passes through the root's box and hits nothing, `Q = sum over nodes of
    /// P(node) * (C_aabb + N_tri * C_tri)` with `P` the node's surface area over the root's (Goldsmith and Salmon 1987; MacDonald
    /// and Booth 1990).
    ///
    /// The costs are always those of the default [`BuildOptions`], and cells count as boxes, so that any two structures can be
    /// compared. A ray that hits something stops early, which `Q` does not know; and a ray tests a primitive once, in however
    /// many cells `Q` counts it.
    pub q: f64,
}

impl StructureStats {
    /// Measures a structure.
    pub(crate) fn of(structure: &impl AccelerationStructure) -> Self {
        let BuildOptions { node_cost, primitive_cost, .. } = BuildOptions::default();
        let (c_aabb, c_tri) = (f64::from(node_cost), f64::from(primitive_cost));
        let (primitives, bytes) = (structure.primitives(), structure.bytes());
        let mut stats = Self { primitives, bytes, ..Self::default() };
        let mut root_area = 0.0;
        structure.visit_nodes(&mut |node| {
            if node.level == 0 {
                root_area = node.bounds.half_area();
            }
            if node.level >= stats.levels.len() {
                stats.levels.resize(node.level + 1, Level::default());
            }
            let level = &mut stats.levels[node.level];
            level.nodes += 1;
            if let Some(references) = node.references {
                level.leaves += 1;
                level.references += references;
                stats.empty_leaves += usize::from(references == 0);
                stats.max_leaf_primitives = stats.max_leaf_primitives.max(references);
            }

            // A root without area is a point or a line, and then so is everything in it: every ray that meets it meets all.
            let probability = match root_area > 0.0 {
                true => node.bounds.half_area() / root_area,
                false => 1.0,
            };
            stats.q += probability * (c_aabb + node.references.unwrap_or(0) as f64 * c_tri);
        });

        stats.depth = stats.levels.len();
        for level in &stats.levels {
            stats.nodes += level.nodes;
            stats.leaves += level.leaves;
            stats.references += level.references;
        }
        let filled = stats.leaves - stats.empty_leaves;
        stats.mean_leaf_primitives = stats.references as f64 / filled.max(1) as f64;
        stats
    }

    /// References per primitive, 1 where every primitive lies in one leaf; 0 if there are no primitives.
    pub fn duplication(&self) -> f64 {
        self.references as f64 / self.primitives.max(1) as f64
    }
}

impl fmt::Display for StructureStats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { primitives, nodes, leaves, empty_leaves, depth, .. } = self;
        write!(f, "{primitives} primitives, {nodes} nodes")?;
        let filled = leaves - empty_leaves;
        write!(f, " ({filled} leaves of {:.1} primitives", self.mean_leaf_primitives)?;
        write!(f, " on average, {} at most", self.max_leaf_primitives)?;
        if *empty_leaves > 0 {
            write!(f, ", {empty_leaves} empty")?;
        }
        write!(f, "), depth {depth}, {:.1} MB", self.bytes as f64 / 1e6)?;
        if self.references != self.primitives {
            write!(f, ", {:.2} references a primitive", self.duplication())?;
        }
        write!(f, ", Q {:.1}", self.q)
    }
}
