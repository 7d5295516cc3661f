//! What every level can do: a narrow set of operations on vectors of sixteen and of eight numbers.

use std::ops::{Add, Div, Mul, Sub};

use super::{BitPlaces, Kernel};
use crate::Vec3;

/// How many places [`Simd::partition`] tells apart.
pub(crate) const PLACES: usize = 48;

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

    /// The larger absolute value of each pair; either where one is NaN.
    #[inline(always)]
    fn larger_magnitude(self, other: Self) -> Self {
        self.abs().larger(other.abs())
    }

    /// This, or `other` unless `chosen`: without a branch where the processor can.
    #[inline(always)]
    fn where_else(self, chosen: bool, other: Self) -> Self {
        if chosen { self } else { other }
    }

    /// `self * factor + addend`, rounded once where the processor has an instruction for it, else twice: for what needs a bound on the error, not
    /// the same number everywhere.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// `addend - self * factor`, rounded as [`mul_add`](Self::mul_add) does.
    fn negated_mul_add(self, factor: Self, addend: Self) -> Self;

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

    /// Whether products are not rounded before a sum ([`Float::mul_add`]).
    const FUSES: bool;

    /// Runs a kernel as a function of its own, which has all registers to itself.
    fn apart<K: Kernel>(self, kernel: K) -> K::Output;

    /// Sixteen times the same number.
    fn splat16(self, number: f32) -> Self::F16;

    /// Sixteen numbers from memory.
    fn load16(self, numbers: &[f32; 16]) -> Self::F16;

    /// Eight times the same number.
    fn splat8(self, number: f32) -> Self::F8;

    /// Eight numbers from memory.
    fn load8(self, numbers: &[f32; 8]) -> Self::F8;

    /// Eight numbers, each from the lane that is given for it, which is less than eight.
    #[inline(always)]
    fn permuted8(self, numbers: Self::F8, from: &[u8; 8]) -> Self::F8 {
        let numbers = numbers.to_array();
        self.load8(&from.map(|lane| numbers[usize::from(lane) % 8]))
    }

    /// The lanes of numbers with a sign, be they zero.
    #[inline(always)]
    fn signs8(self, numbers: Self::F8) -> u32 {
        let signs = numbers.to_array().map(f32::is_sign_negative);
        (0..8).fold(0, |set, lane| set | u32::from(signs[lane]) << lane)
    }

    /// The whole numbers in numbers from 0 to 2^24, what is behind the point cut off.
    #[inline(always)]
    fn whole_numbers(self, numbers: Self::F16) -> [u32; 16] {
        numbers.to_array().map(|number| number as u32)
    }

    /// A number with its bits in other places.
    #[inline(always)]
    fn spread_bits(self, number: u32, places: &BitPlaces) -> u64 {
        places.look_up(number)
    }

    /// Twice eight numbers from memory.
    #[inline(always)]
    fn load_two(self, low: &[f32; 8], high: &[f32; 8]) -> Self::F16 {
        let mut numbers = [0.0; 16];
        numbers[..8].copy_from_slice(low);
        numbers[8..].copy_from_slice(high);
        self.load16(&numbers)
    }

    /// The columns of sixteen rows.
    #[inline(always)]
    fn columns(self, rows: &[[f32; 8]; 16]) -> [Self::F16; 8] {
        let mut columns = [[0.0; 16]; 8];
        for (lane, row) in rows.iter().enumerate() {
            for (column, number) in columns.iter_mut().zip(row) {
                column[lane] = *number;
            }
        }
        let [a, b, c, d, e, f, g, h] = &columns;
        [
            self.load16(a),
            self.load16(b),
            self.load16(c),
            self.load16(d),
            self.load16(e),
            self.load16(f),
            self.load16(g),
            self.load16(h),
        ]
    }

    /// The coordinates of sixteen vectors in space.
    #[inline(always)]
    fn vector_columns(self, vectors: &[Vec3; 16]) -> [Self::F16; 3] {
        let mut columns = [[0.0; 16]; 3];
        for (lane, vector) in vectors.iter().enumerate() {
            (columns[0][lane], columns[1][lane], columns[2][lane]) = (vector.x, vector.y, vector.z);
        }
        [self.load16(&columns[0]), self.load16(&columns[1]), self.load16(&columns[2])]
    }

    /// The least number of each row, none of which is NaN.
    #[inline(always)]
    fn least_of_rows(self, rows: &[[f32; 16]; 16]) -> Self::F16 {
        let mut least = [0.0; 16];
        for (least, row) in least.iter_mut().zip(rows) {
            *least = self.load16(row).least();
        }
        self.load16(&least)
    }

    /// The greatest number of each row, none of which is NaN.
    #[inline(always)]
    fn greatest_of_rows(self, rows: &[[f32; 16]; 16]) -> Self::F16 {
        let mut greatest = [0.0; 16];
        for (greatest, row) in greatest.iter_mut().zip(rows) {
            *greatest = self.load16(row).greatest();
        }
        self.load16(&greatest)
    }

    /// Asks for seven cache lines from an address on to be fetched soon. Nothing is read, so any address will do.
    #[inline(always)]
    fn prefetch(self, start: *const u8) {
        let _ = start;
    }

    /// Asks for the memory of a slice to be fetched soon.
    #[inline(always)]
    fn prefetch_slice<T>(self, items: &[T]) {
        let start = items.as_ptr().cast::<u8>();
        for offset in (0..size_of_val(items)).step_by(7 * 64) {
            self.prefetch(start.wrapping_add(offset));
        }
    }

    /// Writes the places of even numbers, of odd ones below `end`, and of those equal to `last` (which is odd and not below `end`) to a list each, in
    /// ascending order, and returns how many each list has. What lies behind these counts for nothing.
    #[inline(always)]
    fn partition(
        self,
        numbers: &[u32; PLACES],
        end: u32,
        last: u32,
        lists: &mut [[u32; PLACES + 16]; 3],
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

    /// The least of the numbers in the chosen lanes, and where it stands; infinite and nowhere if none is chosen. None of the chosen is NaN.
    #[inline(always)]
    fn least8(self, chosen: u32, numbers: Self::F8) -> (f32, u32) {
        let numbers = numbers.to_array();
        let (mut least, mut places) = (f32::INFINITY, 0);
        for (lane, number) in numbers.into_iter().enumerate() {
            if chosen >> lane & 1 == 1 && number <= least {
                places = if number < least { 0 } else { places } | 1 << lane;
                least = number;
            }
        }
        (least, places)
    }

    /// Puts the chosen of sixteen items onto a stack of `top` items, in their order. Returns how many they are, and which
    /// item is last on the stack then.
    ///
    /// # Panics
    ///
    /// If there is no room for sixteen more, or the stack is empty.
    #[inline(always)]
    fn push_chosen(
        self,
        chosen: u32,
        items: &[u32; 16],
        stack: &mut [u32],
        top: usize,
    ) -> (usize, u32) {
        let stack = &mut stack[top - 1..top + 16];
        let (mut left, mut count) = (chosen, 0);
        while left != 0 {
            count += 1;
            stack[count] = items[left.trailing_zeros() as usize];
            left &= left - 1;
        }
        (count, stack[count])
    }

    /// Puts the chosen of sixteen pairs of a key and an item onto a stack of `top` pairs, the smallest keys last as far as cheaply possible: the order
    /// is a heuristic, the set is exact. Keys may change by 15 units in the last place. Returns how many pairs they are, and which item
    /// is last on the stack then.
    ///
    /// # Panics
    ///
    /// If there is no room for sixteen more, or the stack is empty.
    #[inline(always)]
    fn push_sorted(
        self,
        chosen: u32,
        keys: Self::F16,
        items: &[u32; 16],
        (stack_keys, stack_items): (&mut [f32], &mut [u32]),
        top: usize,
    ) -> (usize, u32) {
        let keys = keys.to_array();
        let sorted_keys = &mut stack_keys[top..top + 16];
        let sorted_items = &mut stack_items[top..top + 16];
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
        (count, stack_items[top + count - 1])
    }
}
