//! Large packets: up to 256 rays through one point, or in one direction, together through the wide tree.
//!
//! Seen from their common point, rays are points of a plane, and everything about them is linear. Sixteen groups of sixteen rays go down the tree
//! together; a child is entered by the groups whose pyramids meet its box. What is found of a triangle once serves all rays: Wald, Slusallek, Benthin and
//! Wagner, "Interactive Rendering with Coherent Ray Tracing", CGF 2001; Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH
//! 2005; Fuetterling, Lojewski, Pfreundt and Ebert, "Efficient Ray Tracing Kernels for Modern CPU Architectures", JCGT 2015.

mod frame;
mod gather;
mod groups;
mod image;
mod kind;
mod leaving;
mod meeting;
mod parallel;
mod sort;
#[cfg(test)]
mod tests;
mod triangles;
mod waiting;

use super::WideBvh;
use super::node::{Reference, WIDTH};
use super::sink::{Sink, SixteenHits};
use super::source::{Common, Source};
use super::step;
use crate::geometry::LANES;
use crate::simd::{Float, Simd, dispatch_on};
use crate::traverse::nearest::hit as hit_one;
use crate::{Geometry, Hit, HitColumns, PreparedRay};
use frame::Frame;
use groups::Groups;
use kind::{Blocked, BlockedParallel, Closest, Kind, Reflected};
use leaving::{Leaving, Plane};
use triangles::{GREATEST_VOLUME, TRIANGLES, Triangles};
use waiting::Waiting;

/// How many rays a packet has at most.
pub(super) const RAYS: usize = 256;

/// How many rays a group has, and a packet groups.
const GROUP: usize = 16;

/// Rays through one point, or parallel ones (see [`parallel`]). A group of sixteen rays a row.
#[repr(C, align(64))]
pub(super) struct Packet {
    /// Coordinates per depth, along the frame's first and second axis.
    slopes: [[[f32; GROUP]; GROUP]; 2],
    /// One over the depth of the closest hit so far, at first of the ray's end; infinite when nothing counts any more. Of parallel rays the depth's negative.
    nearest: [[f32; GROUP]; GROUP],
    /// The weights of the second and third corner where it was hit, over the depth.
    weights: [[[f32; GROUP]; GROUP]; 2],
    /// The bits of the number of the primitive that was hit.
    primitives: [[f32; GROUP]; GROUP],
    /// Distance per depth.
    scales: [[f32; GROUP]; GROUP],
    /// At which depth each ray starts, where that is not at the common point.
    starts: [[f32; GROUP]; GROUP],
    groups: Groups,
    frame: Frame,
    /// One over the depth at which the last ray starts to count; infinite for parallel rays.
    start: f32,
    /// Whether any ray ends.
    is_bounded: bool,
    /// The groups whose rays are others than in the slice.
    sorted: u32,
    /// The rays of the slice that no packet has taken.
    waiting: Waiting,
    /// Whether there was another packet of the same slice before.
    is_later: bool,
    /// Which ray of the slice each one is.
    numbers: [[u8; GROUP]; GROUP],
    /// How many triangles each group was tested against.
    work: [f32; GROUP],
    /// The rays of each group that must be traced alone after all.
    alone: [u32; GROUP],
    /// The rays of each group that are in the packet.
    members: [u32; GROUP],
    /// Triangles of two leaves with groups that may hit them, from place 1 on; each as 16 times the triangle's lane and the group.
    pairs: [u32; 1 + (TRIANGLES + 1) * GROUP],
}

/// The pairs of each triangle of two leaves with every group.
const PAIRS: [[u32; GROUP]; TRIANGLES] = {
    let mut pairs = [[0; GROUP]; TRIANGLES];
    let mut pair = 0;
    while pair < TRIANGLES * GROUP {
        pairs[pair / GROUP][pair % GROUP] = pair as u32;
        pair += 1;
    }
    pairs
};

/// Depths with a larger relative error are not trusted: the triangle test of single rays decides.
const TOLERANCE: f32 = 1.0 / 4096.0;

/// The same where depths need not be known, only whether they are less than another one.
const LARGE_TOLERANCE: f32 = 1.0 / 64.0;

