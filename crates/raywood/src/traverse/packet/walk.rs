//! The way of a packet through the tree: depth first, the child first that is nearer to the first active ray.

use super::travellers::{Active, Traveller, Travellers};
use crate::PreparedRay;
use crate::structures::{Bvh2, Node};
use crate::traverse::Probe;
use crate::traverse::stack::Stack;

/// Takes the rays through the tree. `test` tests a ray against a primitive.
pub(super) fn walk<P: Probe>(
    tree: &Bvh2,
    travellers: &mut Travellers,
    probe: &mut P,
    test: impl Fn(&mut Traveller, u32),
) {
    // Nodes to visit later, with the rays that are active at their parent.
    let mut stack = Stack::<(u32, Active)>::new();
    if let (false, Some(everybody)) = (tree.nodes().is_empty(), travellers.everybody()) {
        stack.push((0, everybody));
    }
    while let Some((number, parent)) = stack.pop() {
        let node = &tree.nodes()[number as usize];
        let Some(active) = travellers.active_at(node, parent, probe) else { continue };
        probe.nodes(1);
        probe.packet_node(travellers.len(), || travellers.hitting(active, node));
        if node.is_leaf() {
            visit_leaf(tree, node, travellers, active, probe, &test);
        } else {
            let left_first = left_is_nearer(travellers.leader(active), tree.children(node));
            let left = node.left_first();
            stack.push((left + u32::from(left_first), active));
            stack.push((left + u32::from(!left_first), active));
        }
    }
}

/// Tests every active ray that hits the leaf against all its primitives.
#[inline]
fn visit_leaf<P: Probe>(
    tree: &Bvh2,
    leaf: &Node,
    travellers: &mut Travellers,
    active: Active,
    probe: &mut P,
    test: impl Fn(&mut Traveller, u32),
) {
    let mut shortened = false;
    for traveller in travellers.among(active) {
        probe.boxes(1);
        if !traveller.enters(leaf) {
            continue;
        }
        let before = traveller.nearest.t_max();
        for &primitive in tree.leaf_primitives(leaf) {
            probe.primitives(1);
            test(traveller, primitive);
            if traveller.nearest.is_blocked() {
                break;
            }
        }
        shortened |= traveller.nearest.t_max() < before;
    }
    if shortened {
        travellers.rays_were_shortened();
    }
}

/// Whether a ray comes to the middle of the left child before that of the right one.
#[inline]
fn left_is_nearer(ray: &PreparedRay, [left, right]: [&Node; 2]) -> bool {
    // Twice the middle.
    let middle = |node: &Node| *node.corner(0) + *node.corner(1);
    ray.direction.dot(middle(left) - middle(right)) <= 0.0
}
