//! Sorting a packet's rays, so that groups are compact.
//!
//! Rays to a light come in the order of the pixels that they belong to; where a picture has depth edges a group's rays are far apart as seen from the
//! light. One such group meets more boxes than all others together.

use super::kind::Kind;
use super::{GROUP, Packet};
use crate::simd::{Float, Simd};

/// Cells a side of the grid that rays are sorted into.
const CELLS: usize = 16;

/// A number from 0 to 15 with a zero before each bit.
const SPREAD: [u8; CELLS] = [
    0b00_00_00_00,
    0b00_00_00_01,
    0b00_00_01_00,
    0b00_00_01_01,
    0b00_01_00_00,
    0b00_01_00_01,
    0b00_01_01_00,
    0b00_01_01_01,
    0b01_00_00_00,
    0b01_00_00_01,
    0b01_00_01_00,
    0b01_00_01_01,
    0b01_01_00_00,
    0b01_01_00_01,
    0b01_01_01_00,
    0b01_01_01_01,
];

/// Groups wider than this share of the packet along an axis are sorted. Were all of them equal squares, they would be a quarter as wide.
pub(super) const WIDE: f32 = 0.3;

impl Packet {
    /// The groups that are so wide that sorting helps.
    #[inline(always)]
    pub(super) fn scattered<S: Simd>(&self, simd: S) -> u32 {
        let mut scattered = 0;
        for axis in 0..2 {
            let [low, high] = &self.groups.slopes[axis];
            let [least, most] = self.groups.whole[axis];
            let width = simd.load16(high) - simd.load16(low);
            scattered |= simd.splat16(WIDE * (most - least)).less(width);
        }
        scattered & self.groups.live
    }

    /// Sorts the rays of some groups by the cells of a grid over the packet, in Morton's order; those that are not in the packet come last.
    #[inline(always)]
    pub(super) fn sort<S: Simd, K: Kind>(&mut self, simd: S, groups: u32) {
        // Each ray's cell.
        let [x, y] = self.groups.whole;
        let mut sorted = [0u8; GROUP];
        let mut cells = [[0u16; GROUP]; GROUP];
        let (mut left, mut count) = (groups, 0);
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUP;
            left &= left - 1;
            sorted[count % GROUP] = group as u8;
            let across = cell_coordinates(simd, &self.slopes[0][group], x);
            let along = cell_coordinates(simd, &self.slopes[1][group], y);
            for lane in 0..GROUP {
                let (x, y) = (
                    SPREAD[(across[lane].to_bits() & 15) as usize],
                    SPREAD[(along[lane].to_bits() & 15) as usize],
                );
                let is_member = self.members[group] >> lane & 1 == 1;
                let cell = if is_member { u16::from(x | y << 1) } else { 256 };
                cells[count % GROUP][lane] = cell;
            }
            count += 1;
        }
        let (sorted, cells) = (&sorted[..count], &cells[..count]);

        // How many rays each cell has. Neighbours tend to be in the same cell, and one counter would wait for itself: so one ray of each group after the other.
        let mut starts = [0u16; CELLS * CELLS + 1];
        for lane in 0..GROUP {
            for cells in cells {
                starts[usize::from(cells[lane])] += 1;
            }
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += std::mem::replace(start, sum);
        }
        let members = u32::from(starts[CELLS * CELLS]);

        // Bring everything into the new order.
        let (slopes, nearest, scales) = (self.slopes, self.nearest, self.scales);
        let starts_of_rays = K::LATE.then_some(self.starts);
        for lane in 0..GROUP {
            for (cells, &group) in cells.iter().zip(sorted) {
                let start = &mut starts[usize::from(cells[lane])];
                let place = usize::from(*start);
                *start += 1;
                let from = usize::from(group) % GROUP;
                let (to, place) = (usize::from(sorted[place / GROUP]) % GROUP, place % GROUP);
                self.numbers[to][place] = (from * GROUP + lane) as u8;
                for (new, old) in self.slopes.iter_mut().zip(&slopes) {
                    new[to][place] = old[from][lane];
                }
                self.nearest[to][place] = nearest[from][lane];
                self.scales[to][place] = scales[from][lane];
                if let Some(starts) = &starts_of_rays {
                    self.starts[to][place] = starts[from][lane];
                }
            }
        }
        for (number, &group) in sorted.iter().enumerate() {
            let here = members.saturating_sub((number * GROUP) as u32).min(GROUP as u32);
            self.members[usize::from(group) % GROUP] = (1 << here) - 1;
        }
    }
}

/// In which row or column of cells slopes lie: the lowest bits.
#[inline(always)]
fn cell_coordinates<S: Simd>(
    simd: S,
    slopes: &[f32; GROUP],
    [least, most]: [f32; 2],
) -> [f32; GROUP] {
    // From two to the 23rd on the lowest bit of a number means one.
    const SHIFT: f32 = (1 << 23) as f32;
    let width = most - least;
    let scale = if width > 0.0 { 15.0 / width } else { 0.0 };
    let cells = (simd.load16(slopes) - simd.splat16(least)) * simd.splat16(scale);
    (cells.larger(simd.splat16(0.0)).smaller(simd.splat16(15.0)) + simd.splat16(SHIFT)).to_array()
}
