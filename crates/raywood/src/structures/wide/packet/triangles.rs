//! The triangles of two leaves as a packet sees them: everything that does not depend on the single ray.
//!
//! For rays through one point an edge function is linear in the ray's slopes, and so is one over the depth of the hit. So the work on a triangle is
//! done once, for sixteen triangles at a time, and what is left for a ray are four linear functions.

use super::frame::Frame;
use super::groups::Groups;
use super::hits::CLOSE;
use super::kind::Kind;
use crate::geometry::{LANES, TriangleBlock};
use crate::simd::{Float, Simd};
use crate::structures::wide::source::Source;

/// How many triangles are looked at together.
pub(super) const TRIANGLES: usize = 2 * LANES;

/// One rounding.
pub(super) const ROUNDING: f32 = f32::EPSILON / 2.0;

/// An edge function's error is at most so many roundings of the product of the largest coordinate, the longest edge and the steepest slope.
const EDGE_ROUNDINGS: f32 = 40.0;

/// The relative error of a depth is at most so many roundings of the same product over the triangle's distance from the origin's.
const DEPTH_ROUNDINGS: f32 = 16.0;

/// A corner's weight may be off by so much in the worst case; in slivers that cannot be promised, and the triangle test of single rays decides.
const WEIGHT_TOLERANCE: f32 = 1.0 / 64.0;

/// What is outside of this range may have lost digits to underflow or come too near to overflow.
pub(super) const LEAST_VOLUME: f32 = 1e-30;
/// See [`LEAST_VOLUME`].
pub(super) const GREATEST_VOLUME: f32 = 1e30;

/// Four linear functions of a ray's slopes for each of sixteen triangles: the edge functions opposite to each corner, divided so that their sum
/// is one over the depth, and one over the depth. For parallel rays see [`parallel`](Triangles::parallel).
#[repr(C, align(64))]
pub(super) struct Triangles {
    /// For each function its factors for both slopes, and its constant.
    pub(super) functions: [[[f32; TRIANGLES]; 3]; 4],
    /// The error of the edge functions.
    pub(super) errors: [f32; TRIANGLES],
    /// Where all edge functions are larger than this, the ray certainly hits, and its depth is known well; infinite where it never is.
    pub(super) certain: [f32; TRIANGLES],
    /// The relative error of one over the depth; of parallel rays the error of the depth.
    pub(super) tolerances: [f32; TRIANGLES],
    /// The factors without sign.
    pub(super) sizes: [[[f32; TRIANGLES]; 2]; 4],
    /// Of parallel rays: the bounds of triangles of which nothing else is known, by axis.
    pub(super) bounds: [[[f32; TRIANGLES]; 2]; 2],
    /// The triangles that some ray may hit.
    pub(super) possible: u32,
    /// Those among them of which not even the orientation is known.
    pub(super) unknown: u32,
}

/// A vector in space for each of sixteen triangles.
pub(super) type Vectors<F> = [F; 3];

/// A linear function of a ray's slopes for each of sixteen triangles.
pub(super) struct Function<F> {
    /// What both slopes and one are multiplied by, but for the factor.
    pub(super) vectors: Vectors<F>,
    pub(super) factor: F,
    /// No ray with less hits the triangle.
    pub(super) least: F,
}

#[inline(always)]
pub(super) fn cross<F: Float>(a: Vectors<F>, b: Vectors<F>) -> Vectors<F> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
pub(super) fn sub<F: Float>(a: Vectors<F>, b: Vectors<F>) -> Vectors<F> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn add<F: Float>(a: Vectors<F>, b: Vectors<F>) -> Vectors<F> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn replaced<F: Float>(a: Vectors<F>, lanes: u32, b: Vectors<F>) -> Vectors<F> {
    [a[0].replaced(lanes, b[0]), a[1].replaced(lanes, b[1]), a[2].replaced(lanes, b[2])]
}

#[inline(always)]
pub(super) fn largest<F: Float>(a: Vectors<F>) -> F {
    a[0].abs().larger(a[1].abs()).larger(a[2].abs())
}

