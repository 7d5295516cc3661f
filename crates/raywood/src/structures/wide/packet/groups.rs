//! The groups of a packet: sixteen times sixteen rays, each group in a rectangle of slopes.

use super::frame::Frame;
use super::kind::Kind;
use crate::simd::{Float, Simd};

/// By how much of itself the far end of an interval of depths is lengthened at least, against rounding: every depth is off by five roundings at most.
pub(super) const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// The relative error of halves of sums and differences, with room to spare.
const HALVING_ERROR: f32 = 2.0 * f32::EPSILON;

/// What the rays of each group have in common, a group a lane.
///
/// The rays of a group lie in an axis-aligned pyramid. For which depths it overlaps a box is a matter of four products: of each side of the box with
/// the reciprocal of the slope that reaches it first, or leaves it last. That is exact, where testing against planes would only be conservative.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Groups {
    /// The least and the greatest slope, by axis.
    pub(super) slopes: [[[f32; 16]; 2]; 2],
    /// Their reciprocals.
    reciprocals: [[[f32; 16]; 2]; 2],
    /// Halfway between the slopes, and no less than how far these are from there, by axis.
    pub(super) centers: [[f32; 16]; 2],
    /// See `centers`.
    pub(super) extents: [[f32; 16]; 2],
    /// The least of one over the depth of what the rays have found, or of their ends.
    pub(super) least: [f32; 16],
    /// The depth beyond which nothing counts for any ray of the group.
    pub(super) far: [f32; 16],
    /// The depth before which nothing counts.
    from: [f32; 16],
    /// The same for the packet as a whole.
    whole_from: f32,
    /// Where reciprocals are positive.
    positive: [[u32; 2]; 2],
    /// The same for the packet as a whole: slopes, their reciprocals, the farthest depth that counts.
    pub(super) whole: [[f32; 2]; 2],
    whole_reciprocals: [[f32; 2]; 2],
    pub(super) whole_center: [f32; 2],
    pub(super) whole_extent: [f32; 2],
    /// By how much of themselves the far ends of intervals of depths are lengthened.
    pub(super) slack: f32,
    /// The groups that have rays for which anything still counts.
    pub(super) live: u32,
}

impl Groups {
    /// No groups.
    pub(super) const NONE: Self = Self {
        slopes: [[[f32::INFINITY; 16], [f32::NEG_INFINITY; 16]]; 2],
        reciprocals: [[[0.0; 16]; 2]; 2],
        centers: [[0.0; 16]; 2],
        extents: [[0.0; 16]; 2],
        least: [f32::INFINITY; 16],
        far: [0.0; 16],
        from: [0.0; 16],
        whole_from: 0.0,
        positive: [[0; 2]; 2],
        whole: [[f32::INFINITY, f32::NEG_INFINITY]; 2],
        whole_reciprocals: [[0.0; 2]; 2],
        whole_center: [0.0; 2],
        whole_extent: [0.0; 2],
        slack: SLACK,
        live: 0,
    };

    /// No groups yet, of a packet with such a slack.
    #[inline(always)]
    pub(super) fn with_slack(slack: f32) -> Self {
        Self { slack, ..Self::NONE }
    }

    /// Computes what follows from the groups' slopes.
    #[inline(always)]
    pub(super) fn prepare<S: Simd>(&mut self, simd: S) {
        let (zero, one) = (simd.splat16(0.0), simd.splat16(1.0));
        for axis in 0..2 {
            for side in 0..2 {
                let slopes = simd.load16(&self.slopes[axis][side]);
                let reciprocals = one / slopes;
                self.reciprocals[axis][side] = reciprocals.to_array();
                self.positive[axis][side] = zero.less(reciprocals);
                let whole = if side == 0 { slopes.least() } else { slopes.greatest() };
                self.whole[axis][side] = whole;
                self.whole_reciprocals[axis][side] = 1.0 / whole;
            }
            let [low, high] = &self.slopes[axis];
            let (low, high) = (simd.load16(low), simd.load16(high));
            let half = simd.splat16(0.5);
            let center = (low + high) * half;
            let extent = (high - low).mul_add(half, center.abs() * simd.splat16(HALVING_ERROR));
            self.centers[axis] = center.to_array();
            self.extents[axis] = (extent * simd.splat16(1.0 + HALVING_ERROR)).to_array();
            let [low, high] = self.whole[axis];
            let center = 0.5 * (low + high);
            self.whole_center[axis] = center;
            self.whole_extent[axis] =
                (0.5 * (high - low) + center.abs() * HALVING_ERROR) * (1.0 + HALVING_ERROR);
        }
    }

