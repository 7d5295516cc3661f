//! How much work each group of a packet takes, and when it takes too much.
//!
//! Counted in tests of one triangle against the sixteen rays of a group, about thirty cycles. What is done once for several groups, each has its share of:
//! so work is large where groups go through the tree alone, which is what incoherent rays are.

use super::{GROUP, Packet};
use crate::simd::{Float, Simd};

/// A group is given up when it took more work than this for each of its rays of which not all is known. To trace one alone takes 7 to 13. With half of
/// it groups are given up that would soon have been done.
const MOST_WORK: f32 = 18.0;

/// The same in a packet after one that gave up half of its rays or more: as a rule such a packet is followed by another.
const MOST_WORK_AFTER_SUCH: f32 = 9.0;

/// What a node's boxes are.
const NODE: f32 = 6.0;

/// What the triangles of two leaves are together, and what each one of them is besides that a ray of the packet may hit.
const LEAVES: f32 = 9.0;
/// See [`LEAVES`].
const TRIANGLE: f32 = 0.5;

impl Packet {
    /// Nothing was done yet.
    #[inline(always)]
    pub(super) fn begin_work(&mut self) {
        self.work = [0.0; GROUP];
        self.alone = [0; GROUP];
        self.most_work_per_ray = if self.gave_up { MOST_WORK_AFTER_SUCH } else { MOST_WORK };
        for group in 0..GROUP {
            self.most_work[group] = self.most_work_of(self.members[group].count_ones());
        }
    }

    /// How much work a group may be of which so many rays have not found what they look for.
    #[inline(always)]
    pub(super) fn most_work_of(&self, rays: u32) -> f32 {
        self.most_work_per_ray * rays as f32
    }

    /// All was done that looks for any hits: remembers for the next packet whether half of the rays or more were given up.
    #[inline(always)]
    pub(super) fn end_work(&mut self) {
        let (mut given_up, mut all) = (0, 0);
        for (alone, members) in self.alone.iter().zip(&self.members) {
            given_up += alone.count_ones();
            all += (alone | members).count_ones();
        }
        self.gave_up = 2 * given_up >= all;
    }

    /// Some groups meet a node.
    #[inline(always)]
    pub(super) fn count_node<S: Simd>(&mut self, simd: S, groups: u32) {
        self.count(simd, NODE, groups);
    }

    /// Some groups meet two leaves, of whose triangles the packet may hit so many.
    #[inline(always)]
    pub(super) fn count_leaves<S: Simd>(&mut self, simd: S, triangles: u32, groups: u32) {
        self.count(simd, TRIANGLE.mul_add(triangles.count_ones() as f32, LEAVES), groups);
    }

    #[inline(always)]
    fn count<S: Simd>(&mut self, simd: S, work: f32, groups: u32) {
        let share = simd.splat16(work / groups.count_ones() as f32);
        let before = simd.load16(&self.work);
        self.work = before.replaced(groups, before + share).to_array();
    }

    /// Gives up groups that take more work than their rays would take one by one.
    #[inline(always)]
    pub(super) fn give_up<S: Simd>(&mut self, simd: S) {
        let too_much =
            simd.load16(&self.most_work).less(simd.load16(&self.work)) & self.groups.live;
        let mut left = too_much;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUP;
            left &= left - 1;
            self.alone[group] |= self.members[group];
        }
        self.groups.live &= !too_much;
    }
}
