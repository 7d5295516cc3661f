//! One ray through the wide tree.

use super::WideBvh;
use super::node::{Reference, WIDTH};
use super::step::{any_blocks, children_met, leaf_hits, take_closest};
use crate::simd::{Kernel, Simd};
use crate::traverse::nearest::Nearest;
use crate::traverse::slab::lengthened;
use crate::{Geometry, Hit, PreparedRay, Probe, Ray};

/// Looks for the closest hit.
pub(super) struct Closest<'a, G, P> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a G,
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a mut P,
}

impl<G: Geometry, P: Probe> Kernel for Closest<'_, G, P> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit> {
        let Self { tree, geometry, ray, probe } = self;
        let ray = PreparedRay::new(ray)?;
        let mut nearest = Nearest::new(&ray);
        let mut stack = SmallStack::new(tree);
        let (keys, items) = stack.parts();
        let (mut top, mut current) = (0, tree.root);
        loop {
            if current == Reference::NOTHING {
                return nearest.into_hit();
            }
            probe.nodes(1);
            if current.is_leaf() {
                probe.primitives(current.count());
                let hits = leaf_hits(simd, tree, geometry, current, &ray, nearest.t_max());
                take_closest(tree, geometry, current, &hits, &ray, &mut nearest);
            } else {
                let node = &tree.nodes[current.index()];
                probe.boxes(WIDTH);
                let (met, near) = children_met(simd, node, &ray, nearest.t_max());
                let (keys, items) = free(keys, items, top);
                top += simd.store_sorted(met, near, &node.children, keys, items);
            }

            // On to the next that begins before the closest hit.
            let end = lengthened(nearest.t_max());
            current = loop {
                let Some(below) = top.checked_sub(1) else { break Reference::NOTHING };
                top = below;
                if keys[top] <= end {
                    break Reference(items[top]);
                }
            };
        }
    }
}

/// Looks for any hit.
pub(super) struct Any<'a, G, P> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a G,
    pub(super) ray: &'a Ray,
    pub(super) probe: &'a mut P,
}

impl<G: Geometry, P: Probe> Kernel for Any<'_, G, P> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { tree, geometry, ray, probe } = self;
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let mut stack = SmallStack::new(tree);
        let (keys, items) = stack.parts();
        let (mut top, mut current) = (0, tree.root);
        loop {
            if current == Reference::NOTHING {
                return false;
            }
            probe.nodes(1);
            if current.is_leaf() {
                probe.primitives(current.count());
                let hits = leaf_hits(simd, tree, geometry, current, &ray, ray.t_max);
                if any_blocks(tree, geometry, current, &hits, &ray) {
                    return true;
                }
            } else {
                let node = &tree.nodes[current.index()];
                probe.boxes(WIDTH);
                let (met, near) = children_met(simd, node, &ray, ray.t_max);
                let (keys, items) = free(keys, items, top);
                top += simd.store_sorted(met, near, &node.children, keys, items);
            }
            current = match top.checked_sub(1) {
                Some(below) => {
                    top = below;
                    Reference(items[top])
                }
                None => return false,
            };
        }
    }
}

/// The sixteen free places of a stack from `top` on.
#[inline(always)]
pub(super) fn free<'a>(
    keys: &'a mut [f32],
    items: &'a mut [u32],
    top: usize,
) -> (&'a mut [f32; WIDTH], &'a mut [u32; WIDTH]) {
    const ROOM: &str = "a stack has room for all children of the deepest nodes";
    (keys[top..].first_chunk_mut().expect(ROOM), items[top..].first_chunk_mut().expect(ROOM))
}

/// How many items a stack has room for without asking for memory: enough for eight levels, and few trees have more.
const SMALL: usize = 160;

/// The stack of one ray: on the program's own stack unless the tree is unusually deep.
struct SmallStack {
    keys: [f32; SMALL],
    items: [u32; SMALL],
    large: (Vec<f32>, Vec<u32>),
}

impl SmallStack {
    #[inline(always)]
    fn new(tree: &WideBvh) -> Self {
        let size = tree.stack_size();
        let large = if size > SMALL { (vec![0.0; size], vec![0; size]) } else { (vec![], vec![]) };
        Self { keys: [0.0; SMALL], items: [0; SMALL], large }
    }

    /// The keys and the items.
    #[inline(always)]
    fn parts(&mut self) -> (&mut [f32], &mut [u32]) {
        if self.large.0.is_empty() {
            (&mut self.keys, &mut self.items)
        } else {
            (&mut self.large.0, &mut self.large.1)
        }
    }
}
