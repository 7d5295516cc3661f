//! AVX2 with FMA: eight numbers in a register, sixteen in two.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::{Float, Kernel, Simd};

/// The token of AVX2: whoever has it runs on a processor with it and FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

/// Runs a kernel with AVX2.
///
/// # Safety
///
/// The level is [available](super::SimdLevel::is_available).
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Avx2(()))
}

/// Asks for seven cache lines.
#[inline(always)]
pub(super) fn prefetch(start: *const u8) {
    for line in 0..7 {
        // SAFETY: a prefetch reads nothing, whatever the address, and every x86-64 processor has it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line).cast()) };
    }
}

macro_rules! extreme_of_eight {
    ($name:ident, $of_four:ident, $of_one:ident, $what:literal) => {
        #[doc = concat!("The ", $what, " of eight numbers.")]
        ///
        /// # Safety
        ///
        /// The processor has AVX2.
        #[inline(always)]
        pub(super) unsafe fn $name(v: __m256) -> f32 {
            // SAFETY: the caller's.
            unsafe {
                let four = $of_four(_mm256_castps256_ps128(v), _mm256_extractf128_ps::<1>(v));
                let two = $of_four(four, _mm_movehl_ps(four, four));
                _mm_cvtss_f32($of_one(two, _mm_movehdup_ps(two)))
            }
        }
    };
}

extreme_of_eight!(least_of_eight, _mm_min_ps, _mm_min_ss, "least");
extreme_of_eight!(greatest_of_eight, _mm_max_ps, _mm_max_ss, "greatest");

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct F8(__m256);

/// Sixteen numbers.
#[derive(Clone, Copy)]
pub(crate) struct F16([F8; 2]);

macro_rules! operators {
    ($($trait:ident $method:ident $instruction:ident;)*) => {
        $(
            impl $trait for F8 {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    // SAFETY: the values came from the token.
                    Self(unsafe { $instruction(self.0, other.0) })
                }
            }

            impl $trait for F16 {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    let ([a, b], [c, d]) = (self.0, other.0);
                    Self([a.$method(c), b.$method(d)])
                }
            }
        )*
    };
}

operators! { Add add _mm256_add_ps; Sub sub _mm256_sub_ps; Mul mul _mm256_mul_ps; Div div _mm256_div_ps; }

impl Float for F8 {
    type Array = [f32; 8];

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        // SAFETY: the values came from the token. (Of a pair with NaN the instruction takes the second.)
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        // SAFETY: the values came from the token.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: the value came from the token.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // SAFETY: the values came from the token.
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, addend.0) })
    }

    #[inline(always)]
    fn negated_mul_add(self, factor: Self, addend: Self) -> Self {
        // SAFETY: the values came from the token.
        Self(unsafe { _mm256_fnmadd_ps(self.0, factor.0, addend.0) })
    }

    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        // SAFETY: the values came from the token.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> u32 {
        // SAFETY: the values came from the token.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
    }

    #[inline(always)]
    fn replaced(self, lanes: u32, chosen: Self) -> Self {
        // SAFETY: the values came from the token.
        unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(lanes as i32), bits);
            let whole = _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bits));
            Self(_mm256_blendv_ps(self.0, chosen.0, whole))
        }
    }

    #[inline(always)]
    fn least(self) -> f32 {
        // SAFETY: the value came from the token.
        unsafe { least_of_eight(self.0) }
    }

    #[inline(always)]
    fn greatest(self) -> f32 {
        // SAFETY: the value came from the token.
        unsafe { greatest_of_eight(self.0) }
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        // SAFETY: a vector is an array of its numbers, of the same size.
        unsafe { std::mem::transmute(self.0) }
    }
}

impl Float for F16 {
    type Array = [f32; 16];

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self([self.0[0].smaller(other.0[0]), self.0[1].smaller(other.0[1])])
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self([self.0[0].larger(other.0[0]), self.0[1].larger(other.0[1])])
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self([self.0[0].abs(), self.0[1].abs()])
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, addend.0);
        Self([a.mul_add(c, e), b.mul_add(d, f)])
    }

    #[inline(always)]
    fn negated_mul_add(self, factor: Self, addend: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, addend.0);
        Self([a.negated_mul_add(c, e), b.negated_mul_add(d, f)])
    }

    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        self.0[0].less(other.0[0]) | self.0[1].less(other.0[1]) << 8
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> u32 {
        self.0[0].less_or_equal(other.0[0]) | self.0[1].less_or_equal(other.0[1]) << 8
    }

    #[inline(always)]
    fn replaced(self, lanes: u32, chosen: Self) -> Self {
        Self([self.0[0].replaced(lanes, chosen.0[0]), self.0[1].replaced(lanes >> 8, chosen.0[1])])
    }

    #[inline(always)]
    fn least(self) -> f32 {
        self.0[0].smaller(self.0[1]).least()
    }

    #[inline(always)]
    fn greatest(self) -> f32 {
        self.0[0].larger(self.0[1]).greatest()
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 16] {
        // SAFETY: two vectors are an array of their numbers, of the same size.
        unsafe { std::mem::transmute(self.0.map(F8::to_array)) }
    }
}

impl Simd for Avx2 {
    type F16 = F16;
    type F8 = F8;

    #[inline(always)]
    fn splat16(self, number: f32) -> F16 {
        F16([self.splat8(number); 2])
    }

    #[inline(always)]
    fn load16(self, numbers: &[f32; 16]) -> F16 {
        // SAFETY: the token; sixteen numbers can be read.
        unsafe {
            let start = numbers.as_ptr();
            F16([F8(_mm256_loadu_ps(start)), F8(_mm256_loadu_ps(start.add(8)))])
        }
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
        prefetch(start);
    }
}
