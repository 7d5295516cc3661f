//! How much work each group of a packet takes, and when it takes too much.
//!
//! Counted in tests of one triangle against the sixteen rays of a group, about thirty cycles. What is done once for several groups, each has its share of:
//! so work is large where groups go through the tree alone, which is what incoherent rays are.

use super::{GROUP, Packet};
use crate::simd::{Float, Simd};

/// A group is given up when it took more work than this for each of its rays of which not all is known. To trace one alone takes 7 to 13. With half of
/// it groups are given up that would soon have been done.
const MOST_WORK: f32 = 18.0;

/// What a node's boxes are.
const NODE: f32 = 6.0;

/// What the triangles of two leaves are together, and what each one of them is besides that a ray of the packet may hit.
const LEAVES: f32 = 9.0;
/// See [`LEAVES`].
const TRIANGLE: f32 = 0.5;

/// How much work a group may be of which so many rays have not found what they look for.
#[inline(always)]
pub(super) fn most_work(rays: u32) -> f32 {
    MOST_WORK * rays as f32
}

impl Packet {
    /// Nothing was done yet.
    #[inline(always)]
    pub(super) fn begin_work(&mut self) {
        self.work = [0.0; GROUP];
        self.alone = [0; GROUP];
        for (most, members) in self.most_work.iter_mut().zip(&self.members) {
            *most = most_work(members.count_ones());
        }
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
