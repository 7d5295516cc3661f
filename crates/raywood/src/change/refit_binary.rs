//! The binary tree with new boxes for primitives that moved.

use super::{RefitError, check_primitives};
use crate::Geometry;
use crate::build::PackedAabb;
use crate::parallel::join_if;
use crate::structures::wide::Cost;
use crate::structures::{Bvh2, Node};

/// Subtrees with more nodes below them are refitted in parallel.
const PARALLEL_NODES: usize = 4096;

impl Bvh2 {
    /// Makes all boxes anew for a geometry in which the same primitives have moved, and returns the expected cost [`Q`](crate::StructureStats::q) of the tree as it is then. O(N), in
    /// parallel in the caller's rayon pool, with the same result for any number of threads.
    ///
    /// # Errors
    ///
    /// Another number of primitives, or (from a geometry of your own) one whose box is empty or not finite. The tree then stays as it was.
    pub fn refit<G: Geometry>(&mut self, geometry: &G) -> Result<f64, RefitError> {
        check_primitives(geometry, self.primitive_indices().len())?;
        let (nodes, indices) = self.nodes_mut();
        let Some((root, below)) = nodes.split_first_mut() else { return Ok(0.0) };
        let cost = Refit { geometry, indices }.node(root, below);
        Ok(cost.within(&root.bounds()))
    }
}

/// Boxes that are being made anew.
struct Refit<'a, G> {
    geometry: &'a G,
    indices: &'a [u32],
}

impl<G: Geometry> Refit<'_, G> {
    /// Refits a node and all below it, which lie side by side: first its children, then what is below the left one. Tells what they cost together.
    fn node(&self, node: &mut Node, below: &mut [Node]) -> Cost {
        let mut cost = Cost::default();
        if node.is_leaf() {
            let first = node.left_first() as usize;
            let primitives = &self.indices[first..][..node.count() as usize];
            let boxes = primitives.iter().map(|&primitive| self.geometry.bounds(primitive));
            let bounds = boxes.map(PackedAabb::from).fold(PackedAabb::EMPTY, PackedAabb::union);
            *node = node.with_bounds(bounds.into());
            cost.add(bounds.half_area(), primitives.len());
            return cost;
        }
        let first = node.left_first() as usize;
        let (pair, below) = below.split_at_mut(2);
        let below_left = match pair[1].is_leaf() {
            true => below.len(),
            false => pair[1].left_first() as usize - (first + 2),
        };
        let is_large = below.len() > PARALLEL_NODES;
        let (left_below, right_below) = below.split_at_mut(below_left);
        let (left, right) = pair.split_at_mut(1);
        let (left, right) = (&mut left[0], &mut right[0]);
        let (left_cost, right_cost) =
            join_if(is_large, || self.node(left, left_below), || self.node(right, right_below));
        let bounds = PackedAabb::from(left.bounds()).union(right.bounds().into());
        *node = node.with_bounds(bounds.into());
        cost.add(bounds.half_area(), 0);
        cost.add_all(&left_cost);
        cost.add_all(&right_cost);
        cost
    }
}
