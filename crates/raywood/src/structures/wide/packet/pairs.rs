//! Which groups may hit which triangles of two leaves.

use super::kind::Kind;
use super::triangles::{TRIANGLES, Triangles};
use super::{GROUP, Leaf, Packet};
use crate::geometry::LANES;
use crate::simd::{Float, Simd};
use crate::structures::wide::source::Source;

/// The pairs of each triangle with every group, each as 16 times the triangle's lane and the group.
const OF_TRIANGLES: [[u32; GROUP]; TRIANGLES] = {
    let mut pairs = [[0; GROUP]; TRIANGLES];
    let mut pair = 0;
    while pair < TRIANGLES * GROUP {
        pairs[pair / GROUP][pair % GROUP] = pair as u32;
        pair += 1;
    }
    pairs
};

/// The pairs of each group with every triangle.
const OF_GROUPS: [[u32; TRIANGLES]; GROUP] = {
    let mut pairs = [[0; TRIANGLES]; GROUP];
    let mut pair = 0;
    while pair < TRIANGLES * GROUP {
        pairs[pair % GROUP][pair / GROUP] = pair as u32;
        pair += 1;
    }
    pairs
};

impl Packet {
    /// Lists the pairs of a triangle and a group that may hit it, and tells how many there are. They count as work.
    ///
    /// Sixteen groups are held against one triangle at a time, or sixteen triangles against one group, whichever is done sooner: where rays are
    /// incoherent few groups meet a leaf.
    #[inline(always)]
    pub(super) fn pair_up<S: Simd, R: Source, K: Kind>(
        &mut self,
        simd: S,
        triangles: &Triangles,
        [first, second]: [Leaf; 2],
    ) -> usize {
        let possible = triangles.possible & !triangles.unknown;
        let groups = first.groups | second.groups;
        let mut count = 0;
        if groups.count_ones() < possible.count_ones() {
            let mut left = groups;
            while left != 0 {
                let group = left.trailing_zeros() as usize % GROUP;
                left &= left - 1;
                let here = lanes_of(first, group) | lanes_of(second, group) << LANES;
                let met = triangles.met_by::<S, R, K>(simd, group, &self.groups) & possible & here;
                self.work[group] += met.count_ones() as f32;
                count += simd.push_chosen(met, &OF_GROUPS[group], &mut self.pairs, 1 + count).0;
            }
        } else {
            let mut work = simd.load16(&self.work);
            let mut left = possible;
            while left != 0 {
                let lane = left.trailing_zeros() as usize % TRIANGLES;
                left &= left - 1;
                let leaf = if lane < LANES { first } else { second };
                let meeting = triangles.groups::<S, R, K>(simd, lane, &self.groups) & leaf.groups;
                work = work.replaced(meeting, work + simd.splat16(1.0));
                count +=
                    simd.push_chosen(meeting, &OF_TRIANGLES[lane], &mut self.pairs, 1 + count).0;
            }
            self.work = work.to_array();
        }
        count
    }
}

/// All lanes of a leaf if a group meets its box, else none.
#[inline(always)]
fn lanes_of(leaf: Leaf, group: usize) -> u32 {
    const ALL: u32 = (1 << LANES) - 1;
    0u32.wrapping_sub(leaf.groups >> group & 1) & ALL
}
