//! Large packets: up to 256 rays whose lines meet in one point, or that are parallel, together through the wide tree.
//!
//! Seen from their common point, rays are points of a plane, and everything about them is linear. Sixteen groups of sixteen rays go down the tree
//! together; a child is entered by the groups whose pyramids meet its box. What is found of a triangle once serves all rays: Wald, Slusallek, Benthin and
//! Wagner, "Interactive Rendering with Coherent Ray Tracing", CGF 2001; Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH
//! 2005; Fuetterling, Lojewski, Pfreundt and Ebert, "Efficient Ray Tracing Kernels for Modern CPU Architectures", JCGT 2015.

mod balls;
mod finish;
mod frame;
mod gather;
mod groups;
mod hits;
mod image;
mod kind;
mod leaving;
mod meeting;
mod narrow;
mod pairs;
mod parallel;
mod sort;
#[cfg(test)]
mod tests;
mod triangles;
mod waiting;
mod work;

use super::WideBvh;
use super::node::{Reference, WIDTH};
use super::sink::Sink;
use super::source::{Common, Source};
use super::step;
use crate::geometry::LANES;
use crate::simd::{Float, Simd};
use crate::{Geometry, HitColumns};
use frame::Frame;
use groups::Groups;
use kind::{Blocked, BlockedParallel, Closest, Kind, Reflected};
use triangles::{TRIANGLES, Triangles};
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
    /// The groups that take up much of the packet's width even so.
    wide: u32,
    /// The rays of the slice that no packet has taken.
    waiting: Waiting,
    /// Whether there was another packet of the same slice before.
    is_later: bool,
    /// Which ray of the slice each one is.
    numbers: [[u8; GROUP]; GROUP],
    /// How much [work] each group was, and how much it may be, as much for each ray.
    work: [f32; GROUP],
    most_work: [f32; GROUP],
    most_work_per_ray: f32,
    /// Whether half of the rays of the last packet or more were given up.
    gave_up: bool,
    /// The rays of each group that must be traced alone after all.
    alone: [u32; GROUP],
    /// The rays of each group that are in the packet.
    members: [u32; GROUP],
    /// Triangles of two leaves with groups that may hit them, from place 1 on; each as 16 times the triangle's lane and the group.
    pairs: [u32; 1 + (TRIANGLES + 1) * GROUP],
}

/// Depths with a larger relative error are not trusted: the triangle test of single rays decides.
const TOLERANCE: f32 = 1.0 / 4096.0;

/// The same where depths need not be known, only whether they are less than another one.
const LARGE_TOLERANCE: f32 = 1.0 / 64.0;

/// By which share of itself one over the depth at which a ray starts or ends may be off.
const LIMIT_ERROR: f32 = 1.0 / (1 << 20) as f32;

/// Sixteen bits.
const ALL: u32 = 0xffff;

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
pub(super) struct Piece<'a, R> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
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
pub(super) fn closest<S: Simd, R: Source, H: Sink, const FAST: bool>(
    simd: S,
    piece: &Piece<'_, R>,
    hits: &mut H,
    scratch: &mut Scratch,
    rest: &mut Vec<usize>,
) {
    let Scratch { packet, stack } = scratch;
    packet.begin(piece.rays.len());
    while let Some(common) = packet.gather::<S, R, false>(simd, &piece.rays, piece.tree) {
        // While the packet is under way, the place for its hits arrives.
        hits.prefetch(simd);
        match common {
            Common::Image => {
                packet.trace::<S, R, Reflected, FAST>(simd, piece, stack);
                packet.finish::<S, R, H, Reflected>(simd, &piece.rays, hits, rest, piece.first);
            }
            _ => {
                packet.trace::<S, R, Closest, FAST>(simd, piece, stack);
                packet.finish::<S, R, H, Closest>(simd, &piece.rays, hits, rest, piece.first);
            }
        }
        packet.is_later = true;
    }
    packet.waiting.append_to(rest, piece.first);
}

