//! Morton codes: where a point lies in space as one number, so that sorting the numbers sorts space. Bits go to the axes by turns while cells are cubes, and to the
//! longest side alone until they are: Vinkler, Bittner and Havran, "Extended Morton Codes for High Performance Bounding Volume Hierarchy Construction", HPG 2017.

use super::PackedAabb;
use crate::simd::{BitPlaces, Float, Portable, Simd};

/// Set in the keys of primitives that are far from the box whose cells the codes count: they come last along the curve, and are divided from all others first.
pub(super) const FAR: u64 = 1 << 63;

/// How the bits of keys are divided: [`FAR`], below it a code, and below that the number of a primitive, which takes as few bits as the numbers of all allow.
#[derive(Clone, Copy)]
pub(crate) struct KeyBits {
    /// How many bits a number has.
    number: u32,
}

impl KeyBits {
    /// The most bits a number may have: so many primitives there can be.
    const MOST: u32 = 31;

    /// The fewest: a code of 43 bits tells all apart that longer ones would.
    const FEWEST: u32 = 20;

    /// For so many primitives.
    pub(super) fn for_primitives(primitives: usize) -> Self {
        let needed = primitives.next_power_of_two().trailing_zeros();
        Self { number: needed.clamp(Self::FEWEST, Self::MOST) }
    }

    /// Above so many bits lie the first 32 of a code.
    pub(super) fn below_coarse_code(self) -> u32 {
        Self::MOST
    }

    /// Above so many bits lies the code.
    pub(super) fn below_code(self) -> u32 {
        self.number
    }

    /// The number in a key.
    #[inline(always)]
    pub(crate) fn number(self, key: u64) -> u32 {
        (key & !(u64::MAX << self.number)) as u32
    }

    /// Whether keys have the same code.
    #[inline(always)]
    pub(super) fn same_code(self, a: u64, b: u64) -> bool {
        (a ^ b) >> self.number == 0
    }

    /// Whether the first 32 bits of their codes are the same.
    #[inline(always)]
    pub(super) fn same_coarse_code(self, a: u64, b: u64) -> bool {
        (a ^ b) >> Self::MOST == 0
    }
}

/// How points become codes.
pub(super) struct Morton {
    start: [f32; 4],
    scale: [f32; 4],
    /// The number of the last cell on each axis.
    last: [f32; 3],
    /// For each axis where the bits of its coordinate go.
    places: [BitPlaces; 3],
}

impl Morton {
    /// For points in and about a box. Of an axis along which it is empty, or not finite, nothing is told.
    pub(super) fn new(centers: &PackedAabb, key_bits: KeyBits) -> Self {
        let extent = |axis: usize| {
            // Halves, whose differences do not overflow.
            let extent = 0.5 * centers.max()[axis] - 0.5 * centers.min()[axis];
            if extent > 0.0 && extent < f32::INFINITY { extent } else { 0.0 }
        };
        let extents = [extent(0), extent(1), extent(2)];

        // The highest bit says which half of the box along its longest side, and so on.
        let (mut sides, mut bits, mut masks) = (extents, [0; 3], [0; 3]);
        for bit in (key_bits.number..u64::BITS - 1).rev() {
            let side = |axis: usize| if bits[axis] < BitPlaces::MOST { sides[axis] } else { -1.0 };
            let longest = |a: usize, b: usize| if side(b) > side(a) { b } else { a };
            let axis = longest(longest(0, 1), 2);
            sides[axis] *= 0.5;
            bits[axis] += 1;
            masks[axis] |= 1 << bit;
        }

        let cells = |axis: usize| (1u32 << bits[axis]) as f32;
        let scale = |axis: usize| cells(axis) / extents[axis];
        Self {
            start: centers.min(),
            scale: [scale(0), scale(1), scale(2), 0.0],
            last: [cells(0) - 1.0, cells(1) - 1.0, cells(2) - 1.0],
            places: masks.map(BitPlaces::new),
        }
    }

    /// The codes of sixteen points, with the numbers of primitives in the bits below them, which follow on the first.
    #[inline(always)]
    pub(super) fn keys<S: Simd>(&self, simd: S, centers: &[S::F16; 3], first: u32) -> [u64; 16] {
        let (zero, half) = (simd.splat16(0.0), simd.splat16(0.5));
        let mut keys = std::array::from_fn(|lane| u64::from(first) + lane as u64);
        for (axis, center) in centers.iter().enumerate() {
            let start = simd.splat16(0.5 * self.start[axis]);
            let place = (*center * half - start) * simd.splat16(self.scale[axis]);
            // Not a number, where the box has no extent, is in the first cell.
            let place = place.larger(zero).smaller(simd.splat16(self.last[axis]));
            for (key, cell) in keys.iter_mut().zip(simd.whole_numbers(place)) {
                *key |= simd.spread_bits(cell, &self.places[axis]);
            }
        }
        keys
    }

    /// The same of one.
    pub(super) fn key(&self, center: [f32; 4], number: u32) -> u64 {
        let [x, y, z, _] = center.map(|coordinate| Portable.splat16(coordinate));
        self.keys(Portable, &[x, y, z], number)[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;

    /// For as many primitives as there can be: their codes have 32 bits.
    const BITS: KeyBits = KeyBits { number: KeyBits::MOST };

    fn code(morton: &Morton, x: f32, y: f32, z: f32) -> u64 {
        morton.key([x, y, z, 0.0], 0) >> BITS.number
    }

    #[test]
    fn bits_of_a_cube_go_to_the_axes_by_turns() {
        let morton = Morton::new(&Aabb::new([-1.0; 3], [1.0; 3]).into(), BITS);
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
        let morton = Morton::new(&Aabb::new([0.0; 3], [1.0, 8.0, 0.0]).into(), BITS);
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
            let morton = Morton::new(&bounds.into(), BITS);
            let code = |corner: crate::Vec3| code(&morton, corner.x, corner.y, corner.z);
            assert_eq!(code(bounds.min), 0, "{bounds:?}");
            assert!(code(bounds.max) < 1 << 32, "{bounds:?}");
        }
        let morton = Morton::new(&Aabb::new([-huge; 3], [huge; 3]).into(), BITS);
        assert_eq!(code(&morton, huge, huge, huge), (1 << 32) - 1);
        for bounds in [
            Aabb::EMPTY,
            Aabb::new([f32::NAN; 3], [f32::NAN; 3]),
            Aabb::new([0.0, 0.0, f32::NEG_INFINITY], [1.0, f32::INFINITY, 1.0]),
        ] {
            let morton = Morton::new(&bounds.into(), BITS);
            assert!(code(&morton, 0.5, 0.5, 0.5) < 1 << 32, "{bounds:?}");
        }
    }
}
