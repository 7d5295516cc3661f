//! Filling the nodes of a wide tree as they were planned: memory from the top down, boxes from the bottom up.

use super::plan::{Children, Large, Node, Planned, Small};
use crate::build::PackedAabb;
use crate::parallel;
use crate::simd::Part;
use crate::structures::wide::collapse::NODE_LINES;
use crate::structures::wide::node::{Reference, WIDTH, WideNode};

/// What was filled: the box around it, and how many nodes lie on the longest way down.
pub(super) type Filled = (PackedAabb, usize);

/// Fills the place of a node, and that of everything below it: first its children side by side, then what is below the first of these, and so on.
pub(super) fn fill(plan: Planned<'_>, place: Part<'_>, mut below: Part<'_>) -> Filled {
    match plan {
        Planned::Large(large) => fill_large(*large, place, below),
        Planned::Small(Small { root, .. }) => fill_small(root, place, &mut below),
    }
}

/// The same of a large node, in parallel.
fn fill_large(large: Large<'_>, place: Part<'_>, mut below: Part<'_>) -> Filled {
    let mut making = NodeInMaking::over_leaves(&large.children);
    let lanes = large.children.node_lanes();
    let places: Vec<_> = lanes.clone().map(|_| below.take(NODE_LINES)).collect();
    let tasks = large.nodes.into_iter().zip(places).map(|(plan, place)| {
        let below = below.take(NODE_LINES * plan.nodes_below());
        (plan, place, below)
    });
    let fill = |(plan, place, below): (Planned<'_>, Part<'_>, Part<'_>)| {
        (place.first(), fill(plan, place, below))
    };
    let filled = parallel::map_tasks(tasks.collect(), fill);
    for (lane, (line, filled)) in lanes.zip(filled) {
        making.put_node(lane, line, filled);
    }
    making.finish(place)
}

/// The same of a small node. Places are taken from the front of `rest`.
fn fill_small(node: Node<'_>, place: Part<'_>, rest: &mut Part<'_>) -> Filled {
    let children = Children::of(node);
    let mut making = NodeInMaking::over_leaves(&children);
    let mut places = [const { None }; WIDTH];
    for lane in children.node_lanes() {
        places[lane] = Some(rest.take(NODE_LINES));
    }
    for (lane, place) in places.into_iter().enumerate() {
        let Some(place) = place else { continue };
        let line = place.first();
        let filled = fill_small(children.all()[lane], place, rest);
        making.put_node(lane, line, filled);
    }
    making.finish(place)
}

/// A node whose children are being put into it.
struct NodeInMaking {
    node: WideNode,
    bounds: PackedAabb,
    /// How many nodes lie on the longest way down below it.
    depth: usize,
}

impl NodeInMaking {
    /// With those children that are leaves.
    fn over_leaves(children: &Children<'_>) -> Self {
        let mut making = Self { node: WideNode::EMPTY, bounds: PackedAabb::EMPTY, depth: 0 };
        for (lane, child) in children.all().iter().enumerate() {
            if let Node::Leaf(leaf) = child {
                making.put(lane, Reference(leaf.tag()), **leaf);
            }
        }
        making
    }

    fn put_node(&mut self, lane: usize, line: usize, (bounds, depth): Filled) {
        self.put(lane, Reference::node(line), bounds);
        self.depth = self.depth.max(depth);
    }

    fn put(&mut self, lane: usize, child: Reference, bounds: PackedAabb) {
        self.node.set(lane, &bounds.into(), child);
        self.bounds.grow(&bounds);
    }

    fn finish(self, mut place: Part<'_>) -> Filled {
        place.put(self.node);
        (self.bounds, 1 + self.depth)
    }
}
