//! The frame of a packet: the rays' common point at zero, the main axis of their directions as depth. There a ray is a point of the plane.

use super::groups::SLACK;
use crate::Vec3;
use crate::build::part_margin::DISTANCE_ERROR;
use crate::geometry::TriangleBlock;
use crate::simd::Simd;
use crate::structures::wide::parts::Parts;
use crate::structures::wide::source::Source;

/// By how much rays count as missing their common point where they and the triangles are displaced, each corner by itself, so that depths are off by less than what
/// follows from that.
const MOVES_PER_DISPLACEMENT: f32 = 4.0;

/// By how much of themselves intervals of depths are lengthened then: more than what two hits must be apart for single precision to tell which is nearer.
const ROUNDED_SLACK: f32 = 1.0 / (1 << 11) as f32;

/// Where a packet's rays start, or end, and along which axis they run.
///
/// A ray's two other coordinates grow in proportion to its depth: its two *slopes* say everything about it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The axes of the slopes, and last that of the depth.
    pub(super) axes: [usize; 3],
    /// -1 if depth grows towards smaller coordinates, else 1.
    pub(super) sign: f32,
    /// The common point, by the axes' order.
    pub(super) origin: [f32; 3],
    /// How far any ray passes by that point at most, along each axis; of parallel rays how far any is off by rounding.
    pub(super) offset: f32,
    /// By how much boxes count as larger beside that: see [`Parts::margin`].
    pub(super) margin: f32,
    /// By how much of themselves the far ends of intervals of depths are lengthened.
    pub(super) slack: f32,
    /// Of parallel rays: how much their other two coordinates grow per depth.
    pub(super) shear: [f32; 2],
    /// And the largest coordinate that any starts at.
    pub(super) farthest: f32,
    /// And how far they and the triangles are [displaced](Source::displacement).
    pub(super) displacement: f32,
}

impl Frame {
    /// The frame for rays through `origin`, or `offset` beside it, roughly along `direction`.
    pub(super) fn new(origin: Vec3, offset: f32, direction: Vec3) -> Self {
        let z = direction.abs().max_axis();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let sign = if direction[z] < 0.0 { -1.0 } else { 1.0 };
        Self {
            axes,
            sign,
            origin: [origin[axes[0]], origin[axes[1]], origin[axes[2]]],
            offset,
            margin: 0.0,
            slack: SLACK,
            shear: [0.0; 2],
            farthest: 0.0,
            displacement: 0.0,
        }
    }

    /// Makes it fit for a tree with parts of triangles, of rays that start up to `distance` from the tree's centre.
    #[inline(always)]
    pub(super) fn widen_for_parts(&mut self, parts: &Parts, distance: f32) {
        if parts.exist() {
            self.margin = parts.margin_at(distance);
            self.slack = DISTANCE_ERROR;
        }
    }

    /// Makes it fit for rays and triangles that are rounded from double precision.
    #[inline(always)]
    pub(super) fn widen_for_rounding<R: Source>(&mut self, rays: &R) {
        if R::IS_ROUNDED {
            self.offset += MOVES_PER_DISPLACEMENT * rays.displacement();
            self.slack = ROUNDED_SLACK;
        }
    }

    /// The smallest and largest coordinates of sixteen boxes, given as planes by axis and side, seen in this frame; larger by what the rays miss the
    /// common point by, and by the margin.
    #[inline(always)]
    pub(super) fn boxes<S: Simd>(&self, simd: S, planes: &[[[f32; 16]; 2]; 3]) -> [[S::F16; 3]; 2] {
        let [first, second, third] = self.axes.map(|axis| &planes[axis]);
        let [x, y, z] = self.origin;
        let offset = self.offset + self.margin;
        let (low_x, high_x) = (simd.splat16(x + offset), simd.splat16(x - offset));
        let (low_y, high_y) = (simd.splat16(y + offset), simd.splat16(y - offset));
        let (z, sign, depth_offset) =
            (simd.splat16(z), simd.splat16(self.sign), simd.splat16(offset));
        let nearer = usize::from(self.sign < 0.0);
        [
            [
                simd.load16(&first[0]) - low_x,
                simd.load16(&second[0]) - low_y,
                (simd.load16(&third[nearer]) - z) * sign - depth_offset,
            ],
            [
                simd.load16(&first[1]) - high_x,
                simd.load16(&second[1]) - high_y,
                (simd.load16(&third[1 - nearer]) - z) * sign + depth_offset,
            ],
        ]
    }

    /// The corners of one number of the triangles of two blocks, seen in this frame.
    #[inline(always)]
    pub(super) fn corners<S: Simd>(
        &self,
        simd: S,
        [first, second]: [&TriangleBlock; 2],
        number: usize,
    ) -> [S::F16; 3] {
        let [x, y, z] = self.axes;
        let x = simd.load_two(first.coordinates(number, x), second.coordinates(number, x));
        let y = simd.load_two(first.coordinates(number, y), second.coordinates(number, y));
        let z = simd.load_two(first.coordinates(number, z), second.coordinates(number, z));
        let origin = self.origin;
        [
            x - simd.splat16(origin[0]),
            y - simd.splat16(origin[1]),
            (z - simd.splat16(origin[2])) * simd.splat16(self.sign),
        ]
    }
}
