//! The invariants of the kD-tree, checked.

use super::node::Content;
use super::{KdTree, halves};
use crate::structures::MAX_DEPTH;
use crate::{Aabb, Geometry, ValidationError, Vec3};

/// Checks the tree against the geometry it was built over: nodes and references within bounds, each node reached once, planes inside
/// their cells, leaves in ascending order and not too deep, and every primitive listed where it must be ([`check_primitive`]).
pub(super) fn validate<G: Geometry>(tree: &KdTree, geometry: &G) -> Result<(), ValidationError> {
    let (nodes, primitives) = (tree.nodes.len(), geometry.len());
    if primitives != tree.primitives as usize
        || (nodes == 0) != (primitives == 0)
        || nodes > 12 * primitives + 128
    {
        return Err(ValidationError::NodeCount { nodes, primitives });
    }

    let mut reached = vec![0usize; nodes];
    let mut pending = Vec::new();
    pending.extend(tree.nodes.first().map(|_| (0, tree.bounds, 1)));
    while let Some((node, cell, depth)) = pending.pop() {
        let bad = ValidationError::BadReference { node };
        let Some(times) = reached.get_mut(node) else { return Err(bad) };
        *times += 1;
        if *times > 1 {
            return Err(ValidationError::NodeReached { node, times: *times });
        }
        if depth > MAX_DEPTH {
            return Err(ValidationError::TooDeep { depth });
        }
        match tree.nodes[node].content() {
            Content::Leaf { first, count } => {
                let leaf = tree.primitive_indices.get(first..first + count);
                let Some(leaf) = leaf else { return Err(bad) };
                let in_range = leaf.iter().all(|&primitive| (primitive as usize) < primitives);
                if !in_range || !leaf.is_sorted_by(|a, b| a < b) {
                    return Err(bad);
                }
            }
            Content::Plane { axis, position, left } => {
                if left + 1 >= nodes {
                    return Err(bad);
                }
                let halves = halves(&cell, axis, position);
                if let Some(half) = halves.iter().find(|half| half.is_empty()) {
                    let (bounds, content) = (cell, *half);
                    return Err(ValidationError::NotEnclosed { node, bounds, content });
                }
                pending.extend([(left, halves[0], depth + 1), (left + 1, halves[1], depth + 1)]);
            }
        }
    }
    if let Some(node) = reached.iter().position(|&times| times != 1) {
        return Err(ValidationError::NodeReached { node, times: reached[node] });
    }
    (0..primitives).try_for_each(|primitive| check_primitive(tree, geometry, primitive))
}

/// Checks that a primitive is in some leaf, and in every leaf whose cell it still reaches when the cell is made smaller on all sides by a
/// millionth of the largest coordinate. (Clipping in many steps and in one differ by roundings, and what lies in a plane goes
/// to one side of it.)
fn check_primitive<G: Geometry>(
    tree: &KdTree,
    geometry: &G,
    primitive: usize,
) -> Result<(), ValidationError> {
    let bounds = geometry.bounds(primitive as u32);
    let margin = 1e-6 * tree.bounds.min.abs().max(tree.bounds.max.abs()).max_element();
    let mut times = 0;
    let mut pending = vec![(0, tree.bounds)];
    while let Some((node, cell)) = pending.pop() {
        if bounds.intersection(&cell).is_empty() {
            continue;
        }
        match tree.nodes[node].content() {
            Content::Leaf { first, count } => {
                let leaf = &tree.primitive_indices[first..][..count];
                let inner =
                    Aabb::new(cell.min + Vec3::splat(margin), cell.max - Vec3::splat(margin));
                if leaf.binary_search(&(primitive as u32)).is_ok() {
                    times += 1;
                } else if !inner.is_empty()
                    && !geometry.clipped_bounds(primitive as u32, &inner).is_empty()
                {
                    let primitive = primitive as u32;
                    return Err(ValidationError::NotReferenced { node, primitive });
                }
            }
            Content::Plane { axis, position, left } => {
                let [below, above] = halves(&cell, axis, position);
                pending.extend([(left, below), (left + 1, above)]);
            }
        }
    }
    match times {
        0 => Err(ValidationError::PrimitiveReached { primitive, times }),
        _ => Ok(()),
    }
}
