//! Parallel rays as a packet: the light comes from so far that only its direction is known.
//!
//! Such rays meet in no point, but along them everything is as linear: with coordinates sheared along their direction, a ray is a point `(x, y)` of the
//! plane, whatever its depth, and a triangle seen from there is a triangle of the plane. What is nearest to the light is what has the least depth, and depth is a
//! linear function of `(x, y)`, too. It may be negative, and its error is one of the coordinates' size: bounds are absolute here.

use super::frame::Frame;
use super::gather::NUMBERS;
use super::groups::Groups;
use super::triangles::{Function, GREATEST_VOLUME, LEAST_VOLUME, ROUNDING, TRIANGLES, Triangles};
use super::triangles::{cross, largest, replaced, sub};
use super::{GROUP, NONE, Packet};
use crate::geometry::TriangleBlock;
use crate::simd::{Float, Simd};
use crate::structures::wide::WideBvh;
use crate::structures::wide::source::Source;
use crate::{Ray, Vec3};

/// Rays that start farther away, in any coordinate, do not come with the packet.
const FARTHEST: f32 = 1e15;

/// A sheared coordinate, and a depth from a box's side, are off by no more than so many roundings of the largest coordinate.
const ROUNDINGS: f32 = 16.0;

/// An edge function's error is at most so many roundings of the product of the largest coordinate and the longest edge.
const EDGE_ROUNDINGS: f32 = 256.0;

/// The error of a depth is at most so many roundings of the largest coordinate times the triangle's slant.
const DEPTH_ROUNDINGS: f32 = 256.0;

/// What edge functions and depths may be off by, in the same terms, per displacement of rays and triangles that are rounded from double precision.
const MOVES_PER_DISPLACEMENT: f32 = 32.0;

/// Of triangles more slanted than this against the rays not even the orientation is certain.
const GREATEST_SLANT: f32 = 65536.0;

impl Packet {
    /// As [`gather`](Packet::gather), with rays in one `direction` that never end.
    #[inline(always)]
    pub(super) fn gather_parallel<S: Simd, R: Source>(
        &mut self,
        simd: S,
        rays: &R,
        (origin, direction): (Vec3, Vec3),
        tree: &WideBvh,
    ) {
        // They are looked at from where they go to.
        self.frame = Frame::new(origin, 0.0, -direction);
        let [x_axis, y_axis, z_axis] = self.frame.axes;
        let depth = self.frame.sign * direction[z_axis];
        let is_direction =
            Ray::SHORTEST_DIRECTION <= -depth && -depth < 1.0 / Ray::SHORTEST_DIRECTION;
        let shear = [direction[x_axis] / depth, direction[y_axis] / depth];
        self.frame.shear = shear;

        let (zero, never) = (simd.splat16(0.0), simd.splat16(f32::INFINITY));
        let [shear_x, shear_y] = [simd.splat16(shear[0]), simd.splat16(shear[1])];
        let mut farthest = zero;
        for group in 0..GROUP {
            let wanted = self.waiting.rays[group];
            self.members[group] = 0;
            if wanted == 0 {
                continue;
            }
            let [ox, oy, oz, start, dx, dy, dz, end] = rays.columns(simd, group * GROUP);
            let (from, d) = ([ox, oy, oz], [dx, dy, dz]);
            let from = |axis: usize| from[axis] - simd.splat16(origin[axis]);
            let z = from(z_axis) * simd.splat16(self.frame.sign);
            let (x, y) = (from(x_axis) - shear_x * z, from(y_axis) - shear_y * z);
            let size = largest([x, y, z]);
            let same = |axis: usize| {
                let all = simd.splat16(direction[axis]);
                d[axis].less_or_equal(all) & all.less_or_equal(d[axis])
            };
            let members = if is_direction {
                wanted
                    & same(0)
                    & same(1)
                    & same(2)
                    & never.less_or_equal(end)
                    & start.less_or_equal(zero)
                    & zero.less_or_equal(start)
                    & x.abs().less(simd.splat16(FARTHEST))
                    & y.abs().less(simd.splat16(FARTHEST))
                    & z.abs().less(simd.splat16(FARTHEST))
            } else {
                0
            };
            self.members[group] = members;
            farthest = farthest.larger(zero.replaced(members, size));
            self.slopes[0][group] = zero.replaced(members, x).to_array();
            self.slopes[1][group] = zero.replaced(members, y).to_array();
            self.nearest[group] = never.replaced(members, zero - z).to_array();
            self.scales[group] = [0.0; GROUP];
            self.primitives[group] = [f32::from_bits(NONE); GROUP];
        }
        self.frame.farthest = farthest.greatest();
        // The root's boxes are as far from the packet's as both are from zero.
        let reach = tree.reach + origin.abs().max_element() + self.frame.farthest;
        self.frame.offset = ROUNDINGS * ROUNDING * reach;
        // Shear at most doubles coordinates.
        let from_center = (origin - tree.parts.center).abs().max_element();
        let distance = from_center + 2.0 * self.frame.farthest;
        self.frame.widen_for_parts(&tree.parts, distance);
        self.frame.widen_for_rounding(rays);
        self.frame.displacement = rays.displacement();
        self.is_bounded = false;
        self.start = f32::INFINITY;
        self.numbers = NUMBERS;
    }
}

