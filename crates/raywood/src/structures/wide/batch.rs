//! Many rays through the wide tree, dozens in flight at a time.
//!
//! A single ray waits: for nodes from memory, and for the processor to find out which way a branch goes. Here each ray takes one step and then the
//! next ray's turn comes, so that the memory of its next node arrives meanwhile, and rays wait in lists by what they do next, so that no branch
//! depends on it.

use super::WideBvh;
use super::node::Reference;
use super::single::free;
use super::step::{any_blocks, children_met, leaf_hits, take_closest};
use crate::geometry::BlockHits;
use crate::simd::{Kernel, Simd};
use crate::traverse::nearest::Nearest;
use crate::traverse::slab::lengthened;
use crate::{Geometry, Hit, PreparedRay, Ray};

/// How many rays are in flight.
const RAYS: usize = 64;

/// Finds the closest hits of many rays.
pub(super) struct Closest<'a, G> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a G,
    pub(super) rays: &'a [Ray],
    pub(super) hits: &'a mut [Option<Hit>],
}

impl<G: Geometry> Kernel for Closest<'_, G> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, geometry, rays, hits } = self;
        wave::<S, G, _, false>(simd, tree, geometry, rays, |number, nearest| {
            hits[number] = nearest.into_hit();
        });
        for (ray, hit) in rays.iter().zip(hits) {
            if !ray.is_valid() {
                *hit = None;
            }
        }
    }
}

/// Finds out whether anything blocks each of many rays.
pub(super) struct Any<'a, G> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a G,
    pub(super) rays: &'a [Ray],
    pub(super) occluded: &'a mut [bool],
}

impl<G: Geometry> Kernel for Any<'_, G> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, geometry, rays, occluded } = self;
        occluded.fill(false);
        wave::<S, G, _, true>(simd, tree, geometry, rays, |number, nearest| {
            occluded[number] = nearest.is_blocked();
        });
    }
}

/// A ray in flight.
struct Flight {
    ray: PreparedRay,
    nearest: Nearest,
    /// Its place among all rays.
    number: usize,
    /// How many items are on its stack.
    top: usize,
    /// What was found in the last leaf.
    hits: BlockHits,
}

/// Where there is no ray in flight: neither a node nor a leaf, nor the end of a ray's way.
const IDLE: u32 = Reference::NOTHING.0 - 2;

/// Traces all valid rays and tells `finish` what each found. With `ANY` a ray ends with its first hit.
#[inline(always)]
fn wave<S: Simd, G: Geometry, F: FnMut(usize, Nearest), const ANY: bool>(
    simd: S,
    tree: &WideBvh,
    geometry: &G,
    rays: &[Ray],
    mut finish: F,
) {
    let size = tree.stack_size();
    let mut waiting =
        rays.iter().enumerate().filter_map(|(number, ray)| Some((number, PreparedRay::new(ray)?)));
    let mut flying = Vec::with_capacity(RAYS.min(rays.len()));
    let mut currents = [IDLE; RAYS];
    for (current, (number, ray)) in currents.iter_mut().zip(&mut waiting) {
        *current = tree.root.0;
        flying.push(Flight {
            nearest: Nearest::new(&ray),
            ray,
            number,
            top: 1,
            hits: BlockHits::NONE,
        });
    }

    // Below everything on a stack lies the end, nearer than any limit.
    let (mut keys, mut items) = (vec![0.0; flying.len() * size], vec![0; flying.len() * size]);
    for place in 0..flying.len() {
        (keys[place * size], items[place * size]) = (f32::NEG_INFINITY, Reference::NOTHING.0);
    }

    let mut lists = [[0; RAYS + 16]; 3];
    loop {
        // Find out which rays do what next: all sixteen places at a time, without a branch.
        let counts = simd.partition(&currents, IDLE, Reference::NOTHING.0, &mut lists);
        let [nodes, leaves, done] = &lists;
        let (nodes, leaves, done) = (&nodes[..counts[0]], &leaves[..counts[1]], &done[..counts[2]]);
        if counts == [0; 3] {
            return;
        }

        // Those whose way has ended make room for others.
        for &place in done {
            let place = place as usize;
            let flight = &mut flying[place];
            let ended = std::mem::replace(&mut flight.nearest, Nearest::new(&flight.ray));
            finish(flight.number, ended);
            currents[place] = IDLE;
            if let Some((number, ray)) = waiting.next() {
                (flight.ray, flight.number, flight.top) = (ray, number, 1);
                flight.nearest = Nearest::new(&flight.ray);
                currents[place] = tree.root.0;
            }
        }

        for &place in nodes {
            let place = place as usize;
            let flight = &mut flying[place];
            let start = place * size;
            let (keys, items) = (&mut keys[start..][..size], &mut items[start..][..size]);
            let node = &tree.nodes[Reference(currents[place]).index()];
            let limit = flight.nearest.t_max();
            let (met, near) = children_met(simd, node, &flight.ray, limit);
            let (free_keys, free_items) = free(keys, items, flight.top);
            flight.top += simd.store_sorted(met, near, &node.children, free_keys, free_items);
            currents[place] = next(simd, tree, flight, items);
        }

        // Test all leaves, and then look closer where something may be hit.
        let mut hit_places = [0; RAYS];
        let mut hit_count = 0;
        for &place in leaves {
            let Flight { ray, nearest, hits, .. } = &mut flying[place as usize];
            let leaf = Reference(currents[place as usize]);
            *hits = leaf_hits(simd, tree, geometry, leaf, ray, nearest.t_max());
            hit_places[hit_count % RAYS] = place;
            hit_count += usize::from(hits.hit | hits.doubtful != 0);
        }
        for &place in &hit_places[..hit_count] {
            let place = place as usize;
            let Flight { ray, nearest, hits, top, .. } = &mut flying[place];
            let leaf = Reference(currents[place]);
            if ANY {
                if any_blocks(tree, geometry, leaf, hits, ray) {
                    nearest.block();
                    *top = 1;
                }
            } else {
                let before = nearest.t_max();
                take_closest(tree, geometry, leaf, hits, ray, nearest);
                if nearest.t_max() < before {
                    let start = place * size;
                    let (keys, items) = (&mut keys[start..][..size], &mut items[start..][..size]);
                    *top = simd.retain(keys, items, *top, lengthened(nearest.t_max()));
                }
            }
        }
        for &place in leaves {
            let place = place as usize;
            currents[place] = next(simd, tree, &mut flying[place], &items[place * size..][..size]);
        }
    }
}

/// Takes the next node or leaf from the ray's stack and asks for its memory.
#[inline(always)]
fn next<S: Simd>(simd: S, tree: &WideBvh, flight: &mut Flight, items: &[u32]) -> u32 {
    flight.top -= 1;
    let reference = Reference(items[flight.top]);
    simd.prefetch(tree.address(reference));
    reference.0
}