    /// Looks how far the groups still have to look.
    #[inline(always)]
    pub(super) fn look_again<S: Simd, K: Kind>(&mut self, simd: S) {
        let least = simd.load16(&self.least);
        let far = if K::PARALLEL { simd.splat16(0.0) - least } else { simd.splat16(1.0) / least };
        self.far = far.to_array();
        self.live &= least.less(simd.splat16(f32::INFINITY));
    }

    /// Takes the depths at which the groups' rays start.
    #[inline(always)]
    pub(super) fn begin_at<S: Simd>(&mut self, simd: S, depths: S::F16) {
        let from = depths * simd.splat16(1.0 - self.slack);
        self.from = from.to_array();
        self.whole_from = from.least();
    }

    /// The groups that may meet a box, given by its smallest and largest coordinates in the packet's frame.
    #[inline(always)]
    pub(super) fn meeting<S: Simd>(&self, simd: S, low: [f32; 3], high: [f32; 3]) -> u32 {
        let mut near = simd.load16(&self.from).larger(simd.splat16(low[2]));
        let mut far = simd.load16(&self.far).smaller(simd.splat16(high[2]));
        for axis in 0..2 {
            // The group lies beyond the low side where its greatest slope has reached it, and before the high side until its least slope has.
            for (plane, side) in [(low[axis], 1), (high[axis], 0)] {
                let depth = simd.splat16(plane) * simd.load16(&self.reciprocals[axis][side]);
                let positive = self.positive[axis][side];
                let begins = if side == 1 { positive } else { !positive };
                // NaN, of a box's side at zero and a slope of zero, bounds nothing.
                near = near.replaced(begins, depth.larger(near));
                far = far.replaced(!begins, depth.smaller(far));
            }
        }
        near.less_or_equal(far * simd.splat16(1.0 + self.slack)) & self.live
    }

    /// Which of sixteen boxes, given by their smallest and largest coordinates in the packet's frame, the packet may meet, and from which depth on.
    #[inline(always)]
    pub(super) fn met_by_any<S: Simd>(
        &self,
        simd: S,
        [low, high]: &[[S::F16; 3]; 2],
    ) -> (u32, S::F16) {
        let mut near = low[2].larger(simd.splat16(self.whole_from));
        let mut far = high[2].smaller(simd.splat16(self.farthest(simd)));
        for axis in 0..2 {
            for (planes, side) in [(low[axis], 1), (high[axis], 0)] {
                let reciprocal = self.whole_reciprocals[axis][side];
                let depth = planes * simd.splat16(reciprocal);
                // The same for all boxes of a packet, so the branch is foreseen.
                if (reciprocal > 0.0) == (side == 1) {
                    near = depth.larger(near);
                } else {
                    far = depth.smaller(far);
                }
            }
        }
        (near.less_or_equal(far * simd.splat16(1.0 + self.slack)), near)
    }

    /// The groups for which depths from `near` on still count.
    #[inline(always)]
    pub(super) fn reaching<S: Simd, K: Kind>(&self, simd: S, frame: &Frame, near: f32) -> u32 {
        let far = simd.load16(&self.far);
        let far = match K::PARALLEL {
            true => far + simd.splat16(frame.offset + frame.margin),
            false => far * simd.splat16(1.0 + self.slack),
        };
        simd.splat16(near).less_or_equal(far) & self.live
    }

    /// The depth beyond which nothing counts for any ray.
    #[inline(always)]
    pub(super) fn farthest<S: Simd>(&self, simd: S) -> f32 {
        simd.load16(&self.far).greatest()
    }
}
