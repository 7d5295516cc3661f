//! The closest hit of one ray: depth first, nearer child first.

use super::Probe;
use super::slab::{entry, inside_own_bounds, lengthened};
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
    let mut best: Option<Hit> = None;
    // Where looking further is of no use: the ray's end, later the closest hit so far.
    let mut t_max = ray.t_max;

    let mut node = tree.nodes().first()?;
    probe.boxes(1);
    entry(&ray, t_max, node)?;

    // Nodes to visit later, with the distance at which the ray enters them.
    let mut stack = Stack::<(u32, f32)>::new();
    loop {
        if node.is_leaf() {
            probe.primitives(node.count() as usize);
            for &primitive in tree.leaf_primitives(node) {
                if let Some(hit) = geometry.intersect(primitive, &ray)
                    && let Some(hit) = inside_own_bounds(&ray, hit, &geometry.bounds(primitive))
                    && best.is_none_or(|best| {
                        hit.t < best.t || (hit.t == best.t && primitive < best.primitive)
                    })
                {
                    best = Some(Hit { t: hit.t, u: hit.u, v: hit.v, primitive, instance: 0 });
                    t_max = hit.t;
                }
            }
        } else {
            probe.boxes(2);
            let [left, right] = tree.children(node);
            match (entry(&ray, t_max, left), entry(&ray, t_max, right)) {
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
        let limit = lengthened(t_max);
        node = loop {
            let Some((next, near)) = stack.pop() else { return best };
            if near <= limit {
                break &tree.nodes()[next as usize];
            }
        };
    }
}
