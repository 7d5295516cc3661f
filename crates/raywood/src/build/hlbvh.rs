//! The hierarchical linear BVH: leaves from a space-filling curve, everything above them by the surface area heuristic. Pantaleoni and Luebke, "HLBVH: Hierarchical LBVH
//! Construction for Real-Time Ray Tracing of Dynamic Geometry", HPG 2010; Garanzha, Pantaleoni and McAllister, "Simpler and Faster HLBVH with Work Queues", HPG 2011.

use super::sah_binned::BinnedSah;
use super::{Primitive, driver, lbvh};
use crate::structures::{Bvh2, Node};
use crate::{BuildError, BuildOptions, Geometry, parallel};

/// Builds the tree. The same for any number of threads.
pub(super) fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Bvh2, BuildError> {
    let tree = lbvh::build(geometry, options)?;

    // Each leaf as if it were a primitive.
    let leaves: Vec<_> = tree.nodes().iter().filter(|node| node.is_leaf()).collect();
    let primitive = |leaf: usize| Primitive::new(leaf as u32, leaves[leaf].bounds().into());
    let primitives = parallel::map(leaves.len(), primitive);
    let options = BuildOptions { max_leaf_size: 1, ..options.clone() };
    let above = driver::build(primitives, &BinnedSah::new(&options));

    // And now with what is in it: primitives in the order of the new leaves.
    let (mut nodes, order) = above.into_parts();
    let mut indices = Vec::with_capacity(geometry.len());
    let starts: Vec<_> = order
        .iter()
        .map(|&leaf| {
            let start = indices.len() as u32;
            indices.extend_from_slice(tree.leaf_primitives(leaves[leaf as usize]));
            start
        })
        .collect();
    for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
        let place = node.left_first() as usize;
        let count = leaves[order[place] as usize].count();
        *node = Node::leaf(node.bounds(), starts[place], count);
    }
    Ok(Bvh2::from_parts(nodes, indices))
}
