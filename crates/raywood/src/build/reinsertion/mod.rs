//! Trees made better after they are built, by moving subtrees to better places: Bittner, Hapala and Havran, "Fast Insertion-Based Optimization of
//! Bounding Volume Hierarchies", 2013, in the parallel form of Meister and Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy
//! Optimization", 2018.

mod linked_tree;
mod rotations;
mod search;
#[cfg(test)]
mod tests;

use super::quicksort::{select, sort};
use super::{Cancelled, Work};
use crate::structures::Bvh2;
use crate::{BuildOptions, parallel};
use linked_tree::LinkedTree;
use rotations::rotate;
use search::{Move, best_move};

/// About how many passes gain anything worth while.
const USUAL_PASSES: usize = 4;

/// About how long it takes to link the nodes of a tree: the unit of the other times.
const LINKING: f64 = 1.0;

/// About how long it takes to copy the nodes in the end.
const COPYING: f64 = 4.0;

/// About how long a pass of rotations takes.
const ROTATING: f64 = 6.0;

/// About how long it takes to choose the nodes that a pass tries to move.
const CHOOSING: f64 = 1.0;

/// About how long it takes to search for better places of all nodes.
const SEARCHING: f64 = 190.0;

/// About how long it takes to move them.
const MOVING: f64 = 10.0;

/// How many searches for a better place are reported at a time.
const STRETCH: usize = 1 << 12;

/// Moves subtrees to where they cost less by the surface area heuristic, in as many passes as the options tell. The cost never rises, no leaf comes to lie
/// too deep, leaves keep their primitives, and the result does not depend on the number of threads.
///
/// A pass takes O(share * N) searches of bounded length and O(N) for the rest, next to nothing beside building the tree.
pub(super) fn optimize(
    tree: Bvh2,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Bvh2, Cancelled> {
    let options = options.clamped();
    let BuildOptions { reinsertion_share, reinsertion_gain, rotation_passes: rotations, .. } =
        options;
    let passes = options.reinsertion_passes.unwrap_or(0);
    // Boxes without area cost nothing wherever they are; two leaves can lie in one way only.
    if !options.improves() || tree.nodes().len() <= 3 || tree.bounds().half_area() <= 0.0 {
        work.done()?;
        return Ok(tree);
    }
    // Next to nothing is left to gain after the first few passes, however many are allowed.
    let search = pass_cost(reinsertion_share) * passes.min(USUAL_PASSES) as f64;
    let rotating = ROTATING * rotations as f64;
    let [linking, rotating, search, copying] = work.shares([LINKING, rotating, search, COPYING]);
    let mut tree = LinkedTree::new(tree, linking)?;
    let mut cost = tree.cost();
    for _ in 0..rotations {
        let gain = rotate(&mut tree, rotating.part(1, rotations))?;
        cost -= gain;
        if gain <= f64::from(reinsertion_gain) * cost {
            break;
        }
    }
    for number in 0..passes {
        let share = match number < USUAL_PASSES {
            true => search.part(1, passes.min(USUAL_PASSES)),
            false => search.without_progress(),
        };
        let gain = pass(&mut tree, reinsertion_share, share)?;
        cost -= gain;
        if gain <= f64::from(reinsertion_gain) * cost {
            break;
        }
    }
    tree.into_bvh2(copying)
}

/// About how long it takes to improve a tree as the options say, in units in which linking its nodes takes one.
pub(super) fn cost(options: &BuildOptions) -> f64 {
    let BuildOptions { reinsertion_passes, reinsertion_share, rotation_passes, .. } =
        options.clamped();
    let (passes, rotations) = (reinsertion_passes.unwrap_or(0), rotation_passes);
    match options.improves() {
        false => 0.0,
        true => {
            let searching = pass_cost(reinsertion_share) * passes.min(USUAL_PASSES) as f64;
            LINKING + ROTATING * rotations as f64 + searching + COPYING
        }
    }
}

/// The same of one pass.
fn pass_cost(share: f32) -> f64 {
    CHOOSING + (SEARCHING + MOVING) * f64::from(share)
}

/// Looks for better places for the largest nodes, all in the same tree, then moves them one after the other, those that gain most first. Returns by how
/// much the cost falls.
fn pass(tree: &mut LinkedTree, share: f32, work: Work<'_>) -> Result<f64, Cancelled> {
    let [choosing, searching, moving] =
        work.shares([CHOOSING, SEARCHING * f64::from(share), MOVING * f64::from(share)]);
    let candidates = largest_nodes(tree, share, choosing)?;
    let mut moves = vec![None; candidates.len()];
    searching.in_stretches_of(STRETCH, candidates.len(), |stretch| {
        let (candidates, moves) = (&candidates[stretch.clone()], &mut moves[stretch]);
        parallel::fill(candidates, moves, |&node| best_move(tree, node as usize));
    })?;
    let mut moves: Vec<Move> = moves.into_iter().flatten().collect();
    sort(&mut moves, work, |a, b| b.gain.total_cmp(&a.gain).then_with(|| a.from.cmp(&b.from)))?;

    // A move is judged anew when its turn comes: moves before may have changed boxes, or put something else in its places.
    let mut replaced = vec![false; tree.len()];
    let mut total = 0.0;
    let mut judge = |&Move { from, to, .. }: &Move| {
        let (from, to) = (from as usize, to as usize);
        let (parent, sibling) = (tree.parent(from), tree.sibling(from));
        let stale = replaced[from] || replaced[to] || to == parent || to == sibling;
        if stale || !tree.can_move(from, to) {
            return;
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
    };
    moving.in_stretches_of(STRETCH, moves.len(), |stretch| {
        moves[stretch].iter().for_each(&mut judge);
    })?;
    Ok(total)
}

/// The largest nodes but the root, as many as the share tells, in order of their places.
fn largest_nodes(tree: &LinkedTree, share: f32, work: Work<'_>) -> Result<Vec<u32>, Cancelled> {
    let root = tree.bounds(0).half_area();
    let mut nodes = parallel::map_watched(tree.len() - 1, work, |node| {
        let node = node + 1;
        ((tree.bounds(node).half_area() / root) as f32, node as u32)
    })?;
    let count = (f64::from(share) * nodes.len() as f64).ceil() as usize;
    if count < nodes.len() {
        select(&mut nodes, count, work, |a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)))?;
        nodes.truncate(count);
    }
    let mut nodes: Vec<u32> = nodes.into_iter().map(|(_, node)| node).collect();
    if !nodes.is_sorted() {
        sort(&mut nodes, work, u32::cmp)?;
    }
    Ok(nodes)
}
