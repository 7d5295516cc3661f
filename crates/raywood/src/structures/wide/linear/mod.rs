//! The wide tree straight from the order of primitives along a space-filling curve: the fastest way to build one. What is divided where follows from the codes alone; every
//! triangle is looked at once, when it is put into a leaf; and what is best for the tree above is asked only down to where sixteen leaves make a node.

mod leaves;
mod nodes;
mod plan;
mod tree;
mod window;

use super::WideBvh;
use super::build::finished;
use super::collapse::{BLOCK_LINES, NODE_LINES};
use super::node::Reference;
use super::parts::Parts;
use crate::build::{BuildMemory, Precision, SortedKeys, Stretch, Work, sorted_keys};
use crate::simd::{Arena, ArenaInMaking};
use crate::{BuildError, BuildOptions, Builder, Geometry};
use leaves::LeafFill;
use plan::{Node, Planned};
use tree::{Planter, Sizes};

/// Whether the options ask for a tree that is built so.
pub(crate) fn is_asked_for(options: &BuildOptions) -> bool {
    options.wide_builder == Builder::Lbvh && !options.improves() && !options.cuts_triangles()
}

/// Builds the tree. The same for any number of threads.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<WideBvh, BuildError> {
    let [ordering, dividing, filling] = work.shares([5.0, 1.0, 4.0]);
    let sorted = sorted_keys(geometry, Precision::Coarse, ordering)?;
    let SortedKeys { mut keys, bits, around } = sorted;
    let bounds = around.bounds.into();
    let finish = |filled| finished(bounds, geometry.len(), options, Parts::none(), filled);
    if keys.is_empty() {
        return Ok(finish((Arena::default(), (Reference::NOTHING, 0))));
    }
    let planter = Planter { geometry, most: options.clamped().wide_leaf_size };
    let mut tree = planter.grow(Stretch::all(&mut keys, bits), dividing)?;
    let Sizes { blocks, nodes } = tree.sizes();
    // Now it is known about how large the tree becomes: scenes can be made in which that is more than was to be expected.
    let (block_lines, node_lines) = (BLOCK_LINES * blocks, NODE_LINES * nodes);
    let lists = size_of_val(&keys[..]) + tree.bytes();
    BuildMemory::check_lists(lists + 64 * (block_lines + node_lines), geometry.len(), options)?;
    if block_lines + NODE_LINES * 2 * nodes > Reference::LINES {
        let bytes = (block_lines + node_lines).saturating_mul(64);
        return Err(BuildError::TreeTooLarge { bytes });
    }

    // The blocks of all leaves, and behind them the nodes.
    let per_area = 1.0 / around.bounds.half_area();
    let leaves = LeafFill { geometry, keys: &keys, bits, per_area, work: filling };
    let arena = ArenaInMaking::with_room_for(block_lines + node_lines);
    let (arena, _) = arena
        .extended(block_lines, |blocks| leaves.fill(&mut tree, blocks))
        .ok_or(BuildError::Cancelled)?;
    let root = Node::of(&tree);
    if let Node::Leaf(leaf) = root {
        return Ok(finish((arena.finish(), (Reference(leaf.tag()), 0))));
    }
    let plan = Planned::of(root);
    let lines = NODE_LINES * (1 + plan.nodes_below());
    let filled = arena.extended(lines, |mut all| {
        let place = all.take(NODE_LINES);
        let root = Reference::node(place.first());
        let (_, depth) = nodes::fill(plan, place, all);
        (root, depth)
    });
    let (arena, top) = filled.ok_or(BuildError::Cancelled)?;
    Ok(finish((arena.finish(), top)))
}
