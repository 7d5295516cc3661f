//! Whether anything blocks a ray: depth first, in any order, until the first hit.

use super::Probe;
use super::nearest::blocks;
use super::slab::entry;
use super::stack::Stack;
use crate::structures::Bvh2;
use crate::{Geometry, PreparedRay, Ray};

/// Whether the ray meets any primitive in its interval.
pub(crate) fn occluded<G: Geometry, P: Probe>(
    tree: &Bvh2,
    geometry: &G,
    ray: &Ray,
    probe: &mut P,
) -> bool {
    let (Some(ray), Some(mut node)) = (PreparedRay::new(ray), tree.nodes().first()) else {
        return false;
    };
    probe.boxes(1);
    if entry(&ray, ray.t_max, node).is_none() {
        return false;
    }

    let mut stack = Stack::<u32>::new();
    loop {
        probe.nodes(1);
        if node.is_leaf() {
            for &primitive in tree.leaf_primitives(node) {
                probe.primitives(1);
                if blocks(geometry, &ray, primitive) {
                    return true;
                }
            }
        } else {
            probe.boxes(2);
            let [left, right] = tree.children(node);
            // The nearer child first: for shadow rays it holds the blocker more often.
            match (entry(&ray, ray.t_max, left), entry(&ray, ray.t_max, right)) {
                (Some(near_left), Some(near_right)) => {
                    let left_first = near_left <= near_right;
                    stack.push(node.left_first() + u32::from(left_first));
                    node = if left_first { left } else { right };
                    continue;
                }
                (Some(_), None) => {
                    node = left;
                    continue;
                }
                (None, Some(_)) => {
                    node = right;
                    continue;
                }
                (None, None) => {}
            }
        }
        let Some(next) = stack.pop() else { return false };
        node = &tree.nodes()[next as usize];
    }
}
