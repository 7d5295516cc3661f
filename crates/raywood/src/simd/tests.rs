//! Every level against scalar arithmetic, to the bit.

use super::{BitPlaces, Float, Kernel, PLACES, Simd, SimdLevel, dispatch_on};

/// Numbers that tell operations apart: zeros of both signs, infinities, NaN, subnormal and usual ones.
const NUMBERS: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    1e-40,
    3.5,
    -7.25,
    1e30,
    -1e30,
    0.1,
    0.2,
    1e-30,
    16_777_217.0,
];

/// All results of all operations on a pair of vectors, as bits, all NaN alike.
struct Everything([f32; 16], [f32; 16]);

fn bits(numbers: impl IntoIterator<Item = f32>, all: &mut Vec<u32>) {
    all.extend(numbers.into_iter().map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() }));
}

impl Kernel for Everything {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Vec<u32> {
        let mut all = Vec::new();
        let (a, b) = (simd.load16(&self.0), simd.load16(&self.1));
        for vector in [a + b, a - b, a * b, a / b, a.smaller(b), a.larger(b), a.abs()] {
            bits(vector.to_array(), &mut all);
        }
        all.extend([a.less(b), a.less_or_equal(b), b.less(a)]);
        bits(a.replaced(0xA53C, b).to_array(), &mut all);
        let known = simd.splat16(0.0).larger(a).smaller(simd.splat16(1e6));
        bits([known.least(), known.greatest()], &mut all);
        bits(simd.splat16(self.0[5]).to_array(), &mut all);

        let half = |numbers: &[f32; 16]| *numbers.first_chunk::<8>().expect("eight of sixteen");
        let (a, b) = (simd.load8(&half(&self.0)), simd.load8(&half(&self.1)));
        for vector in [a + b, a - b, a * b, a / b, a.smaller(b), a.larger(b), a.abs()] {
            bits(vector.to_array(), &mut all);
        }
        bits(a.where_else(true, b).to_array(), &mut all);
        bits(a.where_else(false, b).to_array(), &mut all);
        all.extend([a.less(b), a.less_or_equal(b), b.less(a)]);
        bits(a.replaced(0x5C, b).to_array(), &mut all);
        bits(simd.permuted8(a, &[7, 0, 0, 5, 3, 6, 1, 2]).to_array(), &mut all);
        all.push(simd.signs8(simd.splat8(1.0).replaced(0x96, b)) & 0x69 | simd.signs8(a) & 0x3F);
        let known = simd.splat8(0.0).larger(a).smaller(simd.splat8(1e6));
        bits([known.least(), known.greatest()], &mut all);
        bits(simd.splat8(self.0[3]).to_array(), &mut all);
        simd.prefetch(self.0.as_ptr().cast());
        all
    }
}

/// The available levels.
fn levels() -> impl Iterator<Item = SimdLevel> {
    SimdLevel::ALL.iter().copied().filter(|level| level.is_available())
}

#[test]
fn all_levels_compute_the_same_to_the_bit() {
    for shift in 0..16 {
        let mut other = NUMBERS;
        other.rotate_left(shift);
        let expected = dispatch_on(SimdLevel::Portable, Everything(NUMBERS, other));
        for level in levels() {
            let found = dispatch_on(level, Everything(NUMBERS, other));
            assert_eq!(found, expected, "{}, shifted by {shift}", level.name());
        }
    }
}

#[test]
fn the_portable_level_is_scalar_arithmetic() {
    let mut other = NUMBERS;
    other.rotate_left(3);
    let found = dispatch_on(SimdLevel::Portable, Everything(NUMBERS, other));
    let mut expected = Vec::new();
    let pairs = || NUMBERS.into_iter().zip(other);
    bits(pairs().map(|(a, b)| a + b), &mut expected);
    bits(pairs().map(|(a, b)| a - b), &mut expected);
    bits(pairs().map(|(a, b)| a * b), &mut expected);
    bits(pairs().map(|(a, b)| a / b), &mut expected);
    bits(pairs().map(|(a, b)| if a < b { a } else { b }), &mut expected);
    bits(pairs().map(|(a, b)| if a > b { a } else { b }), &mut expected);
    bits(NUMBERS.map(f32::abs), &mut expected);
    let set = |holds: fn(f32, f32) -> bool| {
        pairs().enumerate().fold(0, |set, (lane, (a, b))| set | u32::from(holds(a, b)) << lane)
    };
    expected.extend([set(|a, b| a < b), set(|a, b| a <= b), set(|a, b| b < a)]);
    assert_eq!(found[..expected.len()], expected);
}