impl Groups {
    /// The groups that may meet a box: as [`meeting`](Groups::meeting).
    #[inline(always)]
    pub(super) fn meeting_parallel<S: Simd>(
        &self,
        simd: S,
        frame: &Frame,
        low: [f32; 3],
        high: [f32; 3],
    ) -> u32 {
        let mut near = simd.splat16(low[2]);
        let mut far = simd.load16(&self.far).smaller(simd.splat16(high[2]));
        for axis in 0..2 {
            let reciprocal = 1.0 / frame.shear[axis];
            let [least, most] = &self.slopes[axis];
            let factor = simd.splat16(reciprocal);
            let from_low = (simd.splat16(low[axis]) - simd.load16(most)) * factor;
            let from_high = (simd.splat16(high[axis]) - simd.load16(least)) * factor;
            // NaN, of rays that run along a box's side, bounds nothing.
            if reciprocal > 0.0 {
                (near, far) = (from_low.larger(near), from_high.smaller(far));
            } else {
                (near, far) = (from_high.larger(near), from_low.smaller(far));
            }
        }
        near.less_or_equal(far + simd.splat16(frame.offset + frame.margin)) & self.live
    }

    /// Which of sixteen boxes the packet may meet, and from which depth on: as [`met_by_any`](Groups::met_by_any).
    #[inline(always)]
    pub(super) fn met_by_any_parallel<S: Simd>(
        &self,
        simd: S,
        frame: &Frame,
        [low, high]: &[[S::F16; 3]; 2],
    ) -> (u32, S::F16) {
        let mut near = low[2];
        let mut far = high[2].smaller(simd.splat16(self.farthest(simd)));
        for axis in 0..2 {
            let reciprocal = 1.0 / frame.shear[axis];
            let [least, most] = self.whole[axis];
            let factor = simd.splat16(reciprocal);
            let from_low = (low[axis] - simd.splat16(most)) * factor;
            let from_high = (high[axis] - simd.splat16(least)) * factor;
            if reciprocal > 0.0 {
                (near, far) = (from_low.larger(near), from_high.smaller(far));
            } else {
                (near, far) = (from_high.larger(near), from_low.smaller(far));
            }
        }
        (near.less_or_equal(far + simd.splat16(frame.offset + frame.margin)), near)
    }
}

