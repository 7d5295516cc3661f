//! Many rays through the wide tree, dozens in flight at a time.
//!
//! A single ray waits: for nodes from memory, and for the processor to find out which way a branch goes. Here each ray takes one step and then the
//! next ray's turn comes, so that the memory of its next node arrives meanwhile, and rays wait in lists by what they do next, so that no branch
//! depends on it.

use super::flight::Flight;
use super::node::Reference;
use super::node_steps::NodeSteps;
use super::ray_search::{InSingle, RaySearch};
use super::sink::Sink;
use super::source::Source;
use super::{WideBvh, packet};
use crate::simd::{Kernel, PLACES, Simd, dispatch_on};
use crate::{Geometry, Hit};

/// How many rays are in flight: as many as hide the time that memory takes, and no more, for what belongs to them should stay in the nearest cache.
pub(super) const RAYS: usize = PLACES;

/// Finds the closest hits of many rays.
pub(super) struct Closest<'a, R, H, const FAST: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) rays: R,
    pub(super) hits: H,
}

impl<R: Source, H: Sink, const FAST: bool> Kernel for Closest<'_, R, H, FAST> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, geometry, rays, mut hits } = self;
        let mut rest = Vec::new();
        let mut scratch = packet::Scratch::new(tree);
        for first in (0..rays.len()).step_by(packet::RAYS) {
            prefetch_next(simd, &rays, first);
            let piece =
                packet::Piece { tree, geometry, rays: rays.part(first, packet::RAYS), first };
            let mut hits = hits.part(first, piece.rays.len());
            packet::closest::<S, R, _, FAST>(simd, &piece, &mut hits, &mut scratch, &mut rest);
        }
        for &number in &rest {
            hits.set(number, None);
        }
        let finish = |number: usize, found: Found<Hit>| hits.set(number, found.hit);
        let rest = rest.iter().map(|&number| (number, rays.ray(number)));
        let wave =
            Wave::<InSingle<FAST>, _, _, false> { tree, scene: geometry, rays: rest, finish };
        let spilled = dispatch_on(tree.level, wave);
        for number in spilled {
            hits.set(number, tree.closest_hit(geometry, &rays.ray(number)));
        }
    }
}

/// Asks for the rays of the packet after that which begins with `first`: processors do not foresee that these are next, as other memory is read in between.
#[inline(always)]
fn prefetch_next<S: Simd, R: Source>(simd: S, rays: &R, first: usize) {
    rays.part(first + packet::RAYS, packet::RAYS).prefetch(simd);
}

/// Finds out whether anything blocks each of many rays.
pub(super) struct Any<'a, R, const FAST: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) rays: R,
    pub(super) occluded: &'a mut [bool],
}

impl<R: Source, const FAST: bool> Kernel for Any<'_, R, FAST> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, geometry, rays, occluded } = self;
        let mut rest = Vec::new();
        let mut scratch = packet::Scratch::new(tree);
        for (number, occluded) in occluded.chunks_mut(packet::RAYS).enumerate() {
            let first = number * packet::RAYS;
            prefetch_next(simd, &rays, first);
            let piece =
                packet::Piece { tree, geometry, rays: rays.part(first, packet::RAYS), first };
            packet::any::<S, R, FAST>(simd, &piece, occluded, &mut scratch, &mut rest);
        }
        for &number in &rest {
            occluded[number] = false;
        }
        let finish = |number: usize, found: Found<Hit>| occluded[number] = found.is_blocked;
        let rest = rest.iter().map(|&number| (number, rays.ray(number)));
        let wave = Wave::<InSingle<FAST>, _, _, true> { tree, scene: geometry, rays: rest, finish };
        let spilled = dispatch_on(tree.level, wave);
        for number in spilled {
            occluded[number] = tree.any_hit(geometry, &rays.ray(number));
        }
    }
}

/// Where there is no ray in flight: neither a node nor a leaf, nor the end of a ray's way.
const IDLE: u32 = Reference::NOTHING.0 - 2;

/// What a ray found: with `ANY` whether something blocks it, else the closest hit.
pub(super) struct Found<H> {
    pub(super) hit: Option<H>,
    pub(super) is_blocked: bool,
}

/// Traces rays, given with their numbers, and tells `finish` what each found. With `ANY` a ray ends with its first hit. Returns the numbers of the rays that
/// found no room for their stacks and must be traced otherwise.
///
/// A function of its own: together with the packets, its loops would be short of registers.
pub(super) struct Wave<'a, Q: RaySearch, I, F, const ANY: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) scene: Q::Scene<'a>,
    pub(super) rays: I,
    pub(super) finish: F,
}