/// A group is given up when it was tested against more triangles than this: about as long does it take to trace its rays one by one.
const MOST_WORK: f32 = 128.0;

/// What an edge function's error hardly ever exceeds, as a share of what it may be.
const LIKELY_ERROR: f32 = 1.0 / 16.0;

/// From so many rays of a group on they are asked together whether they leave a triangle's plane.
const SEVERAL: u32 = 4;

/// Sixteen bits.
const ALL: u32 = 0xffff;

/// By how much of itself a depth, and its share of the start's, may be off but for the tolerance.
const START_ERROR: f32 = 1.0 / (1 << 22) as f32;

/// Hits nearer to a ray's start than this share of its distance from the common point are looked for from the start.
const NEAR: f32 = 1.0 / 512.0;

/// Stands for a primitive where none was hit.
const NONE: u32 = HitColumns::NONE;

/// What waits to be visited.
#[derive(Clone, Copy)]
struct Item {
    reference: Reference,
    /// The groups that meet its box.
    groups: u32,
    /// From which depth on the packet is in its box.
    near: f32,
}

/// A leaf that is visited.
#[derive(Clone, Copy)]
struct Leaf {
    reference: Reference,
    /// The groups that meet its box.
    groups: u32,
}

/// Rays for a packet, and what they are sent through.
pub(super) struct Piece<'a, G, R> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a G,
    /// At most 256.
    pub(super) rays: R,
    /// The number of the first among all rays of the batch.
    pub(super) first: usize,
}

/// The memory that tracing packets needs, for one packet after the other.
pub(super) struct Scratch {
    packet: Box<Packet>,
    stack: Vec<Item>,
}

impl Scratch {
    pub(super) fn new(tree: &WideBvh) -> Self {
        let nothing = Item { reference: Reference::NOTHING, groups: 0, near: 0.0 };
        Self { packet: Box::new(Packet::empty()), stack: vec![nothing; tree.stack_size()] }
    }
}

/// Finds the closest hits of rays that share their origin. Appends the numbers of rays that must be traced otherwise to `rest`.
#[inline(always)]
pub(super) fn closest<S: Simd, G: Geometry, R: Source, H: Sink, const FAST: bool>(
    simd: S,
    piece: &Piece<'_, G, R>,
    hits: &mut H,
    scratch: &mut Scratch,
    rest: &mut Vec<usize>,
) {
    let Scratch { packet, stack } = scratch;
    packet.begin(piece.rays.len());
    while let Some(common) = packet.gather::<S, R, false>(simd, &piece.rays, piece.tree.reach) {
        // While the packet is under way, the place for its hits arrives.
        hits.prefetch(simd);
        match common {
            Common::Image => {
                packet.trace::<S, G, R, Reflected, FAST>(simd, piece, stack);
                packet.finish::<S, R, H, Reflected>(simd, &piece.rays, hits, rest, piece.first);
            }
            _ => {
                packet.trace::<S, G, R, Closest, FAST>(simd, piece, stack);
                packet.finish::<S, R, H, Closest>(simd, &piece.rays, hits, rest, piece.first);
            }
        }
        packet.is_later = true;
    }
    packet.waiting.append_to(rest, piece.first);
}

/// Finds out whether anything blocks rays that share their origin, their end or their direction. Appends the numbers of rays that must be traced otherwise to `rest`.
#[inline(always)]
pub(super) fn any<S: Simd, G: Geometry, R: Source, const FAST: bool>(
    simd: S,
    piece: &Piece<'_, G, R>,
    occluded: &mut [bool],
    scratch: &mut Scratch,
    rest: &mut Vec<usize>,
) {
    let Scratch { packet, stack } = scratch;
    packet.begin(piece.rays.len());
    while let Some(common) = packet.gather::<S, R, true>(simd, &piece.rays, piece.tree.reach) {
        match common {
            Common::Direction => {
                packet.trace::<S, G, R, BlockedParallel, FAST>(simd, piece, stack);
            }
            _ => packet.trace::<S, G, R, Blocked, FAST>(simd, piece, stack),
        }
        packet.finish_any(simd, occluded, rest, piece.first);
        packet.is_later = true;
    }
    packet.waiting.append_to(rest, piece.first);
}

