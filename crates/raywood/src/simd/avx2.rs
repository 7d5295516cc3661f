//! AVX2 with FMA: eight numbers in a register, sixteen in two.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::{Float, Kernel, PLACES, Portable, Simd};

/// The token of AVX2: whoever has it runs on a processor with it and FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

/// Runs a kernel with AVX2.
///
/// # Safety
///
/// The level is [available](super::SimdLevel::is_available).
#[inline(never)]
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

/// Eight numbers, each from the lane that is given for it.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
pub(super) unsafe fn permuted_eight(v: __m256, from: &[u8; 8]) -> __m256 {
    // SAFETY: the caller's promise; eight bytes can be read.
    unsafe {
        let lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(from.as_ptr().cast()));
        _mm256_permutevar8x32_ps(v, lanes)
    }
}

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
    const FUSES: bool = true;

    #[inline(always)]
    fn apart<K: Kernel>(self, kernel: K) -> K::Output {
        // SAFETY: the token.
        unsafe { run(kernel) }
    }

    #[inline(always)]
    fn whole_numbers(self, numbers: F16) -> [u32; 16] {
        let F16([F8(low), F8(high)]) = numbers;
        // SAFETY: the token; two vectors are an array of their numbers.
        unsafe { std::mem::transmute([_mm256_cvttps_epi32(low), _mm256_cvttps_epi32(high)]) }
    }

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
        F16([self.load8(low), self.load8(high)])
    }

    #[inline(always)]
    fn prefetch(self, start: *const u8) {
        prefetch(start);
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
        let lists = lists.each_mut().map(|list| list.as_mut_ptr());
        for start in (0..PLACES).step_by(8) {
            // SAFETY: the token; eight numbers from `start` on can be read. A list has at most `start` places when eight more are written to it, and
            // room for sixteen more than `PLACES`.
            unsafe {
                let numbers = _mm256_loadu_si256(numbers.as_ptr().add(start).cast());
                // There is no comparison of numbers without sign: move both to those with one.
                let signed = |v| _mm256_xor_si256(v, _mm256_set1_epi32(i32::MIN));
                let all = |number: u32| _mm256_set1_epi32(number as i32);
                let odd = lanes_of(_mm256_slli_epi32::<31>(numbers));
                let below = lanes_of(_mm256_cmpgt_epi32(signed(all(end)), signed(numbers)));
                let is_last = lanes_of(_mm256_cmpeq_epi32(numbers, all(last)));
                for (list, set) in [!odd & 0xff, odd & below, is_last].into_iter().enumerate() {
                    let places = _mm256_add_epi32(chosen_lanes(set), all(start as u32));
                    _mm256_storeu_si256(lists[list].add(counts[list]).cast(), places);
                    counts[list] += set.count_ones() as usize;
                }
            }
        }
        counts
    }

    #[inline(always)]
    fn retain(self, keys: &mut [f32], items: &mut [u32], count: usize, limit: f32) -> usize {
        assert!(count.next_multiple_of(8) <= keys.len().min(items.len()), "a multiple of sixteen");
        let (keys, items) = (keys.as_mut_ptr(), items.as_mut_ptr());
        let mut kept = 0;
        for start in (0..count).step_by(8) {
            let here = (count - start).min(8);
            // SAFETY: the token; eight places from `start` on exist. What is written begins at `kept`, which is no more than `start`, so it ends no later
            // than what has just been read.
            unsafe {
                let k = _mm256_loadu_ps(keys.add(start));
                let i = _mm256_loadu_si256(items.add(start).cast());
                let keep = F8(k).less_or_equal(self.splat8(limit)) & (0xff >> (8 - here));
                let lanes = chosen_lanes(keep);
                _mm256_storeu_ps(keys.add(kept), _mm256_permutevar8x32_ps(k, lanes));
                _mm256_storeu_si256(items.add(kept).cast(), _mm256_permutevar8x32_epi32(i, lanes));
                kept += keep.count_ones() as usize;
            }
        }
        kept
    }

    #[inline(always)]
    fn least8(self, chosen: u32, numbers: F8) -> (f32, u32) {
        let least = self.splat8(f32::INFINITY).replaced(chosen, numbers).least();
        (least, chosen & numbers.less_or_equal(self.splat8(least)))
    }

    #[inline(always)]
    fn push_chosen(
        self,
        chosen: u32,
        items: &[u32; 16],
        stack: &mut [u32],
        top: usize,
    ) -> (usize, u32) {
        let stack = &mut stack[top - 1..top + 16];
        let first = (chosen & 0xff).count_ones() as usize;
        // SAFETY: the token; two halves of the items can be read. There is room for sixteen from place 1 on, and `first` is at most eight.
        unsafe {
            let [low, high] = halves(items);
            let low = _mm256_permutevar8x32_epi32(low, chosen_lanes(chosen));
            let high = _mm256_permutevar8x32_epi32(high, chosen_lanes(chosen >> 8));
            _mm256_storeu_si256(stack.as_mut_ptr().add(1).cast(), low);
            _mm256_storeu_si256(stack.as_mut_ptr().add(1 + first).cast(), high);
        }
        let count = chosen.count_ones() as usize;
        (count, stack[count])
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
        let count = chosen.count_ones() as usize;
        if count > 8 {
            // Seldom.
            let keys = keys.to_array();
            return push_many(chosen, &keys, items, (stack_keys, stack_items), top);
        }
        let stack_keys = &mut stack_keys[top..top + 16];
        let stack_items = &mut stack_items[top - 1..top + 16];
        // SAFETY: the token; two halves of the items can be read. There is room for eight keys, and for eight items from place 1 on.
        unsafe {
            // The keys' upper 28 bits and the lane are one whole number. Bring the chosen of each half together.
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let tagged = |half: usize, lanes| {
                let bits = _mm256_castps_si256(keys.0[half].0);
                _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(15), bits), lanes)
            };
            let low = tagged(0, lanes);
            let high = tagged(1, _mm256_add_epi32(lanes, _mm256_set1_epi32(8)));
            let low = _mm256_permutevar8x32_epi32(low, chosen_lanes(chosen));
            let high = _mm256_permutevar8x32_epi32(high, chosen_lanes(chosen >> 8));

            // The second half's behind those of the first, and behind them what is below all others.
            let first = _mm256_set1_epi32((chosen & 0xff).count_ones() as i32);
            let high = _mm256_permutevar8x32_epi32(high, _mm256_sub_epi32(lanes, first));
            let both = _mm256_blendv_epi8(high, low, _mm256_cmpgt_epi32(first, lanes));
            let none = _mm256_set1_epi32(i32::MIN);
            let filled = _mm256_cmpgt_epi32(_mm256_set1_epi32(count as i32), lanes);
            let sorted = sort_four(_mm256_blendv_epi8(none, both, filled));

            // A permutation takes the lane from the lowest three bits; the fourth, moved to the sign, chooses the half.
            let [low, high] = halves(items);
            let low = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(low, sorted));
            let high = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(high, sorted));
            let half = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(sorted));
            let items = _mm256_blendv_ps(low, high, half);
            _mm256_storeu_si256(stack_keys.as_mut_ptr().cast(), sorted);
            _mm256_storeu_ps(stack_items.as_mut_ptr().add(1).cast(), items);
        }
        (count, stack_items[count])
    }
}

