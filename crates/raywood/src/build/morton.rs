//! Morton codes: where a point lies in space as one number, so that sorting the numbers sorts space. Bits go to the axes by turns while cells are cubes, and to the
//! longest side alone until they are: Vinkler, Bittner and Havran, "Extended Morton Codes for High Performance Bounding Volume Hierarchy Construction", HPG 2017.

use super::PackedAabb;

/// How many bits a primitive's number has.
pub(super) const NUMBER_BITS: u32 = 31;

/// How many bits a code has: what is left of 64, but one.
const CODE_BITS: u32 = u64::BITS - NUMBER_BITS - 1;

/// Set in the keys of primitives that are far from the box whose cells the codes count: they come last along the curve, and are divided from all others first.
pub(super) const FAR: u64 = 1 << 63;

/// How many bits of a code an axis has at most.
const AXIS_BITS: u32 = 16;

/// How many values the halves of a coordinate have, each of which stands in a table.
const HALF: usize = 1 << (AXIS_BITS / 2);

/// How points become codes.
pub(super) struct Morton {
    start: [f32; 4],
    scale: [f32; 4],
    /// The number of the last cell on each axis.
    last: [f32; 3],
    /// For each axis where the bits of its coordinate go: those of the lower half, and those of the upper.
    spread: [[[u64; HALF]; 2]; 3],
}

impl Morton {
    /// For points in and about a box. Of an axis along which it is empty, or not finite, nothing is told.
    pub(super) fn new(centers: &PackedAabb) -> Self {
        let extent = |axis: usize| {
            // Halves, whose differences do not overflow.
            let extent = 0.5 * centers.max()[axis] - 0.5 * centers.min()[axis];
            if extent > 0.0 && extent < f32::INFINITY { extent } else { 0.0 }
        };
        let extents = [extent(0), extent(1), extent(2)];

        // The highest bit says which half of the box along its longest side, and so on.
        let (mut sides, mut bits) = (extents, [0; 3]);
        let mut axes = [0; CODE_BITS as usize];
        for axis_of_bit in axes.iter_mut().rev() {
            let side = |axis: usize| if bits[axis] < AXIS_BITS { sides[axis] } else { -1.0 };
            let longest = |a: usize, b: usize| if side(b) > side(a) { b } else { a };
            let axis = longest(longest(0, 1), 2);
            (*axis_of_bit, sides[axis]) = (axis, 0.5 * sides[axis]);
            bits[axis] += 1;
        }

        let mut spread = [[[0; HALF]; 2]; 3];
        let mut placed = [0; 3];
        for (bit, &axis) in axes.iter().enumerate() {
            let (half, bit_of_half) = (placed[axis] / 8, placed[axis] % 8);
            placed[axis] += 1;
            // Values with this bit, of which it is the highest, are those without it once more.
            let (without, with) = spread[axis][half].split_at_mut(1 << bit_of_half);
            for (code, without) in with.iter_mut().zip(without) {
                *code = *without | 1 << (bit as u32 + NUMBER_BITS);
            }
        }
        let cells = |axis: usize| (1u32 << bits[axis]) as f32;
        let scale = |axis: usize| cells(axis) / extents[axis];
        Self {
            start: centers.min(),
            scale: [scale(0), scale(1), scale(2), 0.0],
            last: [cells(0) - 1.0, cells(1) - 1.0, cells(2) - 1.0],
            spread,
        }
    }

    /// The code of a point, with the number of a primitive in the bits below it.
    #[inline(always)]
    pub(super) fn key(&self, center: [f32; 4], number: u32) -> u64 {
        let code = |axis: usize| {
            let place = (0.5 * center[axis] - 0.5 * self.start[axis]) * self.scale[axis];
            // Not a number, where the box has no extent, is in the first cell.
            let place = if place > 0.0 { place } else { 0.0 };
            let place = if place < self.last[axis] { place } else { self.last[axis] };
            let cell = place as i32 as usize;
            let [low, high] = &self.spread[axis];
            low[cell % HALF] | high[cell / HALF % HALF]
        };
        code(0) | code(1) | code(2) | u64::from(number)
    }
}

/// The number of the primitive in the lower bits of a key.
#[inline(always)]
pub(crate) fn number(key: u64) -> u32 {
    (key & ((1 << NUMBER_BITS) - 1)) as u32
}

/// Whether keys have the same code.
#[inline(always)]
pub(super) fn same_code(a: u64, b: u64) -> bool {
    (a ^ b) >> NUMBER_BITS == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;

    fn code(morton: &Morton, x: f32, y: f32, z: f32) -> u64 {
        morton.key([x, y, z, 0.0], 0) >> NUMBER_BITS
    }

    #[test]
    fn bits_of_a_cube_go_to_the_axes_by_turns() {
        let morton = Morton::new(&Aabb::new([-1.0; 3], [1.0; 3]).into());
        // Eleven bits for x and y, ten for z, that of x on top.
        assert_eq!(code(&morton, -1.0, -1.0, -1.0), 0);
        assert_eq!(code(&morton, 1.0, 1.0, 1.0), (1 << 32) - 1);
        assert_eq!(code(&morton, 0.0, -1.0, -1.0), 1 << 31);
        assert_eq!(code(&morton, -1.0, 0.0, -1.0), 1 << 30);
        assert_eq!(code(&morton, -1.0, -1.0, 0.0), 1 << 29);
        assert_eq!(code(&morton, -1.0, -1.0, -0.5), 1 << 26);
    }

    #[test]
    fn long_sides_get_the_first_bits() {
        let morton = Morton::new(&Aabb::new([0.0; 3], [1.0, 8.0, 0.0]).into());
        assert_eq!(code(&morton, 0.0, 4.0, 0.0), 1 << 31);
        assert_eq!(code(&morton, 0.0, 2.0, 0.0), 1 << 30);
        // Sides equally long: x first.
        assert_eq!(code(&morton, 0.5, 0.0, 0.0), 1 << 28);
        assert_eq!(code(&morton, 0.0, 0.5, 0.0), 1 << 27);
        // Sixteen bits for y and as many for x: none is left that can tell nothing for z.
        assert_eq!(code(&morton, 1.0, 8.0, 0.0).count_ones(), 32);
    }

    #[test]
    fn nothing_is_beyond_the_numbers() {
        let huge = f32::MAX;
        for bounds in [
            Aabb::new([-huge; 3], [huge; 3]),
            Aabb::new([1.0; 3], [1.0; 3]),
            Aabb::new([0.0; 3], [1e-45, 0.0, 0.0]),
        ] {
            let morton = Morton::new(&bounds.into());
            let code = |corner: crate::Vec3| code(&morton, corner.x, corner.y, corner.z);
            assert_eq!(code(bounds.min), 0, "{bounds:?}");
            assert!(code(bounds.max) < 1 << CODE_BITS, "{bounds:?}");
        }
        let morton = Morton::new(&Aabb::new([-huge; 3], [huge; 3]).into());
        assert_eq!(code(&morton, huge, huge, huge), (1 << 32) - 1);
        for bounds in [
            Aabb::EMPTY,
            Aabb::new([f32::NAN; 3], [f32::NAN; 3]),
            Aabb::new([0.0, 0.0, f32::NEG_INFINITY], [1.0, f32::INFINITY, 1.0]),
        ] {
            let morton = Morton::new(&bounds.into());
            assert!(code(&morton, 0.5, 0.5, 0.5) < 1 << CODE_BITS, "{bounds:?}");
        }
    }
}
