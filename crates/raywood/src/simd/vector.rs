//! What every level can do: a narrow set of operations on vectors of sixteen and of eight numbers.

use std::ops::{Add, Div, Mul, Sub};

/// A vector of numbers. A set of its lanes is a number with a bit for each.
///
/// Comparisons with NaN are false.
pub(crate) trait Float:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The numbers as an array.
    type Array;

    /// The smaller of each pair; that of `other` where one is NaN.
    fn smaller(self, other: Self) -> Self;

    /// The larger of each pair; that of `other` where one is NaN.
    fn larger(self, other: Self) -> Self;

    /// The absolute values.
    fn abs(self) -> Self;

    /// `self * factor + addend`, rounded once where the processor has an instruction for it, else twice: for what needs a bound on the error, not
    /// the same number everywhere.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// The lanes where this is less.
    fn less(self, other: Self) -> u32;

    /// The lanes where this is less or equal.
    fn less_or_equal(self, other: Self) -> u32;

    /// The numbers of `chosen` in the given lanes, and of this vector in the others.
    fn replaced(self, lanes: u32, chosen: Self) -> Self;

    /// The least of all numbers, none of which is NaN.
    fn least(self) -> f32;

    /// The greatest of all numbers, none of which is NaN.
    fn greatest(self) -> f32;

    /// The numbers.
    fn to_array(self) -> Self::Array;
}

/// A level's token: proof that the processor has the instructions.
pub(crate) trait Simd: Copy {
    /// Sixteen numbers.
    type F16: Float<Array = [f32; 16]>;
    /// Eight numbers.
    type F8: Float<Array = [f32; 8]>;

    /// Sixteen times the same number.
    fn splat16(self, number: f32) -> Self::F16;

    /// Sixteen numbers from memory.
    fn load16(self, numbers: &[f32; 16]) -> Self::F16;

    /// Eight times the same number.
    fn splat8(self, number: f32) -> Self::F8;

    /// Eight numbers from memory.
    fn load8(self, numbers: &[f32; 8]) -> Self::F8;

    /// Asks for seven cache lines from an address on to be fetched soon. Nothing is read, so any address will do.
    #[inline(always)]
    fn prefetch(self, start: *const u8) {
        let _ = start;
    }

    /// Writes the places of even numbers, of odd ones below `end`, and of those equal to `last` (which is odd and not below `end`) to a list each, in
    /// ascending order, and returns how many each list has. What lies behind these counts for nothing.
    #[inline(always)]
    fn partition(
        self,
        numbers: &[u32; 64],
        end: u32,
        last: u32,
        lists: &mut [[u32; 80]; 3],
    ) -> [usize; 3] {
        let mut counts = [0; 3];
        for (place, &number) in numbers.iter().enumerate() {
            let belongs = [number & 1 == 0, number & 1 == 1 && number < end, number == last];
            for list in 0..3 {
                lists[list][counts[list]] = place as u32;
                counts[list] += usize::from(belongs[list]);
            }
        }
        counts
    }

    /// Keeps the pairs whose key is at most `limit`, in their order, and returns how many these are. Keys and items are equally many, a
    /// multiple of sixteen at least `count`; those from `count` on count for nothing.
    #[inline(always)]
    fn retain(self, keys: &mut [f32], items: &mut [u32], count: usize, limit: f32) -> usize {
        let mut kept = 0;
        for place in 0..count {
            (keys[kept], items[kept]) = (keys[place], items[place]);
            kept += usize::from(keys[kept] <= limit);
        }
        kept
    }

    /// Writes the chosen of sixteen pairs of a key and an item, the largest keys first as far as cheaply possible: the order is a
    /// heuristic, the set is exact. Up to sixteen places are overwritten. Returns how many pairs there are.
    #[inline(always)]
    fn store_sorted(
        self,
        chosen: u32,
        keys: Self::F16,
        items: &[u32; 16],
        sorted_keys: &mut [f32; 16],
        sorted_items: &mut [u32; 16],
    ) -> usize {
        let keys = keys.to_array();
        let (mut left, mut count) = (chosen, 0);
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            // Insertion: few are chosen.
            let mut place = count;
            while place > 0 && sorted_keys[place - 1] < keys[lane] {
                sorted_keys[place] = sorted_keys[place - 1];
                sorted_items[place] = sorted_items[place - 1];
                place -= 1;
            }
            (sorted_keys[place], sorted_items[place]) = (keys[lane], items[lane]);
            count += 1;
        }
        count
    }
}
