//! Ordered traversal with a short stack: Keller 1998, Havran, "Heuristic Ray Shooting Algorithms", 2000.
//!
//! Planes are as thick as `traverse/margins.rs` says, so that no hit is missed; a ray inside one visits both children.

use super::node::Content;
use super::{KdNode, KdTree};
use crate::traverse::mailbox::Mailbox;
use crate::traverse::margins::Margins;
use crate::traverse::nearest::{Nearest, blocks};
use crate::traverse::slab::{lengthened, overlap};
use crate::traverse::stack::Stack;
use crate::{Aabb, Geometry, Hit, PreparedRay, Probe, Ray};

/// The closest hit, the lowest primitive number among equally near ones.
pub(super) fn closest<G: Geometry, P: Probe>(
    tree: &KdTree,
    geometry: &G,
    ray: &Ray,
    probe: &mut P,
) -> Option<Hit> {
    let ray = PreparedRay::new(ray)?;
    probe.boxes(1);
    let mut walk = Walk::new(tree, &ray)?;
    let mut nearest = Nearest::new(&ray);
    let mut mailbox = Mailbox::new();
    while let Some(leaf) = walk.next_leaf(nearest.t_max(), probe) {
        for &primitive in leaf {
            probe.references(1);
            if mailbox.is_new(primitive) {
                probe.primitives(1);
                nearest.test(geometry, &ray, primitive);
            }
        }
    }
    nearest.into_hit()
}

/// Whether the ray meets any primitive in its interval.
pub(super) fn occluded<G: Geometry, P: Probe>(
    tree: &KdTree,
    geometry: &G,
    ray: &Ray,
    probe: &mut P,
) -> bool {
    let Some(ray) = PreparedRay::new(ray) else { return false };
    probe.boxes(1);
    let Some(mut walk) = Walk::new(tree, &ray) else { return false };
    let mut mailbox = Mailbox::new();
    while let Some(leaf) = walk.next_leaf(ray.t_max, probe) {
        for &primitive in leaf {
            probe.references(1);
            if mailbox.is_new(primitive) {
                probe.primitives(1);
                if blocks(geometry, &ray, primitive) {
                    return true;
                }
            }
        }
    }
    false
}

/// A ray's way through the leaves, front to back.
struct Walk<'a> {
    tree: &'a KdTree,
    ray: &'a PreparedRay,
    margins: Margins,
    /// Nodes to visit later, and the distances at which the ray enters and leaves their cells.
    pending: Stack<(u32, f32, f32)>,
}

impl<'a> Walk<'a> {
    /// The walk from the root, unless the ray misses the tree's box.
    #[inline]
    fn new(tree: &'a KdTree, ray: &'a PreparedRay) -> Option<Self> {
        let Aabb { min, max } = tree.bounds;
        let (near, far) = overlap(ray, ray.t_max, |which| if which == 0 { &min } else { &max });
        if tree.nodes.is_empty() || near > lengthened(far) {
            return None;
        }

        let margins = Margins::new(&tree.bounds, ray);
        let mut walk = Self { tree, ray, margins, pending: Stack::new() };
        let (near, far) = (-margins.limit(-near), margins.limit(far));
        walk.pending.push((0, near, far));
        Some(walk)
    }

    /// The primitives of the next leaf that may hold a hit at or before `t_max`.
    #[inline]
    fn next_leaf<P: Probe>(&mut self, t_max: f32, probe: &mut P) -> Option<&'a [u32]> {
        let limit = self.margins.limit(t_max);
        loop {
            let (mut number, near, mut far) = self.pending.pop()?;
            if near > limit {
                continue;
            }
            loop {
                probe.nodes(1);
                let node: KdNode = self.tree.nodes[number as usize];
                let (axis, position, left) = match node.content() {
                    Content::Plane { axis, position, left } => (axis, position, left as u32),
                    Content::Leaf { count: 0, .. } => break,
                    Content::Leaf { first, count } => {
                        return Some(&self.tree.primitive_indices[first..][..count]);
                    }
                };

                // Where the ray enters and leaves the thick plane; NaN if it runs along its face, and then both
                // comparisons below fail and both children are visited whole.
                let distance = position - self.ray.origin[axis];
                let entry = (distance - self.margins.planes[axis]) * self.ray.reciprocal[axis];
                let exit = (distance + self.margins.planes[axis]) * self.ray.reciprocal[axis];
                let first = left + self.ray.entry_corner(axis) as u32;
                let second = left + 1 - self.ray.entry_corner(axis) as u32;
                if entry > far {
                    number = first;
                } else if exit < near {
                    number = second;
                } else {
                    self.pending.push((second, if entry > near { entry } else { near }, far));
                    far = if exit < far { exit } else { far };
                    number = first;
                }
            }
        }
    }
}
