//! The crown of a wide tree after boughs and twigs were cut off: limbs with smaller boxes, and those gone on which nothing is left.

use super::WideBvh;
use super::collapse::NODE_LINES;
use super::crown::{Bough, Crown, Limb};
use super::graft::{copy_blocks, own_lines};
use super::node::{Reference, WIDTH, WideNode};
use crate::Aabb;
use crate::simd::Part;

/// The crown.
pub(super) struct Pruned {
    limbs: Vec<Limb>,
    /// The limbs' nodes as they are now. One without children is not needed any more.
    nodes: Vec<WideNode>,
    /// The boughs that are left.
    pub(super) boughs: Vec<Bough>,
}

impl Pruned {
    /// Cuts off what is chosen among the boughs and twigs of a tree whose root is a node.
    pub(super) fn of(tree: &WideBvh, chosen: &[bool]) -> Self {
        let crown = Crown::of(tree);
        let nodes = crown.limbs.iter().map(|limb| *tree.node(limb.reference()));
        let mut nodes: Vec<_> = nodes.collect();
        for ((limb, lane), _) in crown.cuttings().zip(chosen).filter(|(_, is_chosen)| **is_chosen) {
            nodes[limb].set(lane, &Aabb::EMPTY, Reference::NOTHING);
        }
        let Crown { limbs, boughs, .. } = crown;
        // Children come after their parents, so from the last to the first.
        for (place, limb) in limbs.iter().enumerate().rev() {
            let Some((parent, lane)) = limb.parent else { continue };
            let left = if is_needed(&nodes[place]) { limb.reference() } else { Reference::NOTHING };
            let bounds = nodes[place].around();
            nodes[parent].set(lane, &bounds, left);
        }
        let boughs = boughs.into_iter().zip(chosen).filter(|(_, is_chosen)| !**is_chosen);
        let boughs = boughs.map(|(bough, _)| bough).collect();
        Self { limbs, nodes, boughs }
    }

    /// The box around everything that is left; empty if there is nothing.
    pub(super) fn bounds(&self) -> Aabb {
        self.nodes[0].around()
    }

    /// A lane of the root without a child.
    pub(super) fn free_lane(&self) -> Option<usize> {
        (0..WIDTH).find(|&lane| self.nodes[0].children[lane] == Reference::NOTHING.0)
    }

    /// How many lines all limbs take with their twigs.
    pub(super) fn lines(&self) -> usize {
        self.nodes.iter().filter(|node| is_needed(node)).map(own_lines).sum()
    }

    /// Copies the blocks of all twigs, which lie in the tree, and leaves a place for each limb that is needed before its own.
    pub(super) fn copy_twigs<'a>(
        &mut self,
        tree: &WideBvh,
        all: &mut Part<'a>,
    ) -> Vec<Option<Part<'a>>> {
        let copy = |node: &mut WideNode| {
            let place = is_needed(node).then(|| all.take(NODE_LINES));
            copy_blocks(tree, None, node, all);
            place
        };
        self.nodes.iter_mut().map(copy).collect()
    }

    /// Has the limbs refer to each other at their places, and to the boughs at theirs, which are told with their depths. Tells the reference to the root, and how many nodes lie on the longest
    /// way down.
    pub(super) fn refer_to(
        &mut self,
        boughs: &[(Reference, usize)],
        places: &[Option<Part<'_>>],
    ) -> (Reference, usize) {
        let mut root = Reference::NOTHING;
        let (mut depths, mut deepest) = (vec![1; self.limbs.len()], 0);
        for (number, (limb, place)) in self.limbs.iter().zip(places).enumerate() {
            let Some(place) = place else { continue };
            let reference = Reference::node(place.first());
            match limb.parent {
                None => root = reference,
                Some((parent, lane)) => {
                    depths[number] = depths[parent] + 1;
                    self.nodes[parent].children[lane] = reference.0;
                }
            }
            deepest = deepest.max(depths[number]);
        }
        for (bough, &(root, depth)) in self.boughs.iter().zip(boughs) {
            let (limb, lane) = bough.parent;
            self.nodes[limb].children[lane] = root.0;
            deepest = deepest.max(bough.depth + depth);
        }
        (root, deepest)
    }

    /// Adds a child to the root, when everything else refers to where it lies now.
    pub(super) fn add_below_root(&mut self, lane: usize, bounds: &Aabb, child: Reference) {
        self.nodes[0].set(lane, bounds, child);
    }

    /// Puts the limbs into their places.
    pub(super) fn put(self, places: Vec<Option<Part<'_>>>) {
        for (node, place) in self.nodes.into_iter().zip(places) {
            if let Some(mut place) = place {
                place.put(node);
            }
        }
    }
}

/// Whether anything is left on a limb.
fn is_needed(node: &WideNode) -> bool {
    node.children().next().is_some()
}
