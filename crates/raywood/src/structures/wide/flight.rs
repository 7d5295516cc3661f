//! The state of a ray in flight: all in one place, of fixed size, so that finding it takes one multiplication.

use super::WideBvh;
use super::node::{Reference, WIDTH, WideNode};
use super::ray_search::{RaySearch, slabs};
use super::slabs::Slabs;
use crate::simd::Simd;

/// How many items a stack has room for: enough for all but the deepest trees. A power of two; little in tests, so that
/// they run out of it.
const CAPACITY: usize = if cfg!(test) { 32 } else { 128 };

/// A ray in flight.
#[repr(C, align(64))]
pub(super) struct Flight<Q> {
    slabs: Slabs,
    /// How many items are on the stack.
    top: usize,
    /// Its place among all rays.
    pub(super) number: usize,
    pub(super) search: Q,
    /// Where the items begin, as [`Simd::push_sorted`] keeps it.
    keys: [f32; CAPACITY],
    /// Nodes and leaves yet to be visited. Below all others lies the end, nearer than any limit.
    items: [u32; CAPACITY],
}

impl<Q: RaySearch> Flight<Q> {
    /// A ray at its beginning.
    pub(super) fn new(search: Q, number: usize, tree: &WideBvh) -> Self {
        let mut flight = Self {
            slabs: slabs(&search, tree),
            top: 1,
            number,
            search,
            keys: [0.0; CAPACITY],
            items: [0; CAPACITY],
        };
        (flight.keys[0], flight.items[0]) = (f32::NEG_INFINITY, Reference::NOTHING.0);
        flight
    }

    /// Another ray in the place of one that has ended.
    #[inline(always)]
    pub(super) fn begin(&mut self, search: Q, number: usize, tree: &WideBvh) {
        self.search = search;
        let ray = self.search.single();
        self.slabs.replace(ray, tree.reach);
        if tree.parts.exist() {
            self.slabs = self.slabs.among_parts(tree.parts.margin(ray.origin));
        }
        if Q::IS_ROUNDED {
            self.slabs = self.slabs.around(self.search.displacement());
        }
        self.number = number;
        self.top = 1;
    }

    /// Whether the children of a node might find no room on the stack.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.top > CAPACITY - WIDTH
    }

    /// The children of a node that the ray meets, and where it enters their boxes.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(&self, simd: S, node: &WideNode) -> (u32, S::F16) {
        self.slabs.children_met(simd, node, self.search.t_max())
    }

    /// Puts the children that were [met](Self::meet) onto the stack, which is not [full](Self::is_full), and takes what is on top then.
    #[inline(always)]
    pub(super) fn push<S: Simd, const ANY: bool>(
        &mut self,
        simd: S,
        node: &WideNode,
        met: u32,
        near: S::F16,
    ) -> Reference {
        let top = self.top;
        let (count, last) = if ANY {
            simd.push_chosen(met, &node.children, &mut self.items, top)
        } else {
            let stack = (&mut self.keys[..], &mut self.items[..]);
            simd.push_sorted(met, near, &node.children, stack, top)
        };
        self.top = top + count - 1;
        Reference(last)
    }

    /// Takes what is on top of the stack.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Reference {
        self.top -= 1;
        Reference(self.items[self.top & (CAPACITY - 1)])
    }

    /// Leaves nothing but the end on the stack.
    #[inline(always)]
    pub(super) fn end(&mut self) {
        self.top = 1;
    }

    /// Takes from the stack what begins beyond the closest hit.
    #[inline(always)]
    pub(super) fn cull<S: Simd>(&mut self, simd: S) {
        let end = self.slabs.end_of_keys(self.search.t_max());
        self.top = simd.retain(&mut self.keys, &mut self.items, self.top, end);
    }
}
