//! AVX-512: sixteen numbers in a register, sets of lanes in registers of their own.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::avx2::{greatest_of_eight, least_of_eight};
use super::{Float, Kernel, Simd};

/// The token of AVX-512: whoever has it runs on a processor with F, VL, DQ and BW.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

/// Runs a kernel with AVX-512.
///
/// # Safety
///
/// The level is [available](super::SimdLevel::is_available).
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
    ($type:ident, $array:ty, $add:ident, $sub:ident, $mul:ident, $div:ident, $min:ident, $max:ident, $abs:expr, $fma:ident, $cmp:ident, $blend:ident, $least:path, $greatest:path) => {
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
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                // SAFETY: the values came from the token.
                Self(unsafe { $fma(self.0, factor.0, addend.0) })
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
    _mm512_cmp_ps_mask,
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
    _mm256_cmp_ps_mask,
    _mm256_mask_blend_ps,
    least_of_eight,
    greatest_of_eight
);

impl Simd for Avx512 {
    type F16 = F16;
    type F8 = F8;

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
    fn prefetch(self, start: *const u8) {
        super::avx2::prefetch(start);
    }

    #[inline(always)]
    fn partition(
        self,
        numbers: &[u32; 64],
        end: u32,
        last: u32,
        lists: &mut [[u32; 80]; 3],
    ) -> [usize; 3] {
        let mut counts = [0; 3];
        let [evens, odds, lasts] = lists.each_mut().map(|list| list.as_mut_ptr().cast::<i32>());
        for start in (0..64).step_by(16) {
            // SAFETY: the token; sixteen numbers from `start` on can be read. A list has at most `start` places when sixteen more are written to it,
            // and room for 80.
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
    fn store_sorted(
        self,
        chosen: u32,
        keys: F16,
        items: &[u32; 16],
        sorted_keys: &mut [f32; 16],
        sorted_items: &mut [u32; 16],
    ) -> usize {
        // SAFETY: the token; sixteen items can be read, and sixteen of both written.
        unsafe {
            // The keys' upper 28 bits and the lane are one whole number, negative below all others in lanes that are not chosen.
            let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            let bits = _mm512_andnot_si512(_mm512_set1_epi32(15), _mm512_castps_si512(keys.0));
            let tagged = _mm512_or_si512(bits, lanes);
            let none = _mm512_set1_epi32(i32::MIN);
            let packed = _mm512_mask_compress_epi32(none, chosen as u16, tagged);
            let sorted =
                if chosen.count_ones() <= 4 { sort_four(packed) } else { sort_sixteen(packed) };
            // A permutation takes the lane from the lowest four bits.
            let items = _mm512_permutexvar_epi32(sorted, _mm512_loadu_epi32(items.as_ptr().cast()));
            let keys = _mm512_permutexvar_ps(sorted, keys.0);
            _mm512_storeu_ps(sorted_keys.as_mut_ptr(), keys);
            _mm512_storeu_epi32(sorted_items.as_mut_ptr().cast(), items);
        }
        chosen.count_ones() as usize
    }
}

/// A step of a sorting network: lanes and their partners, the larger number to the lanes of `larger`.
macro_rules! exchange {
    ($v:ident, $partners:expr, $larger:expr) => {{
        let partners = $partners;
        $v = _mm512_mask_max_epi32(_mm512_min_epi32($v, partners), $larger, $v, partners);
    }};
}

/// Sorts each four lanes in descending order.
///
/// # Safety
///
/// The processor has AVX-512.
#[inline(always)]
unsafe fn sort_four(v: __m512i) -> __m512i {
    let mut v = v;
    // SAFETY: the caller's.
    unsafe {
        exchange!(v, _mm512_shuffle_epi32::<0b10_11_00_01>(v), 0b1001_1001_1001_1001);
        exchange!(v, _mm512_shuffle_epi32::<0b01_00_11_10>(v), 0b0011_0011_0011_0011);
        exchange!(v, _mm512_shuffle_epi32::<0b10_11_00_01>(v), 0b0101_0101_0101_0101);
    }
    v
}

/// Sorts all lanes in descending order: Batcher's bitonic network.
///
/// # Safety
///
/// The processor has AVX-512.
#[inline(always)]
unsafe fn sort_sixteen(v: __m512i) -> __m512i {
    let mut v = v;
    // SAFETY: the caller's.
    unsafe {
        // Lanes one and two apart are in one quarter, four apart in neighbouring ones, eight apart in halves.
        macro_rules! one_apart {
            ($larger:expr) => {
                exchange!(v, _mm512_shuffle_epi32::<0b10_11_00_01>(v), $larger)
            };
        }
        macro_rules! two_apart {
            ($larger:expr) => {
                exchange!(v, _mm512_shuffle_epi32::<0b01_00_11_10>(v), $larger)
            };
        }
        macro_rules! four_apart {
            ($larger:expr) => {
                exchange!(v, _mm512_shuffle_i32x4::<0b10_11_00_01>(v, v), $larger)
            };
        }
        macro_rules! eight_apart {
            ($larger:expr) => {
                exchange!(v, _mm512_shuffle_i32x4::<0b01_00_11_10>(v, v), $larger)
            };
        }
        one_apart!(0b1001_1001_1001_1001);
        two_apart!(0b1100_0011_1100_0011);
        one_apart!(0b1010_0101_1010_0101);
        four_apart!(0b1111_0000_0000_1111);
        two_apart!(0b1100_1100_0011_0011);
        one_apart!(0b1010_1010_0101_0101);
        eight_apart!(0b0000_0000_1111_1111);
        four_apart!(0b0000_1111_0000_1111);
        two_apart!(0b0011_0011_0011_0011);
        one_apart!(0b0101_0101_0101_0101);
    }
    v
}