/// Finds out whether anything blocks rays that share their origin, their end or their direction. Appends the numbers of rays that must be traced otherwise to `rest`.
#[inline(always)]
pub(super) fn any<S: Simd, R: Source, const FAST: bool>(
    simd: S,
    piece: &Piece<'_, R>,
    occluded: &mut [bool],
    scratch: &mut Scratch,
    rest: &mut Vec<usize>,
) {
    let Scratch { packet, stack } = scratch;
    packet.begin(piece.rays.len());
    while let Some(common) = packet.gather::<S, R, true>(simd, &piece.rays, piece.tree) {
        match common {
            Common::Direction => {
                packet.trace::<S, R, BlockedParallel, FAST>(simd, piece, stack);
            }
            _ => packet.trace::<S, R, Blocked, FAST>(simd, piece, stack),
        }
        // With `FAST` answers at silhouettes depend on who finds them, and must not on what came before, which differs with the number of threads.
        if !FAST {
            packet.end_work();
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
            wide: 0,
            waiting: Waiting::first(0),
            is_later: false,
            numbers: [[0; GROUP]; GROUP],
            work: [0.0; GROUP],
            most_work: [0.0; GROUP],
            most_work_per_ray: 0.0,
            gave_up: false,
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
    fn trace<S: Simd, R: Source, K: Kind, const FAST: bool>(
        &mut self,
        simd: S,
        piece: &Piece<'_, R>,
        stack: &mut [Item],
    ) {
        if piece.tree.root == Reference::NOTHING {
            return;
        }
        self.begin_work();
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
                self.visit_leaves::<S, R, K, FAST>(simd, piece, leaves);
            } else {
                self.count_node(simd, groups);
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
    fn visit_leaves<S: Simd, R: Source, K: Kind, const FAST: bool>(
        &mut self,
        simd: S,
        piece: &Piece<'_, R>,
        leaves: [Leaf; 2],
    ) {
        let [first, second] = leaves;
        let blocks = [piece.tree.block(first.reference), piece.tree.block(second.reference)];
        let mut lanes = 0;
        let mut others = 0;
        for (place, leaf) in leaves.iter().enumerate() {
            if leaf.groups != 0 {
                let here = step::others(blocks[place], leaf.reference);
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

        // First all pairs, then one loop over them, so that the processor foresees its end.
        self.count_leaves(simd, triangles.possible, first.groups | second.groups);
        let count = self.pair_up::<S, R, K>(simd, &triangles, leaves);
        let mut touched = 0;
        for place in 1..=count {
            let pair = self.pairs[place] as usize;
            let (lane, group) = (pair / GROUP % TRIANGLES, pair % GROUP);
            let primitive = f32::from_bits(blocks[lane / LANES].primitives[lane % LANES]);
            let (hit, doubtful) =
                self.test::<S, R, K, FAST>(simd, &triangles, lane, group, primitive);
            touched |= u32::from(hit | doubtful != 0) << group;
            if doubtful != 0 {
                let leaf = leaves[lane / LANES].reference;
                self.settle::<R, K>(piece, leaf, lane % LANES, group, doubtful);
            }
        }
        let mut left = if FAST { others } else { others | triangles.possible & triangles.unknown };
        while left != 0 {
            let lane = left.trailing_zeros() as usize % TRIANGLES;
            left &= left - 1;
            let Leaf { reference, groups } = leaves[lane / LANES];
            let is_other = others >> lane & 1 == 1;
            let ball = self.ball(blocks[lane / LANES], lane % LANES);
            for group in (0..GROUP).filter(|group| groups >> group & 1 == 1) {
                let mut members = self.members[group];
                if is_other && !K::PARALLEL {
                    members &= self.meeting_ball(simd, &ball, group);
                } else if !is_other && K::PARALLEL {
                    members &= triangles.passing(simd, lane, &self.slopes, group);
                }
                if members != 0 {
                    touched |= 1 << group;
                    self.settle::<R, K>(piece, reference, lane % LANES, group, members);
                }
            }
        }

        // How far the groups still have to look.
        let mut left = touched;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUP;
            left &= left - 1;
            let nearest = simd.load16(&self.nearest[group]);
            self.groups.least[group] = nearest.least();
            if K::ANY {
                let left = nearest.less(simd.splat16(f32::INFINITY));
                self.most_work[group] = self.most_work_of(left.count_ones());
            }
        }
        self.groups.look_again::<S, K>(simd);

        self.narrow::<S, K>(simd);
        self.give_up(simd);
    }
}
