//! The invariants of the wide tree, checked.

use super::WideBvh;
use super::node::Reference;
use crate::geometry::LANES;
use crate::{Geometry, ValidationError};

/// Checks that nodes and blocks are each reached once, every primitive lies in exactly one leaf, boxes hold what is below them, blocks hold the corners of
/// their triangles, and the depth is what stacks are made for.
pub(super) fn check<G: Geometry>(tree: &WideBvh, geometry: &G) -> Result<(), ValidationError> {
    let (primitives, nodes) = (geometry.len(), tree.nodes.len());
    if primitives != tree.primitives as usize
        || (tree.root == Reference::NOTHING) != (primitives == 0)
    {
        return Err(ValidationError::NodeCount { nodes, primitives });
    }
    let mut reached = vec![0usize; nodes];
    let mut blocks_reached = vec![0usize; tree.blocks.len()];
    let mut times = vec![0usize; primitives];
    let mut pending = vec![(tree.root, tree.bounds, 1)];
    while let Some((reference, bounds, depth)) = pending.pop() {
        if reference == Reference::NOTHING {
            continue;
        }
        let node = reference.index();
        let bad = ValidationError::BadReference { node };
        let counts = if reference.is_leaf() { &mut blocks_reached } else { &mut reached };
        let Some(count) = counts.get_mut(node) else { return Err(bad) };
        *count += 1;
        if *count > 1 {
            return Err(ValidationError::NodeReached { node, times: *count });
        }
        if !reference.is_leaf() {
            if depth > tree.depth {
                return Err(ValidationError::TooDeep { depth });
            }
            for (content, child) in tree.nodes[node].children() {
                if !bounds.contains(&content) {
                    return Err(ValidationError::NotEnclosed { node, bounds, content });
                }
                pending.push((child, content, depth + 1));
            }
            continue;
        }

        let block = &tree.blocks[node];
        debug_assert!(reference.count() <= LANES);
        for (lane, &primitive) in block.primitives[..reference.count()].iter().enumerate() {
            let Some(times) = times.get_mut(primitive as usize) else { return Err(bad) };
            *times += 1;
            let content = geometry.bounds(primitive);
            if !bounds.contains(&content) {
                return Err(ValidationError::NotEnclosed { node, bounds, content });
            }
            match geometry.triangle(primitive) {
                Some(corners) if corners == block.corners(lane) => {}
                None if reference.is_mixed() => {}
                _ => return Err(ValidationError::WrongContent { node }),
            }
        }
    }
    if let Some(node) = reached.iter().position(|&times| times != 1) {
        return Err(ValidationError::NodeReached { node, times: reached[node] });
    }
    if let Some(node) = blocks_reached.iter().position(|&times| times != 1) {
        return Err(ValidationError::NodeReached { node, times: blocks_reached[node] });
    }
    match times.iter().position(|&times| times != 1) {
        Some(primitive) => {
            Err(ValidationError::PrimitiveReached { primitive, times: times[primitive] })
        }
        None => Ok(()),
    }
}