/// What [`push_sorted`](Simd::push_sorted) does with more than eight pairs, out of its way.
#[cold]
#[inline(never)]
fn push_many(
    chosen: u32,
    keys: &[f32; 16],
    items: &[u32; 16],
    stack: (&mut [f32], &mut [u32]),
    top: usize,
) -> (usize, u32) {
    Portable.push_sorted(chosen, Portable.load16(keys), items, stack, top)
}

/// For each set of eight lanes, these in ascending order, a byte each.
static CHOSEN_LANES: [u64; 256] = {
    let mut table = [0; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if set >> lane & 1 == 1 {
                table[set] |= lane << (8 * count);
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    table
};

/// The lanes of a set in ascending order, and behind them lane 0; of the set only the lowest eight count.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn chosen_lanes(set: u32) -> __m256i {
    let lanes = CHOSEN_LANES[set as usize & 0xff];
    // SAFETY: the caller's.
    unsafe { _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(lanes as i64)) }
}

/// The lanes whose highest bit is set.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn lanes_of(v: __m256i) -> u32 {
    // SAFETY: the caller's.
    unsafe { _mm256_movemask_ps(_mm256_castsi256_ps(v)) as u32 }
}

/// Sixteen items in two registers.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn halves(items: &[u32; 16]) -> [__m256i; 2] {
    let start = items.as_ptr();
    // SAFETY: the caller's; there are sixteen.
    unsafe { [_mm256_loadu_si256(start.cast()), _mm256_loadu_si256(start.add(8).cast())] }
}

/// A step of a sorting network: lanes and their partners, the larger number to the lanes of `larger`.
macro_rules! exchange {
    ($v:ident, $partners:literal, $larger:literal) => {{
        let partners = _mm256_shuffle_epi32::<$partners>($v);
        let (small, large) = (_mm256_min_epi32($v, partners), _mm256_max_epi32($v, partners));
        $v = _mm256_blend_epi32::<$larger>(small, large);
    }};
}

/// Sorts each four lanes in descending order.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn sort_four(v: __m256i) -> __m256i {
    let mut v = v;
    // SAFETY: the caller's.
    unsafe {
        exchange!(v, 0b10_11_00_01, 0b1001_1001);
        exchange!(v, 0b01_00_11_10, 0b0011_0011);
        exchange!(v, 0b10_11_00_01, 0b0101_0101);
    }
    v
}