/// How many items are on a stack already.
const TOP: usize = 3;

/// Puts the chosen of sixteen keys onto a stack.
struct Sort(u32, [f32; 16]);

impl Kernel for Sort {
    type Output = Vec<(f32, u32)>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let items: [u32; 16] = std::array::from_fn(|lane| 100 + lane as u32);
        let (mut keys, mut sorted) = ([-1.0; 48], [7; 48]);
        let all = simd.load16(&self.1);
        let (count, last) = simd.push_sorted(self.0, all, &items, (&mut keys, &mut sorted), TOP);
        assert_eq!(last, sorted[TOP + count - 1]);
        assert_eq!(sorted[..TOP], [7; TOP]);
        keys.into_iter().zip(sorted).skip(TOP).take(count).collect()
    }
}

#[test]
fn sorting_keeps_every_chosen_pair_and_puts_large_keys_first() {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 8
    };
    for _ in 0..2000 {
        let keys: [f32; 16] = std::array::from_fn(|_| random() as f32 * 1e-3);
        let chosen = random() & random() & 0xffff;
        for level in levels() {
            let sorted = dispatch_on(level, Sort(chosen, keys));
            let mut lanes: Vec<_> = sorted.iter().map(|&(_, item)| item - 100).collect();
            // The lowest four bits of a key do not count.
            for &(key, item) in &sorted {
                let right = keys[item as usize - 100];
                assert!((key - right).abs() <= 2e-6 * right, "{}", level.name());
            }
            // Each four are in order; more of them would be a better heuristic, but sorted more slowly.
            let descends = |pair: &[(f32, u32)]| pair[0].0 >= pair[1].0 * (1.0 - 2e-6);
            let ordered = sorted.chunks(4).all(|four| four.windows(2).all(descends));
            assert!(ordered, "{}: {sorted:?}", level.name());
            lanes.sort_unstable();
            let expected: Vec<_> = (0..16).filter(|lane| chosen >> lane & 1 == 1).collect();
            assert_eq!(lanes, expected, "{}", level.name());
        }
    }
}

/// Puts the chosen of sixteen items onto a stack.
struct Choose(u32);

impl Kernel for Choose {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let items: [u32; 16] = std::array::from_fn(|lane| 100 + lane as u32);
        let mut stack = [7; 48];
        let (count, last) = simd.push_chosen(self.0, &items, &mut stack, TOP);
        assert_eq!(last, stack[TOP + count - 1]);
        assert_eq!(stack[..TOP], [7; TOP]);
        stack[TOP..TOP + count].to_vec()
    }
}

#[test]
fn choosing_keeps_order() {
    for chosen in [0, 1, 0x8000, 0x1234, 0xfffe, 0xffff] {
        let expected: Vec<_> =
            (0..16).filter(|lane| chosen >> lane & 1 == 1).map(|lane| lane + 100).collect();
        for level in levels() {
            assert_eq!(dispatch_on(level, Choose(chosen)), expected, "{}", level.name());
        }
    }
}

/// The least of the chosen numbers.
struct Least(u32, [f32; 8]);

impl Kernel for Least {
    type Output = (f32, u32);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> (f32, u32) {
        simd.least8(self.0, simd.load8(&self.1))
    }
}

#[test]
fn the_least_number_is_found_wherever_it_stands() {
    let numbers = [3.0, -2.0, 5.0, -2.0, f32::NAN, 0.0, 1.0, 3.0];
    let cases = [
        (0b0000_0000, (f32::INFINITY, 0)),
        (0b0000_0001, (3.0, 0b0000_0001)),
        (0b1000_0001, (3.0, 0b1000_0001)),
        (0b1110_1111, (-2.0, 0b0000_1010)),
        (0b0100_0100, (1.0, 0b0100_0000)),
    ];
    for level in levels() {
        for (chosen, expected) in cases {
            assert_eq!(dispatch_on(level, Least(chosen, numbers)), expected, "{}", level.name());
        }
    }
}

