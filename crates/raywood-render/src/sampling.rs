//! Where in and around a pixel its rays go: Owen-scrambled Sobol points, spread by a filter.
//!
//! The points of a pixel are the first two dimensions of Sobol's sequence (1967), a (0,2)-sequence: any first 2^k of
//! them put one point into each of the 2^k boxes of every shape that halving makes. Each pixel scrambles them in its
//! own way, which keeps that property and takes the structure out (Owen 1995), by the hash of Laine and Karras
//! (2011) as refined in Burley, "Practical Hash-based Owen Scrambling", JCGT 2020.

use crate::pixel_filter::PixelFilter;

/// The points of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSamples {
    samples: u32,
    filter: PixelFilter,
    seeds: [u32; 2],
    /// The bits of a coordinate that the number of samples can fill, as a mask, and half of the last of them.
    filled: u32,
    half: u32,
}

impl PixelSamples {
    /// The points of the pixel in column `x` and row `y`, `samples` of them, for the filter of usual pictures and seed 0.
    #[inline]
    pub fn new(x: u32, y: u32, samples: u32) -> Self {
        Self::spread([x, y], samples, PixelFilter::default(), 0)
    }

    /// The points of the pixel in a column and a row, `samples` of them, for a filter. Another seed scrambles them in another way.
    #[inline]
    pub fn spread([x, y]: [u32; 2], samples: u32, filter: PixelFilter, seed: u32) -> Self {
        let pixel = mix(x ^ mix(y ^ 0x5bd1_e995 ^ mix(seed)));
        let seeds = [mix(pixel ^ 0x68bc_21eb), mix(pixel ^ 0x02e5_be93)];
        let half = (1 << 31) >> samples.next_power_of_two().trailing_zeros();
        Self { samples, filter, seeds, filled: !(half | (half - 1)), half }
    }

    /// Point `index` in the unit square, both coordinates at least 0 and below 1.
    ///
    /// Each coordinate lies in the middle of its stratum: where upright and level edges cross a pixel, every pixel
    /// along the edge then counts the same number of points on either side, and the edge is not ragged.
    #[inline]
    pub fn unit_square(&self, index: u32) -> [f32; 2] {
        let point = self.point(index);
        [0, 1].map(|dimension| point.coordinate(dimension, self.seeds[dimension]))
    }

    /// The offset of ray `index` from the pixel's centre, in pixels.
    ///
    /// Of a single ray it is zero. More are spread like the filter.
    #[inline]
    pub fn offset(&self, index: u32) -> [f32; 2] {
        let point = self.point(index);
        [0, 1].map(|dimension| point.offset(self.filter, dimension, self.seeds[dimension]))
    }

    /// How the points are spread.
    #[inline(always)]
    pub(crate) fn filter(&self) -> PixelFilter {
        self.filter
    }

    /// What tells this pixel from others.
    #[inline(always)]
    pub(crate) fn seeds(&self) -> [u32; 2] {
        self.seeds
    }

    /// Point `index` before it is scrambled: the same for all pixels that have as many.
    #[inline]
    pub(crate) fn point(&self, index: u32) -> UnscrambledPoint {
        UnscrambledPoint {
            bits: [index, sobol_second(index).reverse_bits()],
            is_single: self.samples <= 1,
            filled: self.filled,
            half: self.half,
        }
    }
}

/// A point of the sequence as it is before a pixel scrambles it.
#[derive(Clone, Copy)]
pub(crate) struct UnscrambledPoint {
    /// The coordinates, bits reversed.
    bits: [u32; 2],
    /// Whether it is the only one of its pixel.
    is_single: bool,
    filled: u32,
    half: u32,
}

impl UnscrambledPoint {
    /// A coordinate in the unit square in the pixel that has this seed.
    #[inline(always)]
    fn coordinate(&self, dimension: usize, seed: u32) -> f32 {
        let bits = owen_scramble_reversed(self.bits[dimension], seed);
        let middle = (bits.reverse_bits() & self.filled) | self.half;
        // The bits, most significant first, as a fraction; 24 of them fit a float exactly.
        (middle >> 8) as i32 as f32 * (1.0 / 16_777_216.0)
    }

    /// A coordinate of the offset from the centre of the pixel that has this seed.
    #[inline(always)]
    pub(crate) fn offset(&self, filter: PixelFilter, dimension: usize, seed: u32) -> f32 {
        let offset = filter.offset(self.coordinate(dimension, seed));
        if self.is_single { 0.0 } else { offset }
    }
}

