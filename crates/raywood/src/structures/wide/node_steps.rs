//! The steps of rays in flight that are at nodes.

use super::WideBvh;
use super::batch::RAYS;
use super::flight::Flight;
use super::node::{Reference, WideNode};
use super::ray_search::RaySearch;
use crate::simd::{Kernel, Simd};

/// Takes rays a step further, each from the node where it is to what it visits next. Tells, as a set of places, whose stacks have no room for that: these stay where
/// they are.
pub(super) struct NodeSteps<'a, Q, const ANY: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) flights: &'a mut [Flight<Q>],
    /// Where each ray is.
    pub(super) currents: &'a mut [u32; RAYS],
    /// Those that are at nodes.
    pub(super) places: &'a [u32],
}

impl<Q: RaySearch, const ANY: bool> Kernel for NodeSteps<'_, Q, ANY> {
    type Output = u64;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u64 {
        let Self { tree, flights, currents, places } = self;
        let mut full = 0;
        let Some(last) = places.len().checked_sub(1) else { return full };

        // What is met of one node is put in order while the boxes of the next ray's are tested: two short chains of operations that wait for each other,
        // instead of one that is too long for the processor to have several of them at work.
        let mut this = meet(simd, tree, flights, currents, places[0]);
        for after in 1..=places.len() {
            let next = meet(simd, tree, flights, currents, places[after.min(last)]);
            let flight = &mut flights[this.place];
            if flight.is_full() {
                full |= 1 << this.place;
            } else {
                let top = flight.push::<S, ANY>(simd, this.node, this.met, this.near);
                simd.prefetch(tree.address(top));
                currents[this.place] = top.0;
            }
            this = next;
        }
        full
    }
}

/// A ray at a node, and which of the children it meets.
struct AtNode<'t, F> {
    place: usize,
    node: &'t WideNode,
    met: u32,
    near: F,
}

/// Tests the boxes of the node where the ray at a place is.
#[inline(always)]
fn meet<'t, S: Simd, Q: RaySearch>(
    simd: S,
    tree: &'t WideBvh,
    flights: &[Flight<Q>],
    currents: &[u32; RAYS],
    place: u32,
) -> AtNode<'t, S::F16> {
    let place = place as usize;
    let node = tree.node(Reference(currents[place]));
    let (met, near) = flights[place].meet(simd, node);
    AtNode { place, node, met, near }
}
