//! The hierarchical linear BVH: leaves from a space-filling curve, everything above them by the surface area heuristic. Pantaleoni and Luebke, "HLBVH: Hierarchical LBVH
//! Construction for Real-Time Ray Tracing of Dynamic Geometry", HPG 2010; Garanzha, Pantaleoni and McAllister, "Simpler and Faster HLBVH with Work Queues", HPG 2011.

use super::sah_binned::BinnedSah;
use super::{Cancelled, Primitive, Work, driver, lbvh};
use crate::structures::{Bvh2, Node};
use crate::{BuildError, BuildOptions, Geometry, parallel};

/// After so many leaves the build asks whether to go on.
const STRETCH: usize = 1 << 16;

/// Builds the tree. The same for any number of threads.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    let [leaves, above, filling] = work.shares([11.0, 18.0, 3.0]);
    let tree = lbvh::build(geometry, options, leaves)?;
    Ok(build_above(&tree, options, [above, filling])?)
}

/// Another tree over the leaves of one.
fn build_above(
    tree: &Bvh2,
    options: &BuildOptions,
    [above, filling]: [Work<'_>; 2],
) -> Result<Bvh2, Cancelled> {
    // Each leaf as if it were a primitive.
    let leaves: Vec<_> = tree.nodes().iter().filter(|node| node.is_leaf()).collect();
    above.ask()?;
    let primitive = |leaf: usize| Primitive::new(leaf as u32, leaves[leaf].bounds().into());
    let primitives = parallel::map_watched(leaves.len(), above.without_progress(), primitive)?;
    let options = BuildOptions { max_leaf_size: 1, ..options.clone() };
    let above = driver::build_over(primitives, &BinnedSah::new(&options), above)?;

    // And now with what is in it: primitives in the order of the new leaves.
    let [ordering, filling] = filling.shares([1.0, 1.0]);
    let (mut nodes, order) = above.into_parts();
    let mut indices = Vec::with_capacity(tree.primitive_indices().len());
    let mut starts = Vec::with_capacity(order.len());
    ordering.in_stretches_of(STRETCH, order.len(), |stretch| {
        starts.extend(order[stretch].iter().map(|&leaf| {
            let start = indices.len() as u32;
            indices.extend_from_slice(tree.leaf_primitives(leaves[leaf as usize]));
            start
        }));
    })?;
    filling.in_stretches_of(STRETCH, nodes.len(), |stretch| {
        for node in nodes[stretch].iter_mut().filter(|node| node.is_leaf()) {
            let place = node.left_first() as usize;
            let count = leaves[order[place] as usize].count();
            *node = Node::leaf(node.bounds(), starts[place], count);
        }
    })?;
    Ok(Bvh2::from_parts(nodes, indices))
}
