//! What a wide tree costs as it is, in all and subtree by subtree: how it is known whether a tree has become bad, and where.

use super::WideBvh;
use super::cost::Cost;
use super::crown::{Crown, Parent};
use super::node::Reference;
use crate::parallel;

/// What a tree costs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// The expected cost `Q` of a ray through all of it.
    pub(crate) cost: f64,
    /// What each bough and each twig of its [crown](Crown) adds to it, in their order.
    pub(crate) cuttings: Vec<f64>,
}

impl WideBvh {
    /// Measures the tree. O(nodes), in parallel, with the same sums for any number of threads.
    pub(crate) fn measured(&self) -> Measured {
        let crown = Crown::of(self);
        let below = parallel::map_pieces(&crown.boughs, 1, |bough| self.cost_below(bough[0].line));
        let mut whole = Cost::default();
        if self.root != Reference::NOTHING {
            whole.add(self.bounds.half_area(), self.root.references());
        }
        crown.limbs.iter().for_each(|limb| self.add_children(limb.line, &mut whole));
        below.iter().for_each(|below| whole.add_all(below));

        let below = below.into_iter().chain(crown.twigs.iter().map(|_| Cost::default()));
        let cost = |((limb, lane), mut cost): (Parent, Cost)| {
            let node = self.node(crown.limbs[limb].reference());
            cost.add(node.bounds(lane).half_area(), Reference(node.children[lane]).references());
            cost.within(&self.bounds)
        };
        let cuttings = crown.cuttings().zip(below).map(cost).collect();
        Measured { cost: whole.within(&self.bounds), cuttings }
    }

    /// What all nodes below one cost.
    fn cost_below(&self, line: usize) -> Cost {
        let mut cost = Cost::default();
        self.add_children(line, &mut cost);
        for (_, child) in self.node(Reference::node(line)).children() {
            if !child.is_leaf() {
                cost.add_all(&self.cost_below(child.line()));
            }
        }
        cost
    }

    /// Adds the children of a node.
    fn add_children(&self, line: usize, cost: &mut Cost) {
        for (bounds, child) in self.node(Reference::node(line)).children() {
            cost.add(bounds.half_area(), child.references());
        }
    }
}
