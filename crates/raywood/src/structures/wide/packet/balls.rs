//! Balls around primitives that are no triangles, against sixteen rays at a time: see [`balls`](super::super::balls).

use super::Packet;
use crate::geometry::TriangleBlock;
use crate::simd::{Float, Simd};
use crate::structures::wide::balls::{LEAST_SQUARE, ROUNDINGS};

/// A ball as a packet sees it.
pub(super) struct Ball {
    /// Its centre in the packet's frame.
    center: [f32; 3],
    /// Its radius, larger by what rays are known to.
    reach: f32,
}

/// By how much of itself a depth is shortened before it is compared.
const DEPTH_SLACK: f32 = 1.0 / 4096.0;

impl Packet {
    /// The ball around the primitive in a lane of a block that is no triangle. For packets that are not parallel.
    #[inline(always)]
    pub(super) fn ball(&self, block: &TriangleBlock, lane: usize) -> Ball {
        let (center, radius) = block.ball(lane);
        let [x_axis, y_axis, z_axis] = self.frame.axes;
        let [x, y, z] = self.frame.origin;
        let center =
            [center[x_axis] - x, center[y_axis] - y, (center[z_axis] - z) * self.frame.sign];
        let distance = center[0].abs() + center[1].abs() + center[2].abs();
        let reach = radius + 2.0 * self.frame.offset + distance * (ROUNDINGS * f32::EPSILON);
        Ball { center, reach }
    }

    /// Which rays of a group may meet a ball nearer than what they have found.
    #[inline(always)]
    pub(super) fn meeting_ball<S: Simd>(&self, simd: S, ball: &Ball, group: usize) -> u32 {
        let &Ball { center: [x, y, z], reach } = ball;
        let slope_x = simd.load16(&self.slopes[0][group]);
        let slope_y = simd.load16(&self.slopes[1][group]);
        let nearest = simd.load16(&self.nearest[group]);
        let (x, y, z) = (simd.splat16(x), simd.splat16(y), simd.splat16(z));
        let (one, reach) = (simd.splat16(1.0), simd.splat16(reach));

        // From the point of the line that is closest to the centre.
        let squared_length = slope_x * slope_x + slope_y * slope_y + one;
        let depth = (x * slope_x + y * slope_y + z) / squared_length;
        let (by_x, by_y, by_z) = (x - depth * slope_x, y - depth * slope_y, z - depth);
        let squared = by_x * by_x + by_y * by_y + by_z * by_z;
        let passed = (reach * reach + simd.splat16(LEAST_SQUARE)).less(squared);
        let begins = (z - reach) * simd.splat16(1.0 - DEPTH_SLACK);
        let beyond = one.less(begins * nearest);
        !(passed | beyond) & 0xffff
    }
}