/// Keeps the pairs with small keys.
struct Retain(Vec<f32>, usize, f32);

impl Kernel for Retain {
    type Output = Vec<(f32, u32)>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self(mut keys, count, limit) = self;
        let mut items: Vec<u32> = (0..keys.len() as u32).collect();
        let kept = simd.retain(&mut keys, &mut items, count, limit);
        keys.into_iter().zip(items).take(kept).collect()
    }
}

#[test]
fn retaining_keeps_order_and_what_lies_within_the_limit() {
    let keys: Vec<f32> = (0..64).map(|place| ((place * 37) % 64) as f32).collect();
    for count in 0..=64 {
        for limit in [-1.0, 0.0, 20.0, 63.0, f32::INFINITY, f32::NAN] {
            let pairs = keys.iter().copied().zip(0..).take(count);
            let expected: Vec<_> = pairs.filter(|(key, _)| *key <= limit).collect();
            for level in levels() {
                let found = dispatch_on(level, Retain(keys.clone(), count, limit));
                assert_eq!(found, expected, "{}, {count} up to {limit}", level.name());
            }
        }
    }
}

/// Sorts numbers into lists.
struct Partition([u32; PLACES]);

impl Kernel for Partition {
    type Output = [Vec<u32>; 3];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let mut lists = [[u32::MAX; PLACES + 16]; 3];
        let counts = simd.partition(&self.0, u32::MAX - 2, u32::MAX, &mut lists);
        [0, 1, 2].map(|list| lists[list][..counts[list]].to_vec())
    }
}

#[test]
fn numbers_come_into_the_right_lists() {
    let mut state = 1u32;
    for round in 0..200 {
        let numbers: [u32; PLACES] = std::array::from_fn(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let special = [0, 1, u32::MAX, u32::MAX - 2, u32::MAX - 4, 1 << 31, (1 << 31) + 1];
            if round == 0 { 2 } else { *special.get(state as usize >> 28).unwrap_or(&(state >> 7)) }
        });
        let places = |belongs: fn(u32) -> bool| {
            let all = (0..PLACES as u32).filter(|&place| belongs(numbers[place as usize]));
            all.collect::<Vec<_>>()
        };
        let expected = [
            places(|n| n % 2 == 0),
            places(|n| n % 2 == 1 && n < u32::MAX - 2),
            places(|n| n == u32::MAX),
        ];
        for level in levels() {
            assert_eq!(dispatch_on(level, Partition(numbers)), expected, "{}", level.name());
        }
    }
}

#[test]
fn levels_have_names() {
    for &level in SimdLevel::ALL {
        assert_eq!(SimdLevel::from_name(level.name()), Some(level));
    }
    assert_eq!(SimdLevel::from_name("mmx"), None);
    assert!(SimdLevel::Portable.is_available() && SimdLevel::active().is_available());
}

/// Products with sums, by every level, of numbers that overflow nowhere.
struct MulAdd([f32; 16], [f32; 16], [f32; 16]);

impl Kernel for MulAdd {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Vec<f32> {
        let [a, b, c] = [&self.0, &self.1, &self.2].map(|numbers| simd.load16(numbers));
        let sixteen = a.mul_add(b, c).to_array();
        let half = |numbers: &[f32; 16]| *numbers.first_chunk::<8>().expect("eight of sixteen");
        let (a, b, c) = (half(&self.0), half(&self.1), half(&self.2));
        let (a, b, c) = (simd.load8(&a), simd.load8(&b), simd.load8(&c));
        let eight = a.mul_add(b, c).to_array();
        // Twice the other sign is the same number.
        let zero = simd.splat8(0.0);
        let negated = (zero - a).negated_mul_add(b, c).to_array();
        assert_eq!(negated, eight);
        assert_eq!(a.larger_magnitude(b).to_array(), a.abs().larger(b.abs()).to_array());
        sixteen.into_iter().chain(eight).collect()
    }
}

