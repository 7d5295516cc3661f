//! AVX-512: sixteen numbers in a register, sets of lanes in registers of their own.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::avx2::{greatest_of_eight, least_of_eight, permuted_eight};
use super::{BitPlaces, Float, Kernel, PLACES, Simd};
use crate::Vec3;

/// The token of AVX-512: whoever has it runs on a processor with F, VL, DQ and BW.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

/// Runs a kernel with AVX-512.
///
/// # Safety
///
/// The level is [available](super::SimdLevel::is_available).
#[inline(never)]
#[target_feature(enable = "avx512f,fma,avx512vl,avx512dq,avx512bw,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Avx512(()))
}

/// Sixteen numbers.
#[derive(Clone, Copy)]
pub(crate) struct F16(__m512);

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct F8(__m256);

macro_rules! float {
    ($type:ident, $array:ty, $add:ident, $sub:ident, $mul:ident, $div:ident, $min:ident, $max:ident, $abs:expr, $fma:ident, $fnma:ident, $cmp:ident, $range:ident, $blend:ident, $least:path, $greatest:path) => {
        float!(@operator $type, Add, add, $add);
        float!(@operator $type, Sub, sub, $sub);
        float!(@operator $type, Mul, mul, $mul);
        float!(@operator $type, Div, div, $div);

        impl Float for $type {
            type Array = $array;

            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                // SAFETY: the values came from the token. (Of a pair with NaN the instruction takes the second.)
                Self(unsafe { $min(self.0, other.0) })
            }

            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $max(self.0, other.0) })
            }

            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: the value came from the token.
                Self(unsafe { $abs(self.0) })
            }

            #[inline(always)]
            fn larger_magnitude(self, other: Self) -> Self {
                // SAFETY: the values came from the token. (Operation 11 is the largest absolute value.)
                Self(unsafe { $range::<11>(self.0, other.0) })
            }

            #[inline(always)]
            fn where_else(self, chosen: bool, other: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $blend(if chosen { !0 } else { 0 }, other.0, self.0) })
            }

            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $fma(self.0, factor.0, addend.0) })
            }

            #[inline(always)]
            fn negated_mul_add(self, factor: Self, addend: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $fnma(self.0, factor.0, addend.0) })
            }

            #[inline(always)]
            fn less(self, other: Self) -> u32 {
                // SAFETY: the values came from the token.
                u32::from(unsafe { $cmp::<_CMP_LT_OQ>(self.0, other.0) })
            }

            #[inline(always)]
            fn less_or_equal(self, other: Self) -> u32 {
                // SAFETY: the values came from the token.
                u32::from(unsafe { $cmp::<_CMP_LE_OQ>(self.0, other.0) })
            }

            #[inline(always)]
            fn replaced(self, lanes: u32, chosen: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $blend(lanes as _, self.0, chosen.0) })
            }

            #[inline(always)]
            fn least(self) -> f32 {
                // SAFETY: the value came from the token.
                unsafe { $least(self.0) }
            }

            #[inline(always)]
            fn greatest(self) -> f32 {
                // SAFETY: the value came from the token.
                unsafe { $greatest(self.0) }
            }

            #[inline(always)]
            fn to_array(self) -> $array {
                // SAFETY: a vector is an array of its numbers, of the same size.
                unsafe { std::mem::transmute(self.0) }
            }
        }
    };
    (@operator $type:ident, $trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for $type {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

float!(
    F16,
    [f32; 16],
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_min_ps,
    _mm512_max_ps,
    |x| _mm512_abs_ps(x),
    _mm512_fmadd_ps,
    _mm512_fnmadd_ps,
    _mm512_cmp_ps_mask,
    _mm512_range_ps,
    _mm512_mask_blend_ps,
    _mm512_reduce_min_ps,
    _mm512_reduce_max_ps
);
float!(
    F8,
    [f32; 8],
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    |x| _mm256_andnot_ps(_mm256_set1_ps(-0.0), x),
    _mm256_fmadd_ps,
    _mm256_fnmadd_ps,
    _mm256_cmp_ps_mask,
    _mm256_range_ps,
    _mm256_mask_blend_ps,
    least_of_eight,
    greatest_of_eight
);

/// Folds each of sixteen rows to one number, by an operation on pairs. Each of four steps folds two registers to one, in which their numbers alternate.
macro_rules! of_rows {
    ($rows:expr, $fold:ident) => {{
        let row = |number: usize| _mm512_loadu_ps($rows[number].as_ptr());
        // Numbers next to each other of rows 0 and 1, then pairs of them, then quarters of the registers.
        macro_rules! rows {
            ($a:expr, $b:expr) => {{
                let (a, b) = (row($a), row($b));
                $fold(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b))
            }};
        }
        macro_rules! pairs {
            ($a:expr, $b:expr) => {{
                let (a, b) = (_mm512_castps_pd($a), _mm512_castps_pd($b));
                let (low, high) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
                $fold(_mm512_castpd_ps(low), _mm512_castpd_ps(high))
            }};
        }
        macro_rules! quarters {
            ($a:expr, $b:expr) => {{
                let (a, b) = ($a, $b);
                $fold(
                    _mm512_shuffle_f32x4::<0b10_00_10_00>(a, b),
                    _mm512_shuffle_f32x4::<0b11_01_11_01>(a, b),
                )
            }};
        }
        let first = pairs!(rows!(0, 1), rows!(2, 3));
        let second = pairs!(rows!(4, 5), rows!(6, 7));
        let third = pairs!(rows!(8, 9), rows!(10, 11));
        let fourth = pairs!(rows!(12, 13), rows!(14, 15));
        quarters!(quarters!(first, second), quarters!(third, fourth))
    }};
}

impl Simd for Avx512 {
    type F16 = F16;
    type F8 = F8;
    const FUSES: bool = true;

    #[inline(always)]
    fn apart<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: the token.
        unsafe { run(kernel) }
    }

    #[inline(always)]
    fn whole_numbers(self, numbers: F16) -> [u32; 16] {
        // SAFETY: the token; a vector is an array of its numbers.
        unsafe { std::mem::transmute(_mm512_cvttps_epi32(numbers.0)) }
    }

    #[inline(always)]
    fn spread_bits(self, number: u32, places: &BitPlaces) -> u64 {
        // SAFETY: the token. (Not with AVX2 alone: some of those processors take a hundred cycles for it.)
        unsafe { _pdep_u64(u64::from(number), places.mask) }
    }

    #[inline(always)]
    fn splat16(self, number: f32) -> F16 {
        // SAFETY: the token.
        F16(unsafe { _mm512_set1_ps(number) })
    }

    #[inline(always)]
    fn load16(self, numbers: &[f32; 16]) -> F16 {
        // SAFETY: the token; sixteen numbers can be read.
        F16(unsafe { _mm512_loadu_ps(numbers.as_ptr()) })
    }

    #[inline(always)]
    fn splat8(self, number: f32) -> F8 {
        // SAFETY: the token.
        F8(unsafe { _mm256_set1_ps(number) })
    }

    #[inline(always)]
    fn load8(self, numbers: &[f32; 8]) -> F8 {
        // SAFETY: the token; eight numbers can be read.
        F8(unsafe { _mm256_loadu_ps(numbers.as_ptr()) })
    }

    #[inline(always)]
    fn permuted8(self, numbers: F8, from: &[u8; 8]) -> F8 {
        // SAFETY: the token.
        F8(unsafe { permuted_eight(numbers.0, from) })
    }

    #[inline(always)]
    fn signs8(self, numbers: F8) -> u32 {
        // SAFETY: the token.
        unsafe { _mm256_movemask_ps(numbers.0) as u32 }
    }

    #[inline(always)]
    fn load_two(self, low: &[f32; 8], high: &[f32; 8]) -> F16 {
        // SAFETY: the token; twice eight numbers can be read.
        unsafe {
            let low = _mm512_castps256_ps512(_mm256_loadu_ps(low.as_ptr()));
            F16(_mm512_insertf32x8::<1>(low, _mm256_loadu_ps(high.as_ptr())))
        }
    }

    #[inline(always)]
    fn vector_columns(self, vectors: &[Vec3; 16]) -> [F16; 3] {
        /// Which lanes a coordinate's numbers come from: of the first two registers, which count as one, and of the third.
        const fn lanes(coordinate: usize) -> ([i32; 16], [i32; 16], u16) {
            let (mut first, mut last, mut from_last) = ([0; 16], [0; 16], 0);
            let mut lane = 0;
            while lane < 16 {
                let place = 3 * lane + coordinate;
                if place < 32 {
                    first[lane] = place as i32;
                } else {
                    last[lane] = place as i32 - 32;
                    from_last |= 1 << lane;
                }
                lane += 1;
            }
            (first, last, from_last)
        }
        const LANES: [([i32; 16], [i32; 16], u16); 3] = [lanes(0), lanes(1), lanes(2)];
        // SAFETY: the token; three times sixteen numbers can be read.
        unsafe {
            let start = vectors.as_ptr().cast::<f32>();
            let a = _mm512_loadu_ps(start);
            let b = _mm512_loadu_ps(start.add(16));
            let c = _mm512_loadu_ps(start.add(32));
            macro_rules! coordinate {
                ($number:literal) => {{
                    let (first, last, from_last) = const { LANES[$number] };
                    let first = _mm512_loadu_epi32(first.as_ptr());
                    let last = _mm512_loadu_epi32(last.as_ptr());
                    let both = _mm512_permutex2var_ps(a, first, b);
                    F16(_mm512_mask_permutexvar_ps(both, from_last, last, c))
                }};
            }
            [coordinate!(0), coordinate!(1), coordinate!(2)]
        }
    }

    #[inline(always)]
    fn least_of_rows(self, rows: &[[f32; 16]; 16]) -> F16 {
        // SAFETY: the token.
        F16(unsafe { of_rows!(rows, _mm512_min_ps) })
    }

    #[inline(always)]
    fn greatest_of_rows(self, rows: &[[f32; 16]; 16]) -> F16 {
        // SAFETY: the token.
        F16(unsafe { of_rows!(rows, _mm512_max_ps) })
    }

    #[inline(always)]
    fn columns(self, rows: &[[f32; 8]; 16]) -> [F16; 8] {
        // SAFETY: the token; two rows can be read from each even one on.
        unsafe {
            // Each register has two rows, a row two quarters. Bring the first quarters of rows 0, 4, 8 and 12 into one register, of rows 1, 5,
            // 9 and 13 into the next, ..., and likewise the second quarters.
            macro_rules! pair {
                ($row:literal) => {
                    _mm512_loadu_ps(rows.as_ptr().add($row).cast())
                };
            }
            let (r0, r2, r4, r6) = (pair!(0), pair!(2), pair!(4), pair!(6));
            let (r8, r10, r12, r14) = (pair!(8), pair!(10), pair!(12), pair!(14));
            macro_rules! quarters {
                ($a:expr, $b:expr, $c:expr, $d:expr, $even:literal, $odd:literal) => {{
                    let (ab, cd) = (
                        _mm512_shuffle_f32x4::<$even>($a, $b),
                        _mm512_shuffle_f32x4::<$even>($c, $d),
                    );
                    let even = _mm512_shuffle_f32x4::<0b10_00_10_00>(ab, cd);
                    let (ab, cd) = (
                        _mm512_shuffle_f32x4::<$odd>($a, $b),
                        _mm512_shuffle_f32x4::<$odd>($c, $d),
                    );
                    (even, _mm512_shuffle_f32x4::<0b10_00_10_00>(ab, cd))
                }};
            }
            let (a0, a1) = quarters!(r0, r4, r8, r12, 0b00_00_00_00, 0b10_10_10_10);
            let (a2, a3) = quarters!(r2, r6, r10, r14, 0b00_00_00_00, 0b10_10_10_10);
            let (b0, b1) = quarters!(r0, r4, r8, r12, 0b01_01_01_01, 0b11_11_11_11);
            let (b2, b3) = quarters!(r2, r6, r10, r14, 0b01_01_01_01, 0b11_11_11_11);

            // Now each quarter of four registers is a square of four rows.
            macro_rules! interleave {
                ($half:ident, $a:expr, $b:expr) => {
                    F16(_mm512_castpd_ps($half(_mm512_castps_pd($a), _mm512_castps_pd($b))))
                };
            }
            macro_rules! turn {
                ($a:expr, $b:expr, $c:expr, $d:expr) => {{
                    let (low_ab, high_ab) =
                        (_mm512_unpacklo_ps($a, $b), _mm512_unpackhi_ps($a, $b));
                    let (low_cd, high_cd) =
                        (_mm512_unpacklo_ps($c, $d), _mm512_unpackhi_ps($c, $d));
                    [
                        interleave!(_mm512_unpacklo_pd, low_ab, low_cd),
                        interleave!(_mm512_unpackhi_pd, low_ab, low_cd),
                        interleave!(_mm512_unpacklo_pd, high_ab, high_cd),
                        interleave!(_mm512_unpackhi_pd, high_ab, high_cd),
                    ]
                }};
            }
            let [a, b, c, d] = turn!(a0, a1, a2, a3);
            let [e, f, g, h] = turn!(b0, b1, b2, b3);
            [a, b, c, d, e, f, g, h]
        }
    }

    #[inline(always)]
    fn prefetch(self, start: *const u8) {
        super::avx2::prefetch(start);
    }

    #[inline(always)]
    fn partition(
        self,
        numbers: &[u32; PLACES],
        end: u32,
        last: u32,
        lists: &mut [[u32; PLACES + 16]; 3],
    ) -> [usize; 3] {
        let mut counts = [0; 3];
        let [evens, odds, lasts] = lists.each_mut().map(|list| list.as_mut_ptr().cast::<i32>());
        for start in (0..PLACES).step_by(16) {
            // SAFETY: the token; sixteen numbers from `start` on can be read. A list has at most `start` places when sixteen more are written to it,
            // and room for sixteen more than `PLACES`.
            unsafe {
                let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
                let places = _mm512_add_epi32(lanes, _mm512_set1_epi32(start as i32));
                let numbers = _mm512_loadu_epi32(numbers.as_ptr().add(start).cast());
                let odd = _mm512_test_epi32_mask(numbers, _mm512_set1_epi32(1));
                let below = _mm512_cmplt_epu32_mask(numbers, _mm512_set1_epi32(end as i32));
                let is_last = _mm512_cmpeq_epi32_mask(numbers, _mm512_set1_epi32(last as i32));
                for (number, (list, set)) in
                    [(evens, !odd), (odds, odd & below), (lasts, is_last)].into_iter().enumerate()
                {
                    let places = _mm512_maskz_compress_epi32(set, places);
                    _mm512_storeu_epi32(list.add(counts[number]), places);
                    counts[number] += set.count_ones() as usize;
                }
            }
        }
        counts
    }

    #[inline(always)]
    fn retain(self, keys: &mut [f32], items: &mut [u32], count: usize, limit: f32) -> usize {
        assert!(count.next_multiple_of(16) <= keys.len().min(items.len()), "a multiple of sixteen");
        let (keys, items) = (keys.as_mut_ptr(), items.as_mut_ptr().cast::<i32>());
        let mut kept = 0;
        for start in (0..count).step_by(16) {
            let here = (count - start).min(16);
            // SAFETY: the token; sixteen places from `start` on exist. What is written begins at `kept`, which is no more than `start`, so it ends no
            // later than what has just been read.
            unsafe {
                let (k, i) =
                    (_mm512_loadu_ps(keys.add(start)), _mm512_loadu_epi32(items.add(start)));
                let near = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(k, _mm512_set1_ps(limit));
                let keep = near & (u16::MAX >> (16 - here));
                _mm512_storeu_ps(keys.add(kept), _mm512_maskz_compress_ps(keep, k));
                _mm512_storeu_epi32(items.add(kept), _mm512_maskz_compress_epi32(keep, i));
                kept += keep.count_ones() as usize;
            }
        }
        kept
    }

    #[inline(always)]
    fn least8(self, chosen: u32, numbers: F8) -> (f32, u32) {
        // SAFETY: the token.
        unsafe {
            let chosen = chosen as u8;
            let all = _mm256_mask_mov_ps(_mm256_set1_ps(f32::INFINITY), chosen, numbers.0);
            let four = _mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps::<1>(all));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            let one = _mm_min_ss(two, _mm_movehdup_ps(two));
            let same = _mm256_cmp_ps_mask::<_CMP_EQ_OQ>(numbers.0, _mm256_broadcastss_ps(one));
            (_mm_cvtss_f32(one), u32::from(chosen & same))
        }
    }

    #[inline(always)]
    fn push_chosen(
        self,
        chosen: u32,
        items: &[u32; 16],
        stack: &mut [u32],
        top: usize,
    ) -> (usize, u32) {
        let below = stack[top - 1];
        let stack = &mut stack[top..top + 16];
        let count = chosen.count_ones();
        // SAFETY: the token; sixteen items can be read and written.
        unsafe {
            let items = _mm512_loadu_epi32(items.as_ptr().cast());
            let items = _mm512_maskz_compress_epi32(chosen as u16, items);
            // Hardly ever more than eight are chosen. Half a register does for these, and costs half of it where registers are worked on in halves (Zen 4).
            if count > 8 {
                _mm512_storeu_epi32(stack.as_mut_ptr().cast(), items);
                return (count as usize, last(items, count, below));
            }
            let items = _mm512_castsi512_si256(items);
            _mm256_storeu_epi32(stack.as_mut_ptr().cast(), items);
            (count as usize, last_of_eight(items, count, below))
        }
    }

    #[inline(always)]
    fn push_sorted(
        self,
        chosen: u32,
        keys: F16,
        items: &[u32; 16],
        (stack_keys, stack_items): (&mut [f32], &mut [u32]),
        top: usize,
    ) -> (usize, u32) {
        let stack_keys = &mut stack_keys[top..top + 16];
        let below = stack_items[top - 1];
        let stack_items = &mut stack_items[top..top + 16];
        let count = chosen.count_ones();
        // SAFETY: the token; sixteen items can be read, and sixteen of both written.
        unsafe {
            // The keys' upper 28 bits and the lane are one whole number, negative below all others in lanes that are not chosen.
            let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            let bits = _mm512_andnot_si512(_mm512_set1_epi32(15), _mm512_castps_si512(keys.0));
            let tagged = _mm512_or_si512(bits, lanes);
            let none = _mm512_set1_epi32(i32::MIN);
            let tagged = _mm512_mask_compress_epi32(none, chosen as u16, tagged);
            let low = sort_four(_mm512_castsi512_si256(tagged));
            let items = _mm512_loadu_epi32(items.as_ptr().cast());
            if count > 8 {
                let high = sort_four(_mm512_extracti64x4_epi64::<1>(tagged));
                let sorted = _mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high);
                // A permutation takes the lane from the lowest four bits.
                let items = _mm512_permutexvar_epi32(sorted, items);
                _mm512_storeu_epi32(stack_keys.as_mut_ptr().cast(), sorted);
                _mm512_storeu_epi32(stack_items.as_mut_ptr().cast(), items);
                return (count as usize, last(items, count, below));
            }
            let items = _mm512_permutexvar_epi32(_mm512_castsi256_si512(low), items);
            let items = _mm512_castsi512_si256(items);
            _mm256_storeu_epi32(stack_keys.as_mut_ptr().cast(), low);
            _mm256_storeu_epi32(stack_items.as_mut_ptr().cast(), items);
            (count as usize, last_of_eight(items, count, below))
        }
    }
}

