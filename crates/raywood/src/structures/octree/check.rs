//! The invariants of the octree, checked.

use super::cell::{Placement, middle, octant};
use super::{MAX_LEVELS, Octree};
use crate::{Geometry, ValidationError};

impl Octree {
    /// Checks that every node is reached once and not too deep, and that every leaf refers to exactly the primitives that overlap its
    /// cell, in order. That octants fill their cell needs no check: their boxes are computed, not stored.
    pub(super) fn check<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        let primitives = geometry.len();
        if primitives != self.primitives as usize || self.nodes.is_empty() != (primitives == 0) {
            return Err(ValidationError::NodeCount { nodes: self.nodes.len(), primitives });
        }
        let placement = Placement::new(geometry);
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