#[test]
fn a_product_with_a_sum_is_rounded_at_most_twice() {
    let numbers =
        |seed: u32| std::array::from_fn(|lane| (seed * 77 + lane as u32 * 13) as f32 * 0.37 - 20.0);
    let (a, b, c): ([f32; 16], [f32; 16], [f32; 16]) = (numbers(1), numbers(2), numbers(3));
    for level in levels() {
        let found = dispatch_on(level, MulAdd(a, b, c));
        for (place, found) in found.into_iter().enumerate() {
            let lane = place % 16;
            let product = f64::from(a[lane]) * f64::from(b[lane]);
            let error = (f64::from(found) - (product + f64::from(c[lane]))).abs();
            let bound = f64::from(f32::EPSILON) * (product.abs() + f64::from(c[lane]).abs());
            assert!(error <= bound, "{} at {place}: off by {error}", level.name());
        }
    }
}

/// The columns of sixteen rows.
struct Columns([[f32; 8]; 16]);

impl Kernel for Columns {
    type Output = Vec<Vec<f32>>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        simd.columns(&self.0).into_iter().map(|column| column.to_array().to_vec()).collect()
    }
}

#[test]
fn columns_are_rows_turned() {
    let rows = std::array::from_fn(|row| std::array::from_fn(|column| (10 * row + column) as f32));
    for level in levels() {
        for (column, numbers) in dispatch_on(level, Columns(rows)).into_iter().enumerate() {
            let expected: Vec<f32> = rows.iter().map(|row| row[column]).collect();
            assert_eq!(numbers, expected, "{}, column {column}", level.name());
        }
    }
}

/// The whole parts of sixteen numbers, and their bits in other places.
struct Whole<'a>([f32; 16], &'a BitPlaces);

impl Kernel for Whole<'_> {
    type Output = ([u32; 16], [u64; 16]);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let whole = simd.whole_numbers(simd.load16(&self.0));
        (whole, whole.map(|number| simd.spread_bits(number, self.1)))
    }
}

#[test]
fn bits_of_whole_parts_go_where_the_mask_has_bits() {
    let mut state = 9u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        state >> 20
    };
    for round in 0..200 {
        // At most sixteen places, in the end none.
        let mut mask = random() << 20 | random();
        while mask.count_ones() > 16_u32.saturating_sub(round / 10) {
            mask &= mask - 1;
        }
        let places = BitPlaces::new(mask);
        let numbers: [f32; 16] = std::array::from_fn(|lane| match lane {
            0 => 0.0,
            1 => 65535.0,
            2 => 0.999_999_9,
            _ => (random() % (1 << 22)) as f32 / 64.0,
        });
        for level in levels() {
            let (whole, spread) = dispatch_on(level, Whole(numbers, &places));
            for lane in 0..16 {
                let expected = numbers[lane].floor() as u32;
                assert_eq!(whole[lane], expected, "{}, {numbers:?}", level.name());
                let (mut left, mut bits) = (mask, 0);
                for bit in 0..mask.count_ones() {
                    bits |= u64::from(expected >> bit & 1) << left.trailing_zeros();
                    left &= left - 1;
                }
                assert_eq!(spread[lane], bits, "{}, {mask:x} {expected}", level.name());
            }
        }
    }
}

/// The least and the greatest number of each of sixteen rows.
struct OfRows([[f32; 16]; 16]);

impl Kernel for OfRows {
    type Output = [[f32; 16]; 2];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        [simd.least_of_rows(&self.0).to_array(), simd.greatest_of_rows(&self.0).to_array()]
    }
}

#[test]
fn rows_are_folded_each_to_its_own_lane() {
    // Every place of a row once holds its least number, and once its greatest.
    for shift in 0..16 {
        let rows: [[f32; 16]; 16] = std::array::from_fn(|row| {
            std::array::from_fn(|place| (100 * row + (place + shift + row) % 16) as f32)
        });
        for level in levels() {
            let [least, greatest] = dispatch_on(level, OfRows(rows));
            let expected = std::array::from_fn(|row| (100 * row) as f32);
            assert_eq!(least, expected, "{}", level.name());
            assert_eq!(greatest, expected.map(|least| least + 15.0), "{}", level.name());
        }
    }
}
