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
    /// Where it goes next.
    current: Reference,
    /// How many items are on its stack.
    top: usize,
    /// What was found in the last leaf.
    hits: BlockHits,
}

/// What a ray does next: the number of its list.
const NODE: usize = 0;
const LEAF: usize = 1;
const DONE: usize = 2;

/// Which rays do what next.
#[derive(Clone, Copy)]
struct Lists {
    rays: [[u8; RAYS]; 3],
    counts: [usize; 3],
}

impl Lists {
    const EMPTY: Self = Self { rays: [[0; RAYS]; 3], counts: [0; 3] };

    /// Adds a ray to the list of what its next place wants.
    #[inline(always)]
    fn add(&mut self, place: u8, current: Reference) {
        let kind =
            if current == Reference::NOTHING { DONE } else { usize::from(current.is_leaf()) };
        self.rays[kind][self.counts[kind] % RAYS] = place;
        self.counts[kind] += 1;
    }

    /// The rays of a list.
    #[inline(always)]
    fn of(&self, kind: usize) -> &[u8] {
        &self.rays[kind][..self.counts[kind]]
    }
}

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
    let flights = RAYS.min(rays.len());
    let (mut keys, mut items) = (vec![0.0f32; flights * size], vec![0u32; flights * size]);

    // Below all lies the end, nearer than any limit.
    for place in 0..flights {
        (keys[place * size], items[place * size]) = (f32::NEG_INFINITY, Reference::NOTHING.0);
    }
    let mut waiting =
        rays.iter().enumerate().filter_map(|(number, ray)| Some((number, PreparedRay::new(ray)?)));
    let mut begin = |place: u8, lists: &mut Lists| {
        let (number, ray) = waiting.next()?;
        lists.add(place, tree.root);
        let nearest = Nearest::new(&ray);
        Some(Flight { nearest, ray, number, current: tree.root, top: 1, hits: BlockHits::NONE })
    };
    let mut lists = Lists::EMPTY;
    let mut flying = Vec::with_capacity(flights);
    for place in 0..flights {
        flying.extend(begin(place as u8, &mut lists));
    }

    loop {
        let now = std::mem::replace(&mut lists, Lists::EMPTY);

        // Those whose way has ended make room for others.
        for &place in now.of(DONE) {
            let flight = &mut flying[usize::from(place)];
            let number = flight.number;
            let ended = std::mem::replace(&mut flight.nearest, Nearest::new(&flight.ray));
            finish(number, ended);
            if let Some(next) = begin(place, &mut lists) {
                *flight = next;
            }
        }
        if now.counts[NODE] + now.counts[LEAF] + lists.counts.iter().sum::<usize>() == 0 {
            return;
        }

        for &place in now.of(NODE) {
            let flight = &mut flying[usize::from(place)];
            let start = usize::from(place) * size;
            let (keys, items) = (&mut keys[start..][..size], &mut items[start..][..size]);
            let node = &tree.nodes[flight.current.index()];
            let limit = flight.nearest.t_max();
            let (met, near) = children_met(simd, node, &flight.ray, limit);
            let (free_keys, free_items) = free(keys, items, flight.top);
            flight.top += simd.store_sorted(met, near, &node.children, free_keys, free_items);
            next(simd, tree, flight, items);
            lists.add(place, flight.current);
        }

        // Test all leaves, and then look closer where something may be hit.
        let mut hit_places = [0u8; RAYS];
        let mut hit_count = 0;
        for &place in now.of(LEAF) {
            let Flight { ray, nearest, current, hits, .. } = &mut flying[usize::from(place)];
            *hits = leaf_hits(simd, tree, geometry, *current, ray, nearest.t_max());
            hit_places[hit_count % RAYS] = place;
            hit_count += usize::from(hits.hit | hits.doubtful != 0);
        }
        for &place in &hit_places[..hit_count] {
            let Flight { ray, nearest, current, hits, top, .. } = &mut flying[usize::from(place)];
            let start = usize::from(place) * size;
            let (keys, items) = (&mut keys[start..][..size], &mut items[start..][..size]);
            if ANY {
                if any_blocks(tree, geometry, *current, hits, ray) {
                    nearest.block();
                    *top = 1;
                }
            } else {
                let before = nearest.t_max();
                take_closest(tree, geometry, *current, hits, ray, nearest);
                if nearest.t_max() < before {
                    *top = simd.retain(keys, items, *top, lengthened(nearest.t_max()));
                }
            }
        }
        for &place in now.of(LEAF) {
            let flight = &mut flying[usize::from(place)];
            next(simd, tree, flight, &items[usize::from(place) * size..][..size]);
            lists.add(place, flight.current);
        }
    }
}

/// Takes the next node or leaf from the ray's stack and asks for its memory.
#[inline(always)]
fn next<S: Simd>(simd: S, tree: &WideBvh, flight: &mut Flight, items: &[u32]) {
    flight.top -= 1;
    flight.current = Reference(items[flight.top]);
    let index = flight.current.index();
    if flight.current.is_leaf() {
        if let Some(block) = tree.blocks.get(index) {
            simd.prefetch(block);
        }
    } else if let Some(node) = tree.nodes.get(index) {
        simd.prefetch(node);
    }
}
