//! Sorting a packet's rays, so that groups are compact.
//!
//! Rays to a light come in the order of the pixels that they belong to; where a picture has depth edges a group's rays are far apart as seen from the
//! light. One such group meets more boxes than all others together.

use super::{GROUP, Packet, RAYS};
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

impl Packet {
    /// Whether some group is so wide that sorting helps: more than half as wide as the packet.
    #[inline(always)]
    pub(super) fn is_scattered<S: Simd>(&self, simd: S) -> bool {
        let mut scattered = 0;
        for axis in 0..2 {
            let [low, high] = &self.groups.slopes[axis];
            let [least, most] = self.groups.whole[axis];
            let width = simd.load16(high) - simd.load16(low);
            scattered |= simd.splat16(0.5 * (most - least)).less(width);
        }
        scattered & self.groups.live != 0
    }

    /// Sorts the rays by the cells of a grid over the packet, in Morton's order; those that are not in the packet come last.
    #[inline(always)]
    pub(super) fn sort<S: Simd>(&mut self, simd: S) {
        // Each ray's cell, and how many rays each cell has.
        let [x, y] = self.groups.whole;
        let mut cells = [[0u16; GROUP]; GROUP];
        let mut starts = [0u16; CELLS * CELLS + 1];
        for (group, cells) in cells.iter_mut().enumerate() {
            let across = cell_coordinates(simd, &self.slopes[0][group], x);
            let along = cell_coordinates(simd, &self.slopes[1][group], y);
            for lane in 0..GROUP {
                let (x, y) = (
                    SPREAD[(across[lane].to_bits() & 15) as usize],
                    SPREAD[(along[lane].to_bits() & 15) as usize],
                );
                let is_member = self.members[group] >> lane & 1 == 1;
                let cell = if is_member { u16::from(x | y << 1) } else { 256 };
                cells[lane] = cell;
                starts[cell as usize] += 1;
            }
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += std::mem::replace(start, sum);
        }

        // Bring everything into the new order.
        let (slopes, nearest, scales) = (self.slopes, self.nearest, self.scales);
        let mut count = 0;
        for (number, &cell) in cells.as_flattened().iter().enumerate() {
            let place = starts[cell as usize];
            starts[cell as usize] += 1;
            count += u32::from(cell < 256);
            let (from, place) = (number % RAYS, usize::from(place) % RAYS);
            self.numbers.as_flattened_mut()[place] = from as u8;
            for (to, slopes) in self.slopes.iter_mut().zip(&slopes) {
                to.as_flattened_mut()[place] = slopes.as_flattened()[from];
            }
            self.nearest.as_flattened_mut()[place] = nearest.as_flattened()[from];
            self.scales.as_flattened_mut()[place] = scales.as_flattened()[from];
        }
        for (group, members) in self.members.iter_mut().enumerate() {
            let here = count.saturating_sub((group * GROUP) as u32).min(GROUP as u32);
            *members = (1 << here) - 1;
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