/// The second dimension of Sobol's sequence as a binary fraction. Its direction numbers are the rows of Pascal's
/// triangle modulo two, each made from the last by `v ^ (v >> 1)`. (The first dimension is the index, bits reversed.)
#[inline]
fn sobol_second(index: u32) -> u32 {
    let (mut bits, mut result, mut direction) = (index, 0, 1 << 31);
    while bits != 0 {
        if bits & 1 != 0 {
            result ^= direction;
        }
        direction ^= direction >> 1;
        bits >>= 1;
    }
    result
}

/// Flips each bit as a hash of the seed and of the bits below it says: Owen's scrambling for a fraction whose bits are
/// reversed, where multiplications carry upwards only (Laine and Karras 2011).
#[inline(always)]
pub(crate) fn owen_scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x
}

/// A hash in which every input bit reaches every output bit (the finalizer of MurmurHash3).
#[inline(always)]
pub(crate) fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x85eb_ca6b);
    x ^= x >> 13;
    x = x.wrapping_mul(0xc2b2_ae35);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every box shape of 2^k boxes holds one each of the first 2^k points.
    #[test]
    fn points_are_stratified_in_every_shape_of_box() {
        for (x, y) in [(0, 0), (1, 0), (0, 1), (637, 211), (u32::MAX, 5)] {
            for k in 0..=8 {
                let samples = PixelSamples::new(x, y, 1 << k);
                for columns_log2 in 0..=k {
                    let (columns, rows) = (1 << columns_log2, 1 << (k - columns_log2));
                    let mut seen = vec![false; columns * rows];
                    for index in 0..1 << k {
                        let [u, v] = samples.unit_square(index);
                        assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v));
                        let place =
                            (v * rows as f32) as usize * columns + (u * columns as f32) as usize;
                        assert!(!seen[place], "two points in a box of {columns} x {rows}");
                        seen[place] = true;
                    }
                }
            }
        }
    }

    #[test]
    fn coordinates_are_the_middles_of_their_strata_in_every_pixel() {
        for pixel in 0..50 {
            for axis in [0, 1] {
                let samples = PixelSamples::new(pixel, 7 * pixel, 8);
                let mut eighths: Vec<f32> =
                    (0..8).map(|index| 8.0 * samples.unit_square(index)[axis]).collect();
                eighths.sort_unstable_by(f32::total_cmp);
                assert_eq!(eighths, [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5]);
            }
        }
        // The most samples that anyone may ask for, and an odd number.
        for samples in [3, 1 << 20] {
            let [u, v] = PixelSamples::new(1, 2, samples).unit_square(samples - 1);
            assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v));
        }
    }

    #[test]
    fn one_sample_is_the_pixels_centre() {
        assert_eq!(PixelSamples::new(3, 4, 1).offset(0), [0.0, 0.0]);
    }

    #[test]
    fn pixels_differ_and_each_is_repeatable() {
        let first = PixelSamples::new(3, 4, 16).unit_square(5);
        assert_eq!(first, PixelSamples::new(3, 4, 16).unit_square(5));
        assert_ne!(first, PixelSamples::new(4, 3, 16).unit_square(5));
        assert_ne!(first, PixelSamples::new(3, 5, 16).unit_square(5));
        let seeded = |seed| PixelSamples::spread([3, 4], 16, PixelFilter::Tent, seed);
        assert_eq!(first, seeded(0).unit_square(5));
        assert_ne!(first, seeded(1).unit_square(5));
    }

    /// The mean and variance of a tent from -1 to 1 are 0 and 1/6.
    #[test]
    fn offsets_follow_the_tent() {
        let samples = PixelSamples::new(10, 20, 4096);
        for axis in [0, 1] {
            let offsets = (0..4096).map(|index| f64::from(samples.offset(index)[axis]));
            let (mut sum, mut squares) = (0.0, 0.0);
            for offset in offsets {
                assert!((-1.0..=1.0).contains(&offset));
                sum += offset;
                squares += offset * offset;
            }
            assert!((sum / 4096.0).abs() < 1e-3);
            assert!((squares / 4096.0 - 1.0 / 6.0).abs() < 1e-3);
        }
    }
}