/// The last of the first `count` numbers, or `below` if there are none: without a branch, and from the register, as memory that was just written would be
/// slow to answer.
///
/// # Safety
///
/// The processor has AVX-512.
#[inline(always)]
unsafe fn last(numbers: __m512i, count: u32, below: u32) -> u32 {
    // SAFETY: the caller's.
    unsafe {
        // Of -1 the lowest five bits are the number of the last lane of the second vector.
        let lane = _mm512_castsi128_si512(_mm_cvtsi32_si128(count.wrapping_sub(1) as i32));
        let below = _mm512_set1_epi32(below as i32);
        let last = _mm512_permutex2var_epi32(numbers, lane, below);
        _mm_cvtsi128_si32(_mm512_castsi512_si128(last)) as u32
    }
}

/// [`last`] of at most eight numbers.
///
/// # Safety
///
/// The processor has AVX-512.
#[inline(always)]
unsafe fn last_of_eight(numbers: __m256i, count: u32, below: u32) -> u32 {
    // SAFETY: the caller's.
    unsafe {
        let lane = _mm256_castsi128_si256(_mm_cvtsi32_si128(count.wrapping_sub(1) as i32));
        let below = _mm256_set1_epi32(below as i32);
        let last = _mm256_permutex2var_epi32(numbers, lane, below);
        _mm_cvtsi128_si32(_mm256_castsi256_si128(last)) as u32
    }
}

/// A step of a sorting network: lanes and their partners, the larger number to the lanes of `larger`.
macro_rules! exchange {
    ($v:ident, $partners:expr, $larger:expr) => {{
        let partners = $partners;
        $v = _mm256_mask_max_epi32(_mm256_min_epi32($v, partners), $larger, $v, partners);
    }};
}

/// Sorts each four lanes in descending order.
///
/// # Safety
///
/// The processor has AVX-512.
#[inline(always)]
unsafe fn sort_four(v: __m256i) -> __m256i {
    let mut v = v;
    // SAFETY: the caller's.
    unsafe {
        exchange!(v, _mm256_shuffle_epi32::<0b10_11_00_01>(v), 0b1001_1001);
        exchange!(v, _mm256_shuffle_epi32::<0b01_00_11_10>(v), 0b0011_0011);
        exchange!(v, _mm256_shuffle_epi32::<0b10_11_00_01>(v), 0b0101_0101);
    }
    v
}