impl Packet {
    fn empty() -> Self {
        let zeros = [[0.0; GROUP]; GROUP];
        Self {
            slopes: [zeros; 2],
            nearest: zeros,
            weights: [zeros; 2],
            primitives: zeros,
            scales: zeros,
            starts: zeros,
            groups: Groups::NONE,
            frame: Frame::new(crate::Vec3::ZERO, 0.0, crate::Vec3::ZERO),
            start: f32::INFINITY,
            is_bounded: false,
            sorted: 0,
            waiting: Waiting::first(0),
            is_later: false,
            numbers: [[0; GROUP]; GROUP],
            work: [0.0; GROUP],
            alone: [0; GROUP],
            members: [0; GROUP],
            pairs: [0; 1 + (TRIANGLES + 1) * GROUP],
        }
    }

    /// Has so many rays wait for being taken into packets.
    #[inline(always)]
    fn begin(&mut self, count: usize) {
        self.waiting = Waiting::first(count);
        self.is_later = false;
    }

    /// Sends the packet through the tree.
    #[inline(always)]
    fn trace<S: Simd, G: Geometry, R: Source, K: Kind, const FAST: bool>(
        &mut self,
        simd: S,
        piece: &Piece<'_, G, R>,
        stack: &mut [Item],
    ) {
        if piece.tree.root == Reference::NOTHING {
            return;
        }
        self.work = [0.0; GROUP];
        self.alone = [0; GROUP];
        let near = if K::PARALLEL { f32::NEG_INFINITY } else { 0.0 };
        stack[0] = Item { reference: piece.tree.root, groups: self.groups.live, near };
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let Item { reference, groups, near } = stack[top];
            let groups = groups & self.groups.reaching::<S, K>(simd, &self.frame, near);
            if groups == 0 {
                continue;
            }
            if reference.is_leaf() {
                // With the next one, if that is a leaf as well: the work on sixteen triangles is that on one.
                let mut leaves = [Leaf { reference, groups }, Leaf { reference, groups: 0 }];
                if top > 0 && stack[top - 1].reference.is_leaf() {
                    top -= 1;
                    let Item { reference, groups, near } = stack[top];
                    let groups = groups & self.groups.reaching::<S, K>(simd, &self.frame, near);
                    leaves[1] = Leaf { reference, groups };
                }
                self.visit_leaves::<S, G, R, K, FAST>(simd, piece, leaves);
            } else {
                top +=
                    self.enter_node::<S, K>(simd, piece.tree, reference, groups, &mut stack[top..]);
            }
        }
    }

    /// Puts the children of a node that some group meets onto the stack, the nearest last, and tells how many these are.
    #[inline(always)]
    fn enter_node<S: Simd, K: Kind>(
        &self,
        simd: S,
        tree: &WideBvh,
        reference: Reference,
        groups: u32,
        stack: &mut [Item],
    ) -> usize {
        // The children that the packet as a whole meets.
        let node = tree.node(reference);
        let boxes = self.frame.boxes(simd, &node.planes);
        let (met, near) = match K::PARALLEL {
            true => self.groups.met_by_any_parallel(simd, &self.frame, &boxes),
            false => self.groups.met_by_any(simd, &boxes),
        };
        let [[low_x, low_y, low_z], [high_x, high_y, high_z]] = boxes;
        let low = [low_x.to_array(), low_y.to_array(), low_z.to_array()];
        let high = [high_x.to_array(), high_y.to_array(), high_z.to_array()];

        // Of these those that some group meets.
        let mut meeting = [0; WIDTH];
        let (mut left, mut entered) = (met, 0);
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            simd.prefetch(tree.address(Reference(node.children[lane])));
            let low = [low[0][lane], low[1][lane], low[2][lane]];
            let high = [high[0][lane], high[1][lane], high[2][lane]];
            let met = match K::PARALLEL {
                true => self.groups.meeting_parallel(simd, &self.frame, low, high),
                false => self.groups.meeting(simd, low, high),
            };
            meeting[lane] = met & groups;
            entered |= u32::from(meeting[lane] != 0) << lane;
        }

        // A child's place on the stack is the number of those that are entered later, or equally soon and have a higher number.
        let count = entered.count_ones() as usize;
        let stack = &mut stack[..WIDTH];
        let depths = near.to_array();
        let mut left = entered;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let depth = simd.splat16(depths[lane]);
            let later =
                depth.less(near) | (depth.less_or_equal(near) & !(2u32 << lane).wrapping_sub(1));
            let place = (later & entered).count_ones() as usize;
            let reference = Reference(node.children[lane]);
            stack[place] = Item { reference, groups: meeting[lane], near: depths[lane] };
        }
        count
    }

    /// Tests the primitives of two leaves against the rays of some groups each.
    #[inline(always)]
    fn visit_leaves<S: Simd, G: Geometry, R: Source, K: Kind, const FAST: bool>(
        &mut self,
        simd: S,
        piece: &Piece<'_, G, R>,
        leaves: [Leaf; 2],
    ) {
        let [first, second] = leaves;
        let blocks = [piece.tree.block(first.reference), piece.tree.block(second.reference)];
        let mut lanes = 0;
        let mut others = 0;
        for (place, leaf) in leaves.iter().enumerate() {
            if leaf.groups != 0 {
                let here = step::others(piece.geometry, &blocks[place].primitives, leaf.reference);
                others |= here << (place * LANES);
                lanes |= (leaf.reference.lanes() & !here) << (place * LANES);
            }
        }
        let tolerance = if K::ANY { LARGE_TOLERANCE } else { TOLERANCE };
        let (frame, all) = (&self.frame, &self.groups);
        let triangles = match K::PARALLEL {
            true => Triangles::parallel(simd, blocks, lanes, frame, all),
            false => Triangles::new(simd, blocks, lanes, frame, all, tolerance),
        };

        // Which groups may hit which triangles: first all pairs, then one loop over them, so that the processor foresees its end.
        let mut work = simd.load16(&self.work);
        let mut count = 0;
        let mut left = triangles.possible & !triangles.unknown;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % TRIANGLES;
            left &= left - 1;
            let meeting =
                triangles.groups::<S, K>(simd, lane, &self.groups) & leaves[lane / LANES].groups;
            work = work.replaced(meeting, work + simd.splat16(1.0));
            count += simd.push_chosen(meeting, &PAIRS[lane], &mut self.pairs, 1 + count).0;
        }
        let mut touched = 0;
        for place in 1..=count {
            let pair = self.pairs[place] as usize;
            let (lane, group) = (pair / GROUP % TRIANGLES, pair % GROUP);
            let primitive = f32::from_bits(blocks[lane / LANES].primitives[lane % LANES]);
            let (hit, doubtful) = self.test::<S, K, FAST>(simd, &triangles, lane, group, primitive);
            touched |= u32::from(hit | doubtful != 0) << group;
            if doubtful != 0 {
                let leaf = leaves[lane / LANES].reference;
                self.settle::<G, R, K>(piece, leaf, lane % LANES, group, doubtful);
            }
        }
        let mut left = if FAST { others } else { others | triangles.possible & triangles.unknown };
        while left != 0 {
            let lane = left.trailing_zeros() as usize % TRIANGLES;
            left &= left - 1;
            let Leaf { reference, groups } = leaves[lane / LANES];
            touched |= groups;
            for group in (0..GROUP).filter(|group| groups >> group & 1 == 1) {
                let mut members = self.members[group];
                if K::PARALLEL && others >> lane & 1 == 0 {
                    members &= triangles.passing(simd, lane, &self.slopes, group);
                }
                self.settle::<G, R, K>(piece, reference, lane % LANES, group, members);
            }
        }

        // How far the groups still have to look.
        let mut left = touched;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUP;
            left &= left - 1;
            self.groups.least[group] = simd.load16(&self.nearest[group]).least();
        }
        self.groups.look_again::<S, K>(simd);

        // Give up groups that take more work than their rays would take one by one.
        self.work = work.to_array();
        let too_much = simd.splat16(MOST_WORK).less(work) & self.groups.live;
        let mut left = too_much;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUP;
            left &= left - 1;
            self.alone[group] = self.members[group];
        }
        self.groups.live &= !too_much;
    }

    /// Tests a triangle against the rays of a group and takes what is certainly hit. Returns the rays for which that is not certain.
    #[inline(always)]
    fn test<S: Simd, K: Kind, const FAST: bool>(
        &mut self,
        simd: S,
        triangles: &Triangles,
        lane: usize,
        group: usize,
        primitive: f32,
    ) -> (u32, u32) {
        let x = simd.load16(&self.slopes[0][group]);
        let y = simd.load16(&self.slopes[1][group]);
        let edge_a = triangles.function(simd, 0, lane, x, y);
        let edge_b = triangles.function(simd, 1, lane, x, y);
        let edge_c = triangles.function(simd, 2, lane, x, y);
        let depth = triangles.function(simd, 3, lane, x, y);
        let least = edge_a.smaller(edge_b).smaller(edge_c);
        if FAST {
            return self.take_fast::<S, K>(
                simd,
                least,
                depth,
                [edge_b, edge_c],
                (group, primitive),
                (triangles.errors[lane], triangles.tolerances[lane]),
            );
        }
        let (error, certainly) = (triangles.errors[lane], triangles.certain[lane]);
        let nearest = simd.load16(&self.nearest[group]);
        let tolerance = simd.splat16(triangles.tolerances[lane]);
        let error_of_depth = if K::PARALLEL { tolerance } else { depth * tolerance };
        let more = depth + error_of_depth;
        if K::ANY {
            let less = depth - error_of_depth;
            let possible = simd.splat16(-error).less_or_equal(least) & nearest.less(more);
            let certain = simd.splat16(certainly).less(least)
                & nearest.less(less)
                & more.less(simd.splat16(self.start));
            let blocked = simd.splat16(f32::INFINITY);
            let hit = possible & certain;
            self.nearest[group] = nearest.replaced(hit, blocked).to_array();
            return (hit, possible & !certain);
        }
        let possible = simd.splat16(-error).less_or_equal(least) & nearest.less(more);
        let (late, certainly_late) =
            self.behind_start::<S, K>(simd, depth, triangles.tolerances[lane], group);
        let possible = possible & late;
        let hit = possible & simd.splat16(certainly).less(least) & certainly_late;
        let doubtful = possible & !hit;

        self.take(simd, hit, depth, [edge_b, edge_c], group, primitive);
        (hit, doubtful)
    }

    /// Takes what is hit as far as rounding allows to tell.
    #[inline(always)]
    fn take_fast<S: Simd, K: Kind>(
        &mut self,
        simd: S,
        least: S::F16,
        depth: S::F16,
        weights: [S::F16; 2],
        (group, primitive): (usize, f32),
        (error, tolerance): (f32, f32),
    ) -> (u32, u32) {
        let nearest = simd.load16(&self.nearest[group]);
        if K::ANY {
            // Seen from the light triangles are small, and at silhouettes rounding tells by some millionths wrongly which rays are in shadow.
            let likely = simd.splat16(error * LIKELY_ERROR);
            let near_edge = simd.splat16(0.0) - likely;
            let before = nearest.less(depth) & depth.less(simd.splat16(self.start));
            let possible = near_edge.less_or_equal(least) & before;
            let hit = likely.less(least) & before;
            let blocked = simd.splat16(f32::INFINITY);
            self.nearest[group] = nearest.replaced(hit, blocked).to_array();
            return (hit, possible & !hit);
        }
        let possible = simd.splat16(0.0).less_or_equal(least) & nearest.less(depth);
        let (late, certainly_late) = self.behind_start::<S, K>(simd, depth, tolerance, group);
        let hit = possible & certainly_late;
        self.take(simd, hit, depth, weights, group, primitive);
        (hit, possible & late & !hit)
    }

    /// Where one over a `depth` is that of a point behind the ray's start, as far as that can be told: perhaps, and certainly and so far behind that the distance from there is known well.
    #[inline(always)]
    fn behind_start<S: Simd, K: Kind>(
        &self,
        simd: S,
        depth: S::F16,
        tolerance: f32,
        group: usize,
    ) -> (u32, u32) {
        if !K::LATE {
            return (ALL, ALL);
        }
        // One at the start, and the less the farther away.
        let share = depth * simd.load16(&self.starts[group]);
        let error = tolerance + START_ERROR;
        let perhaps = share.less_or_equal(simd.splat16(1.0 + error));
        (perhaps, share.less_or_equal(simd.splat16(1.0 - error / TOLERANCE)))
    }

    /// Takes hits that are nearer than what the rays have.
    #[inline(always)]
    fn take<S: Simd>(
        &mut self,
        simd: S,
        hit: u32,
        depth: S::F16,
        weights: [S::F16; 2],
        group: usize,
        primitive: f32,
    ) {
        let nearest = simd.load16(&self.nearest[group]);
        // The largest of the old and what is larger where hit: written whole, so that it can be read again at once.
        let nowhere = simd.splat16(f32::NEG_INFINITY);
        self.nearest[group] = nowhere.replaced(hit, depth).larger(nearest).to_array();
        let primitives = simd.load16(&self.primitives[group]);
        self.primitives[group] = primitives.replaced(hit, simd.splat16(primitive)).to_array();
        let [for_b, for_c] = weights;
        let weights = simd.load16(&self.weights[0][group]);
        self.weights[0][group] = weights.replaced(hit, for_b).to_array();
        let weights = simd.load16(&self.weights[1][group]);
        self.weights[1][group] = weights.replaced(hit, for_c).to_array();
    }

    /// Tests a triangle against some rays of a group as single rays are tested, which is exact.
    #[cold]
    #[inline(never)]
    fn settle<G: Geometry, R: Source, K: Kind>(
        &mut self,
        piece: &Piece<'_, G, R>,
        leaf: Reference,
        lane: usize,
        group: usize,
        doubtful: u32,
    ) {
        let block = piece.tree.block(leaf);
        let is_triangle =
            !leaf.is_mixed() || piece.geometry.triangle(block.primitives[lane]).is_some();
        let plane = ((K::ANY || K::LATE) && is_triangle).then(|| Plane::of(block.corners(lane)));
        let mut doubtful = doubtful;
        let plane = match plane {
            Some(plane) if doubtful.count_ones() >= SEVERAL => {
                let (packet, rays) = (&*self, &piece.rays);
                let leaving = Leaving { packet, rays, group, some: doubtful, plane };
                doubtful &= !dispatch_on(piece.tree.level, leaving);
                None
            }
            few => few,
        };
        for place in (0..GROUP).filter(|place| doubtful >> place & 1 == 1) {
            if self.nearest[group][place] == f32::INFINITY {
                continue;
            }
            let number = usize::from(self.numbers[group][place]);
            let ray = piece.rays.ray(number);
            if plane.as_ref().is_some_and(|plane| plane.is_left_by(&ray)) {
                continue;
            }
            let Some(ray) = PreparedRay::new(&ray) else {
                continue;
            };
            let hit = match is_triangle {
                true => block.intersect_one(&ray, lane),
                false => hit_one(piece.geometry, &ray, block.primitives[lane]),
            };
            let Some(hit) = hit else { continue };
            let nearest = &mut self.nearest[group][place];
            if K::ANY {
                *nearest = f32::INFINITY;
                continue;
            }
            let (scale, start) = (self.scales[group][place], self.starts[group][place]);
            let (depth, near) = match K::LATE {
                true => (1.0 / (start + hit.t.abs() / scale), hit.t.abs() < start * scale * NEAR),
                false => (scale / hit.t.abs(), false),
            };
            if depth > GREATEST_VOLUME || near {
                // At the origin itself: nothing is nearer, and one over the depth cannot tell how near it is.
                self.alone[group] |= 1 << place;
                *nearest = f32::INFINITY;
            } else if depth > *nearest {
                *nearest = depth;
                self.primitives[group][place] = f32::from_bits(block.primitives[lane]);
                self.weights[0][group][place] = hit.u * depth;
                self.weights[1][group][place] = hit.v * depth;
            }
        }
    }

    /// Writes what was found.
    #[inline(always)]
    fn finish<S: Simd, R: Source, H: Sink, K: Kind>(
        &self,
        simd: S,
        rays: &R,
        hits: &mut H,
        rest: &mut Vec<usize>,
        first: usize,
    ) {
        let (zero, one) = (simd.splat16(0.0), simd.splat16(1.0));
        for group in 0..rays.len().div_ceil(GROUP) {
            let members = self.members[group];
            if members == 0 {
                continue;
            }
            let nearest = simd.load16(&self.nearest[group]);
            let depth = one / nearest;
            let from_start = match K::LATE {
                true => depth - simd.load16(&self.starts[group]),
                false => depth,
            };
            let found = SixteenHits {
                t: from_start * simd.load16(&self.scales[group]),
                u: depth * simd.load16(&self.weights[0][group]),
                v: depth * simd.load16(&self.weights[1][group]),
                primitives: self.primitives[group],
                hit: zero.less(nearest),
            };
            let is_sorted = self.sorted >> group & 1 == 1;
            if is_sorted || self.is_bounded || self.is_later && members != ALL {
                let numbers = [found.t.to_array(), found.u.to_array(), found.v.to_array()];
                self.finish_apart(rays, group, numbers, hits, (rest, first));
            } else {
                hits.set_sixteen(simd, group * GROUP, found);
            }
            if self.alone[group] != 0 {
                let alone = (0..GROUP).filter(|lane| self.alone[group] >> lane & 1 == 1);
                rest.extend(alone.map(|lane| first + usize::from(self.numbers[group][lane])));
            }
        }
    }

    /// Writes what the rays of a group found one by one: in their own order, and not what lies so near to a ray's end that only the exact test can tell.
    #[inline(never)]
    fn finish_apart<R: Source, H: Sink>(
        &self,
        rays: &R,
        group: usize,
        [t, u, v]: [[f32; GROUP]; 3],
        hits: &mut H,
        (rest, first): (&mut Vec<usize>, usize),
    ) {
        for lane in 0..GROUP {
            let number = usize::from(self.numbers[group][lane]);
            if self.members[group] >> lane & 1 == 0 {
                continue;
            }
            let primitive = self.primitives[group][lane].to_bits();
            let hit = Hit { t: t[lane], u: u[lane], v: v[lane], primitive, instance: 0 };
            let hit = (primitive != NONE).then_some(hit);
            hits.set(number, hit);
            if self.is_bounded && hit.is_some_and(|hit| hit.t > rays.ray(number).t_max * NEARLY) {
                rest.push(first + number);
            }
        }
    }

    /// Writes which rays are blocked.
    #[inline(always)]
    fn finish_any<S: Simd>(
        &self,
        simd: S,
        occluded: &mut [bool],
        rest: &mut Vec<usize>,
        first: usize,
    ) {
        let blocked = simd.splat16(f32::INFINITY);
        for group in 0..occluded.len().div_ceil(GROUP) {
            let found = blocked.less_or_equal(simd.load16(&self.nearest[group]));
            let members = self.members[group];
            if members == 0 {
                continue;
            }
            let found = found & members;
            let is_apart = self.sorted >> group & 1 == 1 || self.is_later && members != ALL;
            let answers = occluded[group * GROUP..].first_chunk_mut::<GROUP>();
            if let (false, Some(answers)) = (is_apart, answers) {
                *answers = truths(found);
            } else {
                for (lane, number) in self.numbers[group].iter().enumerate() {
                    if members >> lane & 1 == 1 {
                        occluded[usize::from(*number)] = found >> lane & 1 == 1;
                    }
                }
            }
            let alone = self.alone[group] & !found;
            if alone != 0 {
                let alone = (0..GROUP).filter(|lane| alone >> lane & 1 == 1);
                rest.extend(alone.map(|lane| first + usize::from(self.numbers[group][lane])));
            }
        }
    }
}

/// Each of sixteen bits as a truth value.
#[inline(always)]
fn truths(bits: u32) -> [bool; GROUP] {
    let mut truths = [false; GROUP];
    for (half, truths) in truths.chunks_exact_mut(8).enumerate() {
        // The bits eight times, a byte each; of each byte the bit of its number; and that moved to the lowest place.
        let copies = u64::from(bits >> (8 * half) & 0xff) * 0x0101_0101_0101_0101;
        let single = copies & 0x8040_2010_0804_0201;
        let lowest = (single + 0x7f7f_7f7f_7f7f_7f7f) >> 7 & 0x0101_0101_0101_0101;
        for (truth, byte) in truths.iter_mut().zip(lowest.to_le_bytes()) {
            *truth = byte != 0;
        }
    }
    truths
}

/// From this share of a ray's length on a hit may lie beyond its end.
const NEARLY: f32 = 1.0 - 1.0 / 512.0;
