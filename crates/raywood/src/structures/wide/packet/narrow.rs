//! Making wide groups narrow: the few rays that keep a group apart are traced alone.
//!
//! Where a picture shows the edge of something, a packet's rays to a light come in bunches, and sorting leaves a group that has rays of two. It meets
//! all that lies between them: on its own it takes more work than all others together.

use super::kind::Kind;
use super::sort::WIDE;
use super::{GROUP, Packet};
use crate::simd::{Float, Simd};

/// Wide groups stay as they are until they took more work than this: where little is in the way it does not matter.
const LITTLE_WORK: f32 = 32.0;

/// A group is two bunches if one side of its middle takes up less than this share of its width.
const BUNCH: f32 = 0.2;

impl Packet {
    /// Makes groups narrower that are wide and take much work, if they are two bunches: the larger one stays.
    #[inline(always)]
    pub(super) fn narrow<S: Simd, K: Kind>(&mut self, simd: S) {
        let mut left =
            self.wide & self.groups.live & simd.splat16(LITTLE_WORK).less(simd.load16(&self.work));
        if left == 0 {
            return;
        }
        let [across, along] = self.groups.whole.map(|[low, high]| high - low);
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUP;
            left &= left - 1;

            // Without the rays that have found what they look for it may be narrow already.
            let nearest = simd.load16(&self.nearest[group]);
            let looking = self.members[group] & nearest.less(simd.splat16(f32::INFINITY));
            let bounds = self.bounds_of(simd, group, looking);
            let widths = bounds.map(|[low, high]| high - low);
            let axis = usize::from(widths[0] / across <= widths[1] / along);
            let (kept, bounds) = if widths[0] > WIDE * across || widths[1] > WIDE * along {
                let [low, high] = bounds[axis];
                let middle = simd.splat16(0.5 * (low + high));
                let lower = looking & simd.load16(&self.slopes[axis][group]).less(middle);
                let upper = looking & !lower;
                let more = if lower.count_ones() > upper.count_ones() { lower } else { upper };
                let bunch = self.bounds_of(simd, group, more);
                if bunch[axis][1] - bunch[axis][0] > BUNCH * widths[axis] {
                    self.wide &= !(1 << group);
                    continue;
                }
                (more, bunch)
            } else {
                (looking, bounds)
            };

            let leaving = looking & !kept;
            self.alone[group] |= leaving;
            self.members[group] &= !leaving;
            let nearest = nearest.replaced(leaving, simd.splat16(f32::INFINITY));
            self.nearest[group] = nearest.to_array();
            self.groups.least[group] = nearest.least();
            for (axis, [low, high]) in bounds.into_iter().enumerate() {
                self.groups.slopes[axis][0][group] = low;
                self.groups.slopes[axis][1][group] = high;
            }
            self.work[group] = 0.0;
        }
        self.groups.prepare(simd);
        self.groups.look_again::<S, K>(simd);
        self.wide &= self.scattered(simd);
    }

    /// The least and the greatest slope of some rays of a group, by axis.
    #[inline(always)]
    fn bounds_of<S: Simd>(&self, simd: S, group: usize, rays: u32) -> [[f32; 2]; 2] {
        let (above, below) = (simd.splat16(f32::INFINITY), simd.splat16(f32::NEG_INFINITY));
        let mut bounds = [[0.0; 2]; 2];
        for (bounds, slopes) in bounds.iter_mut().zip(&self.slopes) {
            let slopes = simd.load16(&slopes[group]);
            *bounds =
                [above.replaced(rays, slopes).least(), below.replaced(rays, slopes).greatest()];
        }
        bounds
    }
}
