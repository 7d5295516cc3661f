//! The closest hit of one ray: depth first, nearer child first.

use super::Probe;
use super::nearest::Nearest;
use super::slab::{entry, lengthened};
use super::stack::Stack;
use crate::structures::Bvh2;
use crate::{Geometry, Hit, PreparedRay, Ray};

/// The closest hit, the lowest primitive number among equally near ones.
pub(crate) fn closest<G: Geometry, P: Probe>(
    tree: &Bvh2,
    geometry: &G,
    ray: &Ray,
    probe: &mut P,
) -> Option<Hit> {
    let ray = PreparedRay::new(ray)?;
    let mut nearest = Nearest::new(&ray);

    let mut node = tree.nodes().first()?;
    probe.boxes(1);
    entry(&ray, nearest.t_max(), node)?;

    // Nodes to visit later, with the distance at which the ray enters them.
    let mut stack = Stack::<(u32, f32)>::new();
    loop {
        probe.nodes(1);
        if node.is_leaf() {
            probe.primitives(node.count() as usize);
            for &primitive in tree.leaf_primitives(node) {
                nearest.test(geometry, &ray, primitive);
            }
        } else {
            probe.boxes(2);
            let [left, right] = tree.children(node);
            match (entry(&ray, nearest.t_max(), left), entry(&ray, nearest.t_max(), right)) {
                (Some(near_left), Some(near_right)) => {
                    let left_first = near_left <= near_right;
                    let (near, far) =
                        if left_first { (left, near_right) } else { (right, near_left) };
                    stack.push((node.left_first() + u32::from(left_first), far));
                    node = near;
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

        // On to the next node that begins before the closest hit.
        let limit = lengthened(nearest.t_max());
        node = loop {
            let Some((next, near)) = stack.pop() else { return nearest.into_hit() };
            if near <= limit {
                break &tree.nodes()[next as usize];
            }
        };
    }
}
