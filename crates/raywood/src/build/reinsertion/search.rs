//! The best new place for a subtree, by branch and bound: Meister and Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization",
//! 2018, section 3.

use super::linked_tree::LinkedTree;
use crate::build::PackedAabb;
use crate::traverse::stack::Stack;

/// About how many nodes a search looks at before it is content with what it has. In scenes hardly any needs a quarter of it; where boxes overlap so
/// much that nothing can be ruled out, it keeps the whole linear.
const MAX_VISITS: usize = 256;

/// A subtree to be moved beside another node, and what that is expected to gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Move {
    pub(super) from: u32,
    pub(super) to: u32,
    /// By how much the half areas of the tree's boxes shrink.
    pub(super) gain: f64,
}

/// Finds the place where a subtree costs least, if any is better than where it is. `node` is not the root.
pub(super) fn best_move(tree: &LinkedTree, node: usize) -> Option<Move> {
    let bounds = tree.bounds(node);
    let mut search = Search {
        tree,
        bounds,
        area: bounds.half_area(),
        best: Move { from: node as u32, to: 0, gain: 0.0 },
        visits: 0,
    };

    // When it is taken out its parent vanishes, and its sibling takes that place.
    let (sibling, mut pivot) = (tree.sibling(node), tree.parent(node));
    let mut freed = tree.bounds(pivot).half_area();
    search.below(sibling, freed);

    // From one ancestor to the next: first everything on its other side, whose boxes above do not shrink, then the ancestor itself, which has shrunk to
    // what remains in it.
    let mut remaining = tree.bounds(sibling);
    while pivot != 0 && search.visits < MAX_VISITS {
        let sibling = tree.sibling(pivot);
        search.below(sibling, freed);
        remaining.grow(&tree.bounds(sibling));
        pivot = tree.parent(pivot);
        let area = tree.bounds(pivot).half_area();
        freed += area - remaining.half_area();
        search.offer(pivot, freed - area);
    }
    (search.best.gain > 0.0).then_some(search.best)
}

/// The search for a subtree's place.
struct Search<'a> {
    tree: &'a LinkedTree,
    /// The subtree's box.
    bounds: PackedAabb,
    /// Its half area.
    area: f64,
    best: Move,
    visits: usize,
}

impl Search<'_> {
    /// Looks at a node and everything below it. `freed` is by how much boxes shrink before the subtree is put here.
    fn below(&mut self, mut node: usize, freed: f64) {
        let mut stack = Stack::<(f64, u32)>::new();
        let mut freed = self.look_at(node, freed);
        loop {
            // However well it fits, the new parent is as large as the subtree itself.
            let may_gain = freed - self.area > self.best.gain && self.visits < MAX_VISITS;
            if let Some(left) = self.tree.left_child(node).filter(|_| may_gain) {
                let both = [left, left + 1].map(|child| (self.look_at(child, freed), child as u32));
                let [near, far] = if both[0].0 >= both[1].0 { both } else { [both[1], both[0]] };
                stack.push(far);
                (freed, node) = (near.0, near.1 as usize);
            } else if let Some((rest, next)) = stack.pop() {
                (freed, node) = (rest, next as usize);
            } else {
                return;
            }
        }
    }

    /// Tries the place beside a node, and returns what is freed if the subtree goes further down than that.
    #[inline]
    fn look_at(&mut self, node: usize, freed: f64) -> f64 {
        self.visits += 1;
        let bounds = self.tree.bounds(node);
        let gain = freed - bounds.union(self.bounds).half_area();
        self.offer(node, gain);
        gain + bounds.half_area()
    }

    /// Keeps the place if it is better than all before.
    #[inline]
    fn offer(&mut self, node: usize, gain: f64) {
        if gain > self.best.gain {
            (self.best.to, self.best.gain) = (node as u32, gain);
        }
    }
}
