//! Statistics and invariants of the octree.

use super::cell::{Placement, middle, octant};
use super::{MAX_LEVELS, Octree};
use crate::build::PackedAabb;
use crate::{Aabb, BuildOptions, Geometry, StructureStats, ValidationError};

impl Octree {
    /// Measures the tree; the options give the costs in `Q`.
    pub(super) fn measure(&self, options: &BuildOptions) -> StructureStats {
        let (c_aabb, c_tri) = (f64::from(options.node_cost), f64::from(options.primitive_cost));
        let mut stats = StructureStats {
            primitives: self.primitives as usize,
            references: self.references.len(),
            nodes: self.nodes.len(),
            bytes: size_of_val(&self.nodes[..]) + size_of_val(&self.references[..]),
            ..StructureStats::default()
        };
        let half_area = |cell: &Aabb| PackedAabb::from(*cell).half_area();
        let mut q = 0.0;

        // Depth first, with each node's cell and level.
        let mut pending = Vec::new();
        pending.extend(self.nodes.first().map(|&root| (root, self.bounds, 1)));
        while let Some((node, cell, level)) = pending.pop() {
            let root_area = half_area(&self.bounds);
            let probability = if root_area > 0.0 { half_area(&cell) / root_area } else { 1.0 };
            q += probability * (c_aabb + node.count() as f64 * c_tri);
            stats.depth = stats.depth.max(level);
            stats.leaves += usize::from(node.count() > 0);
            stats.max_leaf_primitives = stats.max_leaf_primitives.max(node.count());

            let middle = middle(&cell);
            for number in (0..8).filter(|number| node.octants() >> number & 1 == 1) {
                let child = self.nodes[node.child(number)];
                pending.push((child, octant(&cell, middle, number), level + 1));
            }
        }
        stats.q = Some(q);
        stats.mean_leaf_primitives = stats.references as f64 / stats.leaves.max(1) as f64;
        stats
    }

    /// Checks that every node is reached once and not too deep, and that every leaf refers to exactly the primitives that overlap its
    /// cell, in order. That octants fill their cell needs no check: their boxes are computed, not stored.
    pub(super) fn check<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        let primitives = geometry.len();
        if primitives != self.primitives as usize || self.nodes.is_empty() != (primitives == 0) {
            return Err(ValidationError::NodeCount { nodes: self.nodes.len(), primitives });
        }
        let placement = Placement::new(geometry, &self.bounds);
        let all: Vec<u32> = (0..self.primitives).collect();
        for &primitive in &all {
            let (bounds, content) = (self.bounds, geometry.bounds(primitive));
            if !bounds.contains(&content) {
                return Err(ValidationError::NotEnclosed { node: 0, bounds, content });
            }
        }

        // Depth first, with each node's cell, level, and the primitives that must be below it.
        let (mut nodes_reached, mut references_reached) = (0, 0);
        let mut pending = Vec::new();
        pending.extend(self.nodes.first().map(|_| (0, self.bounds, 1, all)));
        while let Some((number, cell, depth, expected)) = pending.pop() {
            let bad_reference = ValidationError::BadReference { node: number };
            let node = self.nodes.get(number).ok_or_else(|| bad_reference.clone())?;
            nodes_reached += 1;
            if nodes_reached > self.nodes.len() {
                return Err(ValidationError::NodeReached { node: number, times: 2 });
            }
            if depth > MAX_LEVELS {
                return Err(ValidationError::TooDeep { depth });
            }
            if node.count() > 0 {
                let first = node.first as usize;
                let found =
                    self.references.get(first..first + node.count()).ok_or(bad_reference)?;
                if found != expected {
                    return Err(ValidationError::WrongContent { node: number });
                }
                references_reached += found.len();
                continue;
            }

            let middle = middle(&cell);
            let mut lists = [const { Vec::new() }; 8];
            for primitive in expected {
                let bounds = geometry.bounds(primitive);
                let octants = placement.octants(primitive, &bounds, &cell, middle);
                for (octant, list) in lists.iter_mut().enumerate() {
                    if octants >> octant & 1 == 1 {
                        list.push(primitive);
                    }
                }
            }
            for (octant_number, list) in lists.into_iter().enumerate() {
                if (node.octants() >> octant_number & 1 == 1) == list.is_empty() {
                    return Err(ValidationError::WrongContent { node: number });
                }
                if !list.is_empty() {
                    let child = octant(&cell, middle, octant_number);
                    pending.push((node.child(octant_number), child, depth + 1, list));
                }
            }
        }
        if nodes_reached != self.nodes.len() || references_reached != self.references.len() {
            return Err(ValidationError::NodeCount { nodes: self.nodes.len(), primitives });
        }
        Ok(())
    }
}
