//! Trees made better after they are built, by moving subtrees to better places: Bittner, Hapala and Havran, "Fast Insertion-Based Optimization of
//! Bounding Volume Hierarchies", 2013, in the parallel form of Meister and Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy
//! Optimization", 2018.

mod linked_tree;
mod search;
#[cfg(test)]
mod tests;

use crate::structures::Bvh2;
use crate::{BuildOptions, parallel};
use linked_tree::LinkedTree;
use search::{Move, best_move};

/// Another pass is made only if the last one lowered the cost by this share.
const LEAST_GAIN: f64 = 0.001;

/// Moves subtrees to where they cost less by the surface area heuristic, in as many passes as the options tell. The cost never rises, no leaf comes to lie
/// too deep, leaves keep their primitives, and the result does not depend on the number of threads.
///
/// A pass takes O(share * N) searches of bounded length and O(N) for the rest, next to nothing beside building the tree.
pub(super) fn optimize(tree: Bvh2, options: &BuildOptions) -> Bvh2 {
    let BuildOptions { reinsertion_passes, reinsertion_share, .. } = options.clamped();
    let passes = reinsertion_passes.unwrap_or(0);
    // Boxes without area cost nothing wherever they are; two leaves can lie in one way only.
    if passes == 0 || tree.nodes().len() <= 3 || tree.bounds().half_area() <= 0.0 {
        return tree;
    }
    let mut tree = LinkedTree::new(tree);
    let mut cost = tree.cost();
    for _ in 0..passes {
        let gain = pass(&mut tree, reinsertion_share);
        cost -= gain;
        if gain <= LEAST_GAIN * cost {
            break;
        }
    }
    tree.into_bvh2()
}

/// Looks for better places for the largest nodes, all in the same tree, then moves them one after the other, those that gain most first. Returns by how
/// much the cost falls.
fn pass(tree: &mut LinkedTree, share: f32) -> f64 {
    let candidates = largest_nodes(tree, share);
    let mut moves = vec![None; candidates.len()];
    parallel::fill(&candidates, &mut moves, |&node| best_move(tree, node as usize));
    let mut moves: Vec<Move> = moves.into_iter().flatten().collect();
    parallel::sort_unstable_by(&mut moves, |a, b| {
        b.gain.total_cmp(&a.gain).then_with(|| a.from.cmp(&b.from))
    });

    // A move is judged anew when its turn comes: moves before may have changed boxes, or put something else in its places.
    let mut replaced = vec![false; tree.len()];
    let mut total = 0.0;
    for &Move { from, to, .. } in &moves {
        let (from, to) = (from as usize, to as usize);
        let (parent, sibling) = (tree.parent(from), tree.sibling(from));
        let stale = replaced[from] || replaced[to] || to == parent || to == sibling;
        if stale || !tree.can_move(from, to) {
            continue;
        }
        let gain = -tree.move_beside(from, to);
        if gain > 0.0 {
            total += gain;
            for place in [parent, sibling, to] {
                replaced[place] = true;
            }
        } else {
            tree.move_beside(from, parent);
        }
    }
    total
}

/// The largest nodes but the root, as many as the share tells, in order of their places.
fn largest_nodes(tree: &LinkedTree, share: f32) -> Vec<u32> {
    let root = tree.bounds(0).half_area();
    let mut nodes = parallel::map(tree.len() - 1, |node| {
        let node = node + 1;
        ((tree.bounds(node).half_area() / root) as f32, node as u32)
    });
    let count = (f64::from(share) * nodes.len() as f64).ceil() as usize;
    if count < nodes.len() {
        nodes.select_nth_unstable_by(count, |a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
        nodes.truncate(count);
    }
    let mut nodes: Vec<u32> = nodes.into_iter().map(|(_, node)| node).collect();
    nodes.sort_unstable();
    nodes
}
