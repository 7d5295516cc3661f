//! Rotations: near each node, two subtrees change places if boxes become smaller. Kensler, "Tree Rotations for Improving Bounding Volume Hierarchies", IEEE Symposium on Interactive
//! Ray Tracing 2008; Kopta et al., "Fast, Effective BVH Updates for Animated Scenes", I3D 2012.

use super::linked_tree::LinkedTree;
use crate::build::{Cancelled, Work};
use crate::structures::MAX_DEPTH;

/// How many nodes are looked at before the build asks whether to go on.
const STRETCH: usize = 1 << 14;

/// Looks at every node once, those below others first as builders number them, and makes the best rotation there. Returns by how much the cost falls. O(nodes), on one thread, for a
/// rotation changes what its neighbours see.
pub(super) fn rotate(tree: &mut LinkedTree, work: Work<'_>) -> Result<f64, Cancelled> {
    let mut gained = 0.0;
    let last = tree.len() - 1;
    work.in_stretches_of(STRETCH, tree.len(), |stretch| {
        for node in stretch.map(|place| last - place) {
            // A rotation makes the tree at most one level deeper.
            if tree.height(0) + 1 < MAX_DEPTH
                && let Some(Rotation { places: [a, b], gain }) = best_rotation(tree, node)
            {
                tree.swap(a, b);
                gained += gain;
            }
        }
    })?;
    Ok(gained)
}

/// Two subtrees that change places, and what that gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rotation {
    pub(super) places: [usize; 2],
    /// By how much the half areas of the tree's boxes shrink.
    pub(super) gain: f64,
}

/// The best of a node's rotations, if any gains something: a child and a grandchild below the other child, or two grandchildren, one from below each.
pub(super) fn best_rotation(tree: &LinkedTree, node: usize) -> Option<Rotation> {
    let left = tree.left_child(node)?;
    let children = [left, left + 1];
    let grandchildren = children.map(|child| tree.left_child(child));
    let area = |a: usize, b: usize| tree.bounds(a).union(tree.bounds(b)).half_area();
    let mut best = Rotation { places: [0; 2], gain: 0.0 };
    let mut offer = |places, gain| {
        if gain > best.gain {
            best = Rotation { places, gain };
        }
    };
    for side in 0..2 {
        if let Some(first) = grandchildren[side] {
            let (parent, other) = (children[side], children[1 - side]);
            let before = tree.bounds(parent).half_area();
            offer([other, first], before - area(other, first + 1));
            offer([other, first + 1], before - area(other, first));
        }
    }
    if let [Some(a), Some(b)] = grandchildren {
        let before = tree.bounds(left).half_area() + tree.bounds(left + 1).half_area();
        offer([a, b], before - area(b, a + 1) - area(a, b + 1));
        offer([a, b + 1], before - area(b + 1, a + 1) - area(b, a));
    }
    (best.gain > 0.0).then_some(best)
}
