//! The invariants of the wide tree, checked.

use super::WideBvh;
use super::node::{Reference, WideNode};
use crate::geometry::{LANES, TriangleBlock};
use crate::{Geometry, ValidationError};

/// Checks that every cache line of nodes and leaves is reached once, every primitive lies in exactly one leaf, boxes hold what is below them, blocks hold the corners of
/// their triangles, and the depth is what stacks are made for.
pub(super) fn check<G: Geometry>(tree: &WideBvh, geometry: &G) -> Result<(), ValidationError> {
    let (primitives, lines) = (geometry.len(), tree.arena.len());
    if primitives != tree.primitives as usize
        || (tree.root == Reference::NOTHING) != (primitives == 0)
    {
        return Err(ValidationError::NodeCount { nodes: lines, primitives });
    }
    let mut reached = vec![0usize; lines];
    let mut times = vec![0usize; primitives];
    let mut pending = vec![(tree.root, tree.bounds, 1)];
    while let Some((reference, bounds, depth)) = pending.pop() {
        if reference == Reference::NOTHING {
            continue;
        }
        let node = reference.line();
        let bad = ValidationError::BadReference { node };
        let size =
            if reference.is_leaf() { size_of::<TriangleBlock>() } else { size_of::<WideNode>() };
        let Some(counts) = reached.get_mut(node..node + size / 64) else { return Err(bad) };
        for times in counts {
            *times += 1;
            if *times > 1 {
                return Err(ValidationError::NodeReached { node, times: *times });
            }
        }
        if !reference.is_leaf() {
            if depth > tree.depth {
                return Err(ValidationError::TooDeep { depth });
            }
            for (content, child) in tree.node(reference).children() {
                if !bounds.contains(&content) {
                    return Err(ValidationError::NotEnclosed { node, bounds, content });
                }
                pending.push((child, content, depth + 1));
            }
            continue;
        }

        let block = tree.block(reference);
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
    match times.iter().position(|&times| times != 1) {
        Some(primitive) => {
            Err(ValidationError::PrimitiveReached { primitive, times: times[primitive] })
        }
        None => Ok(()),
    }
}
