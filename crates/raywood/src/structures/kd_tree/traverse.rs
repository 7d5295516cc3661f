//! Ordered traversal with a short stack: Keller 1998, Havran, "Heuristic Ray Shooting Algorithms", 2000.
//!
//! # How a hit is not missed
//!
//! A primitive is listed only in the leaves that its surface reaches, so the ray must visit one of these, although the triangle test moves
//! vertices by a few roundings of their distance from the ray's origin, and may have the distance of a hit wrong by `2^-13` of itself
//! (`docs/numerics.md`). Three margins see to that:
//!
//! - Every plane is a slab as thick as 64 roundings of the largest distance between the origin and a point of the tree's box, 32 to
//!   each side. A ray inside that slab visits both children. This is more than the eight roundings by which the slab test lengthens its
//!   interval, and more than the vertices can move.
//! - The interval in which cells are visited is longer than the ray's by `2^-12` of the distance, twice the error of a hit.
//! - And by 64 of the first margins along the ray, as a ray that meets a surface at a grazing angle may pass it that much earlier.
//!
//! Both ends are moved so, and the closest hit so far when deciding whether a cell lies beyond it. These margins are ample, not a proof: a
//! triangle seen all but edge-on can have a distance that is off by more. Millions of rays at such triangles found none that is missed.

use super::node::Content;
use super::{KdNode, KdTree};
use crate::traverse::mailbox::Mailbox;
use crate::traverse::nearest::{Nearest, blocks};
use crate::traverse::slab::{lengthened, overlap};
use crate::traverse::stack::Stack;
use crate::{Aabb, Geometry, Hit, PreparedRay, Probe, Ray};

/// Half the thickness of a plane per unit of distance from the origin: 32 roundings.
const THICKNESS: f32 = 1.0 / (1 << 19) as f32;

/// The error of a hit's distance, relative to itself; twice what the triangle test allows.
const DISTANCE_ERROR: f32 = 1.0 / (1 << 12) as f32;

/// How far along the ray, in half thicknesses of planes, a hit at a grazing angle may be from its cell.
const GRAZING: f32 = 64.0;

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
    /// Half the thickness of the planes, with the sign of the direction on each axis.
    margins: [f32; 3],
    /// How much earlier than computed a hit may be met, beside its relative error.
    reach: f32,
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

        let distance = (min - ray.origin).abs().max((max - ray.origin).abs()).max_element();
        let margin = THICKNESS * distance;
        let margins = ray.reciprocal.to_array().map(|r| margin.copysign(r));
        let reach = GRAZING * margin / ray.direction.abs().max_element();
        let mut walk = Self { tree, ray, margins, reach, pending: Stack::new() };
        let (near, far) = (-walk.limit(-near), walk.limit(far));
        walk.pending.push((0, near, far));
        Some(walk)
    }

    /// Where cells begin that cannot hold a hit at or before `t`.
    #[inline]
    fn limit(&self, t: f32) -> f32 {
        t + (t.abs() * DISTANCE_ERROR + self.reach)
    }

    /// The primitives of the next leaf that may hold a hit at or before `t_max`.
    #[inline]
    fn next_leaf<P: Probe>(&mut self, t_max: f32, probe: &mut P) -> Option<&'a [u32]> {
        let limit = self.limit(t_max);
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
                let entry = (distance - self.margins[axis]) * self.ray.reciprocal[axis];
                let exit = (distance + self.margins[axis]) * self.ray.reciprocal[axis];
                let first = left + self.ray.entry_corners[axis] as u32;
                let second = left + 1 - self.ray.entry_corners[axis] as u32;
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
