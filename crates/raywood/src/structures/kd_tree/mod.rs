//! The kD-tree: space divided by planes across the axes, each where the surface area heuristic finds it cheapest.

mod build;
mod check;
mod node;
mod split;
mod traverse;

pub use node::KdNode;

use super::{AccelerationStructure, StructureKind};
use crate::build::{BuildMemory, Work};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Hit, Probe, Ray};
use crate::{NodeView, ValidationError};
use node::Content;

/// A kD-tree (Bentley 1975; for rays MacDonald and Booth 1990; Wald and Havran 2006).
///
/// Each interior node divides its cell by a plane; a leaf lists the primitives whose part in its cell is not empty, so a primitive may be
/// in several leaves. Node 0 is the root; the tree of an empty geometry has no node. Built in O(N log^2 N).
///
/// Bounds, whatever the geometry: at most `8 + 1.3 log2 N` levels below the root, 60 in all; the references in all leaves, an empty leaf
/// counted as one, are at most `6 N + 64`, so that there are less than `12 N + 128` nodes. A subtree that has used up its share ends in
/// larger leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct KdTree {
    bounds: Aabb,
    primitives: u32,
    nodes: Vec<KdNode>,
    primitive_indices: Vec<u32>,
}

impl KdTree {
    /// Builds the tree. The same for any number of threads.
    ///
    /// # Errors
    ///
    /// More than 2^29 primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_in(geometry, options, Work::UNWATCHED)
    }

    /// Builds it as a part of some work.
    pub(crate) fn build_in<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        BuildMemory::check(StructureKind::KdTree, geometry.len(), options)?;
        build::build(geometry, options, work)
    }

    /// All nodes; the first is the root.
    pub fn nodes(&self) -> &[KdNode] {
        &self.nodes
    }

    /// The primitives' numbers in the order of the leaves, ascending in each.
    pub fn primitive_indices(&self) -> &[u32] {
        &self.primitive_indices
    }

    /// The box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
}

/// The two parts of a cell on both sides of a plane.
fn halves(cell: &Aabb, axis: usize, position: f32) -> [Aabb; 2] {
    let (mut below, mut above) = (cell.max.to_array(), cell.min.to_array());
    (below[axis], above[axis]) = (position, position);
    [Aabb::new(cell.min, below), Aabb::new(above, cell.max)]
}

impl AccelerationStructure for KdTree {
    #[inline]
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        traverse::closest(self, geometry, ray, probe)
    }

    #[inline]
    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        traverse::occluded(self, geometry, ray, probe)
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        let mut pending = Vec::new();
        pending.extend(self.nodes.first().map(|&root| (root, self.bounds, 0)));
        while let Some((node, bounds, level)) = pending.pop() {
            match node.content() {
                Content::Leaf { count, .. } => {
                    visit(NodeView { bounds, level, references: Some(count) });
                }
                Content::Plane { axis, position, left } => {
                    visit(NodeView { bounds, level, references: None });
                    let halves = halves(&bounds, axis, position);
                    for (child, half) in self.nodes[left..left + 2].iter().zip(halves) {
                        pending.push((*child, half, level + 1));
                    }
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.nodes()) + size_of_val(self.primitive_indices())
    }

    fn primitives(&self) -> usize {
        self.primitives as usize
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        check::validate(self, geometry)
    }
}