impl<Q, I, F, const ANY: bool> Kernel for Wave<'_, Q, I, F, ANY>
where
    Q: RaySearch,
    I: Iterator<Item = (usize, Q::Ray)>,
    F: FnMut(usize, Found<Q::Hit>),
{
    type Output = Vec<usize>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Vec<usize> {
        let Self { tree, scene, rays: mut waiting, mut finish } = self;
        let most = waiting.size_hint().1.unwrap_or(RAYS);
        let mut flights = Vec::<Flight<Q>>::with_capacity(RAYS.min(most));
        let mut currents = [IDLE; RAYS];
        for current in &mut currents {
            let Some((number, ray)) = next_valid::<_, Q>(simd, &mut waiting) else { break };
            *current = tree.root.0;
            flights.push(Flight::new(Q::new(simd, scene, &ray), number, tree));
        }
        let flights = &mut flights[..];
        let mut spilled = Vec::new();
        let mut lists = [[0; RAYS + 16]; 3];
        let mut hits = [const { (0, Q::NO_HITS) }; RAYS + 1];
        loop {
            // Find out which rays do what next: all sixteen places at a time, without a branch.
            let counts = simd.partition(&currents, IDLE, Reference::NOTHING.0, &mut lists);
            let [nodes, leaves, done] = &lists;
            let (nodes, leaves, done) =
                (&nodes[..counts[0]], &leaves[..counts[1]], &done[..counts[2]]);
            if counts == [0; 3] {
                return spilled;
            }

            // Those whose way has ended make room for others.
            for &place in done {
                let place = place as usize;
                let flight = &mut flights[place];
                let search = &flight.search;
                let found = match ANY {
                    true => Found { hit: None, is_blocked: search.is_blocked() },
                    false => Found { hit: search.hit(scene), is_blocked: false },
                };
                finish(flight.number, found);
                currents[place] = IDLE;
                if let Some((number, ray)) = next_valid::<_, Q>(simd, &mut waiting) {
                    flight.begin(Q::new(simd, scene, &ray), number, tree);
                    currents[place] = tree.root.0;
                }
            }

            let steps =
                NodeSteps::<Q, ANY> { tree, flights, currents: &mut currents, places: nodes };
            let mut full = simd.apart(steps);
            while full != 0 {
                let place = full.trailing_zeros() as usize;
                full &= full - 1;
                spilled.push(flights[place].number);
                currents[place] = Reference::NOTHING.0;
            }

            // Test all leaves, and then look closer where something may be hit: in double precision at what lies elsewhere in memory.
            let mut count = 0;
            for &place in leaves {
                let place = place as usize;
                let leaf = Reference(currents[place]);
                let found = flights[place].search.test_leaf(simd, tree, leaf);
                let some = Q::may_hit(&found);
                hits[count] = (place, found);
                count += usize::from(some);
            }
            if Q::IS_ROUNDED {
                for (place, found) in &hits[..count] {
                    let leaf = Reference(currents[*place]);
                    flights[*place].search.prefetch::<false>(tree, scene, leaf, found);
                }
                for (place, found) in &hits[..count] {
                    let leaf = Reference(currents[*place]);
                    flights[*place].search.prefetch::<true>(tree, scene, leaf, found);
                }
            }
            for (place, found) in &hits[..count] {
                let flight = &mut flights[*place];
                let leaf = Reference(currents[*place]);
                if ANY {
                    if flight.search.is_blocked_by(simd, tree, scene, leaf, found) {
                        flight.search.block();
                        flight.end();
                    }
                } else if flight.search.take_closest(simd, tree, scene, leaf, found) {
                    flight.cull(simd);
                }
            }
            for &place in leaves {
                let place = place as usize;
                currents[place] = next(simd, tree, &mut flights[place]);
            }
        }
    }
}

/// The next ray that is valid, with its number.
#[inline(always)]
fn next_valid<S: Simd, Q: RaySearch>(
    simd: S,
    rays: &mut impl Iterator<Item = (usize, Q::Ray)>,
) -> Option<(usize, Q::Ray)> {
    loop {
        let (number, ray) = rays.next()?;
        if Q::is_valid(simd, &ray) {
            return Some((number, ray));
        }
    }
}

/// Takes the next node or leaf from the ray's stack and asks for its memory.
#[inline(always)]
fn next<S: Simd, Q: RaySearch>(simd: S, tree: &WideBvh, flight: &mut Flight<Q>) -> u32 {
    let reference = flight.pop();
    simd.prefetch(tree.address(reference));
    reference.0
}
