//! What a packet's rays hit: triangles against sixteen rays at a time, and what that leaves open against single ones.

use super::kind::Kind;
use super::leaving::{Leaving, Plane};
use super::triangles::{GREATEST_VOLUME, Triangles};
use super::{ALL, GROUP, LIMIT_ERROR, NONE, Packet, Piece, TOLERANCE};
use crate::simd::{Float, Simd, dispatch_on};
use crate::structures::wide::node::Reference;
use crate::structures::wide::source::Source;
use crate::structures::wide::step;
use crate::traverse::nearest::hit as hit_one;
use crate::{PreparedRay, PrimitiveHit};

/// What an edge function's error hardly ever exceeds, as a share of what it may be.
const LIKELY_ERROR: f32 = 1.0 / 16.0;

/// From so many rays of a group on they are asked together whether they leave a triangle's plane.
const SEVERAL: u32 = 4;

/// By how much of itself a depth, and its share of the start's, may be off but for the tolerance.
const START_ERROR: f32 = 1.0 / (1 << 22) as f32;

/// Hits nearer to a ray's start than this share of its distance from the common point are looked for from the start.
const NEAR: f32 = 1.0 / 512.0;

/// By which share of itself a hit must be nearer than another one for single precision to tell them apart, where rays and triangles are rounded from double: the error of
/// the other one's depth, which is at most [`TOLERANCE`], and half of that to spare.
pub(super) const CLOSE: f32 = 1.5 * TOLERANCE;

impl Packet {
    /// Tests a triangle against the rays of a group and takes what is certainly hit. Returns the rays for which that is not certain.
    #[inline(always)]
    pub(super) fn test<S: Simd, R: Source, K: Kind, const FAST: bool>(
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
            // Limits are lower than in truth by up to twice their error, so that nothing is left out.
            let less =
                if K::PARALLEL { less } else { less * simd.splat16(1.0 - 2.0 * LIMIT_ERROR) };
            let possible = simd.splat16(-error).less_or_equal(least) & nearest.less(more);
            let certain = simd.splat16(certainly).less(least)
                & nearest.less(less)
                & more.less(simd.splat16(self.start));
            let blocked = simd.splat16(f32::INFINITY);
            let hit = possible & certain;
            self.nearest[group] = nearest.replaced(hit, blocked).to_array();
            return (hit, possible & !certain);
        }
        // Which of two is nearer in double precision is asked where they are close to each other.
        let (more, nearer) = if R::IS_ROUNDED {
            let close = depth * simd.splat16(CLOSE);
            (more + close, nearest.less(depth - error_of_depth - close))
        } else {
            (more, ALL)
        };
        let possible = simd.splat16(-error).less_or_equal(least) & nearest.less(more);
        let (late, certainly_late) =
            self.behind_start::<S, K>(simd, depth, triangles.tolerances[lane], group);
        let possible = possible & late;
        let hit = possible & simd.splat16(certainly).less(least) & certainly_late & nearer;
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
        // Lines of rays from a mirror pass by their image: that moves edges by more than rounding does.
        let error = simd.splat16(if K::LATE { error } else { 0.0 });
        let possible = (simd.splat16(0.0) - error).less_or_equal(least) & nearest.less(depth);
        let (late, certainly_late) = self.behind_start::<S, K>(simd, depth, tolerance, group);
        let hit = possible & error.less_or_equal(least) & certainly_late;
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
    pub(super) fn settle<R: Source, K: Kind>(
        &mut self,
        piece: &Piece<'_, R>,
        leaf: Reference,
        lane: usize,
        group: usize,
        doubtful: u32,
    ) {
        let block = piece.tree.block(leaf);
        let is_triangle = !leaf.is_mixed() || block.others() >> lane & 1 == 0;
        let mut doubtful = doubtful;
        if K::ANY && is_triangle {
            doubtful &= !self.starting_beside(&piece.rays, block.primitives[lane], group, doubtful);
            if doubtful == 0 {
                return;
            }
        }
        let plane = ((K::ANY || K::LATE) && is_triangle)
            .then(|| Plane::of(piece.rays.corners(block, lane)));
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
            let leaves = |plane: &Plane| plane.is_left_by::<R>(piece.rays.line(number));
            if plane.as_ref().is_some_and(leaves) {
                continue;
            }
            let hit = if R::IS_ROUNDED {
                let best = self.primitives[group][place].to_bits();
                let best = (!K::ANY && best != NONE).then_some(best);
                let settled = piece.rays.settle(number, block.primitives[lane], best);
                settled.map(|t| PrimitiveHit { t, u: 0.0, v: 0.0 })
            } else {
                let Some(ray) = PreparedRay::new(&piece.rays.ray(number)) else { continue };
                match is_triangle {
                    true => block.intersect_one(&ray, lane),
                    false => hit_one(piece.geometry, &ray, block.primitives[lane]),
                }
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
            } else if R::IS_ROUNDED || depth > *nearest {
                *nearest = depth;
                self.primitives[group][place] = f32::from_bits(block.primitives[lane]);
                self.weights[0][group][place] = hit.u * depth;
                self.weights[1][group][place] = hit.v * depth;
            }
        }
    }

    /// Which of some rays of a group start beside a triangle.
    #[inline(always)]
    fn starting_beside<R: Source>(&self, rays: &R, primitive: u32, group: usize, some: u32) -> u32 {
        let numbers = &self.numbers[group];
        step::lanes(some)
            .filter(|&lane| rays.starts_beside(usize::from(numbers[lane]), primitive))
            .fold(0, |all, lane| all | 1 << lane)
    }
}
