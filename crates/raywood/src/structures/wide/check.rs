//! The invariants of the wide tree, checked.

use std::collections::HashMap;

use super::WideBvh;
use super::collapse::{BLOCK_LINES, NODE_LINES};
use super::node::Reference;
use crate::{Aabb, Geometry, ValidationError, Vec3};

/// Checks that every cache line of nodes and leaves is reached once, leaves in one block have lanes of their own, every primitive lies in exactly one leaf or its parts in several, boxes hold what is below them, blocks hold the corners of
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
    let mut parts = HashMap::<u32, Vec<Aabb>>::new();
    // By the first lines of blocks the lanes that leaves have there.
    let mut blocks = HashMap::<usize, u32>::new();
    let mut pending = vec![(tree.root, tree.bounds, 1)];
    while let Some((reference, bounds, depth)) = pending.pop() {
        if reference == Reference::NOTHING {
            continue;
        }
        let node = reference.line();
        let bad = ValidationError::BadReference { node };
        let size = if reference.is_leaf() { BLOCK_LINES } else { NODE_LINES };
        let Some(counts) = reached.get_mut(node..node + size) else { return Err(bad) };
        // Of two leaves in one block each has its own lanes.
        let taken = if reference.is_leaf() { blocks.entry(node).or_insert(0) } else { &mut 0 };
        let is_shared = *taken != 0 && *taken & reference.lanes() == 0;
        *taken |= reference.lanes();
        for times in counts.iter_mut().filter(|_| !is_shared) {
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
        for (lane, primitive) in tree.primitives_of(reference) {
            let Some(times) = times.get_mut(primitive as usize) else { return Err(bad) };
            *times += 1;
            let content = geometry.bounds(primitive);
            let triangle = geometry.triangle(primitive);
            if tree.parts.contain(primitive) && triangle.is_some() {
                parts.entry(primitive).or_default().push(bounds);
            } else if !bounds.contains(&content) {
                return Err(ValidationError::NotEnclosed { node, bounds, content });
            }
            match triangle {
                Some(corners) if corners == block.corners(lane) => {}
                None if reference.is_mixed() && block.others() >> lane & 1 == 1 => {}
                _ => return Err(ValidationError::WrongContent { node }),
            }
        }
    }
    if let Some(node) = reached.iter().position(|&times| times != 1) {
        return Err(ValidationError::NodeReached { node, times: reached[node] });
    }
    let is_wrong = |(primitive, &times): (usize, &usize)| {
        times == 0 || times > 1 && !tree.parts.contain(primitive as u32)
    };
    if let Some(primitive) = times.iter().enumerate().position(is_wrong) {
        return Err(ValidationError::PrimitiveReached { primitive, times: times[primitive] });
    }
    let uncovered = |(primitive, boxes): (&u32, &Vec<Aabb>)| {
        let corners = geometry.triangle(*primitive)?;
        (!cover(boxes, corners)).then_some(*primitive)
    };
    match parts.iter().filter_map(uncovered).min() {
        Some(primitive) => Err(ValidationError::NotCovered { primitive }),
        None => Ok(()),
    }
}

/// Whether each of some points of a triangle lies in one of the boxes, a grid with its corners and the middles of its edges.
fn cover(boxes: &[Aabb], [a, b, c]: [Vec3; 3]) -> bool {
    const STEPS: i32 = 8;
    let own = Aabb::of_points([a, b, c]);
    (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| (i, j))).all(|(i, j)| {
        let (u, v) = (i as f32 / STEPS as f32, j as f32 / STEPS as f32);
        // Without differences, which may be infinite. Rounding does not take it out of the triangle's own box.
        let point = ((1.0 - u - v) * a + u * b + v * c).max(own.min).min(own.max);
        boxes.iter().any(|bounds| bounds.contains(&Aabb { min: point, max: point }))
    })
}