impl Triangles {
    /// As [`new`](Triangles::new) for parallel rays: the edge functions are divided so that their sum is one, and the last function is the depth's negative.
    #[inline(always)]
    pub(super) fn parallel<S: Simd>(
        simd: S,
        blocks: [&TriangleBlock; 2],
        lanes: u32,
        frame: &Frame,
        groups: &Groups,
    ) -> Self {
        let [a, b, c] = [
            sheared_corners(simd, blocks, 0, frame),
            sheared_corners(simd, blocks, 1, frame),
            sheared_corners(simd, blocks, 2, frame),
        ];
        let zero = simd.splat16(0.0);
        let ((edge_c, ab), (edge_a, bc), (edge_b, ca)) =
            (edge(simd, a, b), edge(simd, b, c), edge(simd, c, a));
        let (first, second, third) = (sub(b, a), sub(c, b), sub(a, c));

        // The plane of the triangle, from its two shorter edges, and twice its area as seen.
        let sizes = [largest(first), largest(second), largest(third)];
        let longest = sizes[0].larger(sizes[1]).larger(sizes[2]);
        let (first_longest, second_longest) =
            (longest.less_or_equal(sizes[0]), longest.less_or_equal(sizes[1]));
        let one = replaced(replaced(first, first_longest, second), second_longest, third);
        let other = replaced(replaced(second, first_longest, third), second_longest, first);
        let normal = cross(one, other);
        let area = normal[2];
        let reciprocal = simd.splat16(1.0) / area;
        let half = reciprocal * simd.splat16(0.5);
        let extent = largest(one) * largest(other);
        let slant = extent * reciprocal.abs();

        // How inexact that is.
        let reach = largest(a).larger(largest(b)).larger(largest(c));
        let reach = reach + simd.splat16(frame.farthest);
        let terms = reach * (longest + extent);
        let reach = reach * simd.splat16(ROUNDING);
        let longest = longer_side(ab).larger(longer_side(bc)).larger(longer_side(ca));
        let moved = simd.splat16(MOVES_PER_DISPLACEMENT * frame.displacement);
        let errors = (reach * simd.splat16(EDGE_ROUNDINGS) + moved) * longest * half.abs();
        let tolerances = (reach * simd.splat16(DEPTH_ROUNDINGS) + moved) * slant;
        let size = area.abs();
        let known = simd.splat16(LEAST_VOLUME).less_or_equal(size)
            & size.less_or_equal(simd.splat16(GREATEST_VOLUME))
            & slant.less_or_equal(simd.splat16(GREATEST_SLANT))
            & (terms + tolerances + errors).less(simd.splat16(GREATEST_VOLUME));

        let constant = zero - normal[0] * a[0] - normal[1] * a[1] - normal[2] * a[2];
        let mut triangles = Self {
            functions: [[[0.0; TRIANGLES]; 3]; 4],
            errors: errors.to_array(),
            certain: errors.to_array(),
            tolerances: tolerances.to_array(),
            sizes: [[[0.0; TRIANGLES]; 2]; 4],
            bounds: [[[0.0; TRIANGLES]; 2]; 2],
            possible: lanes,
            unknown: lanes & !known,
        };
        let outside = errors * simd.splat16(-2.0);
        let farther = tolerances
            .mul_add(simd.splat16(-3.0), simd.splat16(simd.load16(&groups.least).least()));
        triangles.fill(
            simd,
            groups,
            [
                Function { vectors: edge_a, factor: half, least: outside },
                Function { vectors: edge_b, factor: half, least: outside },
                Function { vectors: edge_c, factor: half, least: outside },
                Function {
                    vectors: [normal[0], normal[1], constant],
                    factor: reciprocal,
                    least: farther,
                },
            ],
        );

        // What is seen as a line is asked for ray by ray, so at least it must be where the packet is.
        if triangles.unknown != 0 {
            let offset = simd.splat16(frame.offset);
            let mut apart = 0;
            for axis in 0..2 {
                let low = a[axis].smaller(b[axis]).smaller(c[axis]) - offset;
                let high = a[axis].larger(b[axis]).larger(c[axis]) + offset;
                let [least, most] = groups.whole[axis];
                apart |= simd.splat16(most).less(low) | high.less(simd.splat16(least));
                triangles.bounds[axis] = [low.to_array(), high.to_array()];
            }
            triangles.possible &= !(triangles.unknown & apart);
        }
        triangles
    }

    /// The rays of a group that pass a triangle's bounds: those that may meet what is seen as a line.
    #[inline(always)]
    pub(super) fn passing<S: Simd>(
        &self,
        simd: S,
        lane: usize,
        slopes: &[[[f32; GROUP]; GROUP]; 2],
        group: usize,
    ) -> u32 {
        let mut passing = 0xffff;
        for (bounds, slopes) in self.bounds.iter().zip(slopes) {
            let [low, high] = bounds;
            let slopes = simd.load16(&slopes[group]);
            passing &=
                !(slopes.less(simd.splat16(low[lane])) | simd.splat16(high[lane]).less(slopes));
        }
        passing
    }
}

// Functions, not closures: of what takes or returns vectors the compiler inlines into code for other instructions only what it must.

/// A corner of each triangle in the packet's frame, sheared.
#[inline(always)]
fn sheared_corners<S: Simd>(
    simd: S,
    blocks: [&TriangleBlock; 2],
    number: usize,
    frame: &Frame,
) -> [S::F16; 3] {
    let [x, y, z] = frame.corners(simd, blocks, number);
    let [shear_x, shear_y] = frame.shear;
    [x - simd.splat16(shear_x) * z, y - simd.splat16(shear_y) * z, z]
}

/// The function of each edge, the cross product of its ends' sum and difference, both seen as points of the plane at depth one; and the edge as it is seen.
#[inline(always)]
fn edge<S: Simd>(simd: S, from: [S::F16; 3], to: [S::F16; 3]) -> ([S::F16; 3], [S::F16; 2]) {
    let (zero, two) = (simd.splat16(0.0), simd.splat16(2.0));
    let along = [to[0] - from[0], to[1] - from[1]];
    let constant = (from[0] + to[0]) * along[1] - (from[1] + to[1]) * along[0];
    ([zero - two * along[1], two * along[0], constant], along)
}

/// The longer side of the box around each edge.
#[inline(always)]
fn longer_side<F: Float>(along: [F; 2]) -> F {
    along[0].abs().larger(along[1].abs())
}