impl Triangles {
    /// Prepares the triangles in the given lanes of two blocks. If a depth may have a larger relative error than `tolerance`, no hit is
    /// [certain](Self::certain).
    #[inline(always)]
    pub(super) fn new<S: Simd>(
        simd: S,
        blocks: [&TriangleBlock; 2],
        lanes: u32,
        frame: &Frame,
        groups: &Groups,
        tolerance: f32,
    ) -> Self {
        // The corners in the packet's frame.
        let a = frame.corners(simd, blocks, 0);
        let b = frame.corners(simd, blocks, 1);
        let c = frame.corners(simd, blocks, 2);

        // Normals of the planes through the origin and each edge. Sum and difference are the same for the neighbour at the edge, but for
        // the sign, so both find the same number.
        let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));
        let edges = [cross(add(b, c), bc), cross(add(c, a), ca), cross(add(a, b), ab)];

        // The plane of the triangle, from its two shorter edges; six times the volume that it spans with the origin.
        let (first, second, third) = (largest(ab), largest(bc), largest(ca));
        let longest = first.larger(second).larger(third);
        let (first_longest, second_longest) =
            (longest.less_or_equal(first), longest.less_or_equal(second));
        let one = replaced(replaced(ab, first_longest, bc), second_longest, ca);
        let other = replaced(replaced(bc, first_longest, ca), second_longest, ab);
        let normal = cross(one, other);
        let volume = normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2];
        let reciprocal = simd.splat16(1.0) / volume;
        let half = reciprocal * simd.splat16(0.5);

        // How inexact that is.
        let reach = largest(a).larger(largest(b)).larger(largest(c));
        let steepest = 1.0 + steepness(&groups.whole[0]) + steepness(&groups.whole[1]);
        let edge_roundings = reach * simd.splat16(EDGE_ROUNDINGS * ROUNDING * steepest)
            + simd.splat16(2.0 * frame.offset * (1.0 + steepest));
        let errors = edge_roundings * longest * half.abs();
        let depth_roundings = reach * simd.splat16(DEPTH_ROUNDINGS * ROUNDING * steepest)
            + simd.splat16(4.0 * frame.offset * steepest);
        let tolerances = depth_roundings * (largest(one) * largest(other)) * reciprocal.abs();
        let size = volume.abs();
        let known = simd.splat16(LEAST_VOLUME).less_or_equal(size)
            & size.less_or_equal(simd.splat16(GREATEST_VOLUME))
            & tolerances.less_or_equal(simd.splat16(0.25));
        let exact = known
            & tolerances.less_or_equal(simd.splat16(tolerance))
            & (errors * reach).less_or_equal(simd.splat16(WEIGHT_TOLERANCE));
        let never = simd.splat16(f32::INFINITY);

        // The functions, and whether any ray of the packet may be inside of all edges and meet the triangle in time.
        let mut triangles = Self {
            functions: [[[0.0; TRIANGLES]; 3]; 4],
            errors: errors.to_array(),
            certain: never.replaced(exact, errors).to_array(),
            tolerances: tolerances.to_array(),
            sizes: [[[0.0; TRIANGLES]; 2]; 4],
            bounds: [[[0.0; TRIANGLES]; 2]; 2],
            possible: lanes,
            unknown: lanes & !known,
        };
        let zero = simd.splat16(0.0);
        let [edge_a, edge_b, edge_c] = edges;
        let error = errors * simd.splat16(-2.0);
        triangles.fill(
            simd,
            groups,
            [
                Function { vectors: edge_a, factor: half, least: error },
                Function { vectors: edge_b, factor: half, least: error },
                Function { vectors: edge_c, factor: half, least: error },
                Function { vectors: normal, factor: reciprocal, least: zero },
            ],
        );
        triangles
    }

    /// Takes the four functions, and leaves out triangles where no ray of the packet can reach what one of them must have.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        simd: S,
        groups: &Groups,
        functions: [Function<S::F16>; 4],
    ) {
        for (number, Function { vectors, factor, least }) in functions.into_iter().enumerate() {
            let mut greatest = vectors[2] * factor;
            self.functions[number][2] = greatest.to_array();
            for axis in [1, 0] {
                let factors = vectors[axis] * factor;
                let sizes = factors.abs();
                self.functions[number][axis] = factors.to_array();
                self.sizes[number][axis] = sizes.to_array();
                greatest = factors.mul_add(simd.splat16(groups.whole_center[axis]), greatest);
                greatest = sizes.mul_add(simd.splat16(groups.whole_extent[axis]), greatest);
            }
            self.possible &= !greatest.less(least) | self.unknown;
        }
    }

    /// The groups that may hit a triangle nearer than what they have.
    ///
    /// The greatest values are off by less than half the error of an edge function, and by less than the tolerance of a depth.
    #[inline(always)]
    pub(super) fn groups<S: Simd, R: Source, K: Kind>(
        &self,
        simd: S,
        lane: usize,
        groups: &Groups,
    ) -> u32 {
        let close = if R::IS_ROUNDED { CLOSE } else { 0.0 };
        let least = self.greatest(simd, 0, lane, groups);
        let least = self.greatest(simd, 1, lane, groups).smaller(least);
        let least = self.greatest(simd, 2, lane, groups).smaller(least);
        let nearer = self.greatest(simd, 3, lane, groups);
        let nearer = match K::PARALLEL {
            true => nearer + simd.splat16(3.0 * self.tolerances[lane]),
            false => nearer * simd.splat16(3.0f32.mul_add(self.tolerances[lane], 1.0 + close)),
        };
        let error = simd.splat16(-2.0 * self.errors[lane]);
        error.less_or_equal(least) & simd.load16(&groups.least).less(nearer)
    }

    /// The triangles that a group may hit nearer than what it has: for sixteen of them what [`groups`](Self::groups) tells of one.
    #[inline(always)]
    pub(super) fn met_by<S: Simd, R: Source, K: Kind>(
        &self,
        simd: S,
        group: usize,
        groups: &Groups,
    ) -> u32 {
        let close = if R::IS_ROUNDED { CLOSE } else { 0.0 };
        let least = self.greatest_in(simd, 0, group, groups);
        let least = self.greatest_in(simd, 1, group, groups).smaller(least);
        let least = self.greatest_in(simd, 2, group, groups).smaller(least);
        let nearer = self.greatest_in(simd, 3, group, groups);
        let (three, tolerances) = (simd.splat16(3.0), simd.load16(&self.tolerances));
        let nearer = match K::PARALLEL {
            true => three.mul_add(tolerances, nearer),
            false => nearer * three.mul_add(tolerances, simd.splat16(1.0 + close)),
        };
        let error = simd.load16(&self.errors) * simd.splat16(-2.0);
        error.less_or_equal(least) & simd.splat16(groups.least[group]).less(nearer)
    }

    /// A function of a triangle for sixteen rays of the given slopes.
    #[inline(always)]
    pub(super) fn function<S: Simd>(
        &self,
        simd: S,
        number: usize,
        lane: usize,
        x: S::F16,
        y: S::F16,
    ) -> S::F16 {
        let [for_x, for_y, constant] = &self.functions[number];
        let part = simd.splat16(for_y[lane]).mul_add(y, simd.splat16(constant[lane]));
        simd.splat16(for_x[lane]).mul_add(x, part)
    }

    /// The greatest value that a function of a triangle has in each group, up to rounding.
    #[inline(always)]
    fn greatest<S: Simd>(&self, simd: S, number: usize, lane: usize, groups: &Groups) -> S::F16 {
        let [for_x, for_y, constant] = &self.functions[number];
        let [size_x, size_y] = &self.sizes[number];
        let [x, y] = &groups.centers;
        let [reach_x, reach_y] = &groups.extents;
        let greatest = simd.splat16(constant[lane]);
        let greatest = simd.splat16(for_y[lane]).mul_add(simd.load16(y), greatest);
        let greatest = simd.splat16(for_x[lane]).mul_add(simd.load16(x), greatest);
        let greatest = simd.splat16(size_y[lane]).mul_add(simd.load16(reach_y), greatest);
        simd.splat16(size_x[lane]).mul_add(simd.load16(reach_x), greatest)
    }

    /// The greatest value that a function of each triangle has in a group, up to rounding.
    #[inline(always)]
    fn greatest_in<S: Simd>(
        &self,
        simd: S,
        number: usize,
        group: usize,
        groups: &Groups,
    ) -> S::F16 {
        let [for_x, for_y, constant] = &self.functions[number];
        let [size_x, size_y] = &self.sizes[number];
        let [x, y] = &groups.centers;
        let [reach_x, reach_y] = &groups.extents;
        let greatest = simd.load16(constant);
        let greatest = simd.load16(for_y).mul_add(simd.splat16(y[group]), greatest);
        let greatest = simd.load16(for_x).mul_add(simd.splat16(x[group]), greatest);
        let greatest = simd.load16(size_y).mul_add(simd.splat16(reach_y[group]), greatest);
        simd.load16(size_x).mul_add(simd.splat16(reach_x[group]), greatest)
    }
}

/// The larger of two slopes, without sign.
#[inline(always)]
fn steepness(slopes: &[f32; 2]) -> f32 {
    slopes[0].abs().max(slopes[1].abs())
}
