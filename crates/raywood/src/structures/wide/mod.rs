//! The wide tree: sixteen children a node and eight triangles a leaf, so that one vector instruction tests them all.

mod batch;
mod build;
mod check;
mod collapse;
mod node;
mod single;
mod step;
#[cfg(test)]
mod tests;

use super::AccelerationStructure;
use crate::geometry::TriangleBlock;
use crate::simd::{SimdLevel, dispatch_on};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Hit, NodeView, Probe, Ray, ValidationError};
use node::{Reference, WideNode};

/// A bounding volume hierarchy of sixteen children a node, over triangles in blocks of eight, traced by vector instructions: see
/// [`SimdLevel`].
///
/// It is made from a binary tree of the surface area heuristic, improved by [reinsertion](BuildOptions::reinsertion_passes), by the collapse that the heuristic finds best (Ylitie, Karras and Laine, "Efficient
/// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017). Batches are traced many rays at a time.
/// Primitives that are no [triangles](Geometry::triangle) are tested one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct WideBvh {
    bounds: Aabb,
    primitives: u32,
    /// How many nodes lie on the longest way from the root to a leaf.
    depth: usize,
    /// The node or leaf that holds everything; [`Reference::NOTHING`] if there is nothing.
    root: Reference,
    nodes: Vec<WideNode>,
    blocks: Vec<TriangleBlock>,
    /// The instructions that trace it.
    level: SimdLevel,
}

impl WideBvh {
    /// Builds the tree. The same for any number of threads and any level of instructions.
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Self, BuildError> {
        build::build(geometry, options)
    }

    /// The box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Where a node or leaf lies in memory, to be fetched: computed without a branch, which nobody could predict. Of nothing it means nothing.
    #[inline(always)]
    fn address(&self, reference: Reference) -> *const u8 {
        let kind = usize::from(reference.is_leaf());
        let start = [self.nodes.as_ptr().cast::<u8>(), self.blocks.as_ptr().cast()][kind];
        let size = [size_of::<WideNode>(), size_of::<TriangleBlock>()][kind];
        start.wrapping_add(size * reference.index())
    }

    /// How many items the stack of a traversal has room for: of each node on the way all children but one stay behind, below them lies the mark of
    /// the end, and sixteen are stored before it is known how many count. A multiple of sixteen.
    fn stack_size(&self) -> usize {
        (self.depth + 2) * node::WIDTH
    }
}

impl AccelerationStructure for WideBvh {
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        dispatch_on(self.level, single::Closest { tree: self, geometry, ray, probe })
    }

    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        dispatch_on(self.level, single::Any { tree: self, geometry, ray, probe })
    }

    fn intersect_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], hits: &mut [Option<Hit>]) {
        dispatch_on(self.level, batch::Closest { tree: self, geometry, rays, hits });
    }

    fn occluded_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], occluded: &mut [bool]) {
        dispatch_on(self.level, batch::Any { tree: self, geometry, rays, occluded });
    }

    fn simd_level(&self) -> Option<SimdLevel> {
        Some(self.level)
    }

    fn set_simd_level(&mut self, level: SimdLevel) {
        self.level = if level.is_available() { level } else { SimdLevel::Portable };
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        let mut pending = vec![(self.root, self.bounds, 0)];
        while let Some((reference, bounds, level)) = pending.pop() {
            if reference == Reference::NOTHING {
                continue;
            }
            let references = reference.is_leaf().then(|| reference.count());
            visit(NodeView { bounds, level, references });
            if !reference.is_leaf() {
                let node = &self.nodes[reference.index()];
                pending.extend(node.children().map(|(bounds, child)| (child, bounds, level + 1)));
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }

    fn primitives(&self) -> usize {
        self.primitives as usize
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        check::check(self, geometry)
    }
}
