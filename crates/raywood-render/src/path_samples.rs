//! The random numbers of a path: for each decision a pair that is well spread over the samples of a pixel.
//!
//! Every decision has a (0,2)-sequence of its own, the first two dimensions of Sobol's, whose points come in another order and are scrambled
//! in another way: padding by shuffled sequences as in Burley, "Practical Hash-based Owen Scrambling", JCGT 2020.

use crate::sampling::{mix, owen_scramble_reversed};

/// The numbers of one path: of one of the samples of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathSamples {
    pixel: u32,
    index: u32,
}

impl PathSamples {
    /// Where on the lens a path begins. No path meets as many surfaces that they had this number.
    pub(crate) const LENS: u32 = u32::MAX;

    /// When it begins. Nor this one.
    pub(crate) const SHUTTER: u32 = u32::MAX - 1;

    /// Path `index` of the pixel in column `x` and row `y`, for seed 0.
    #[cfg(test)]
    pub(crate) fn new(place: [u32; 2], index: u32) -> Self {
        Self::seeded(place, index, 0)
    }

    /// Path `index` of the pixel in column `x` and row `y`. Another seed has other numbers.
    #[inline(always)]
    pub(crate) fn seeded([x, y]: [u32; 2], index: u32, seed: u32) -> Self {
        Self { pixel: mix(x ^ mix(y ^ 0x85eb_ca6b ^ mix(seed))), index }
    }

    /// The numbers of decision `decision`, both at least 0 and below 1. Without branches and calls, so that a loop over many paths becomes vectors.
    #[inline(always)]
    pub(crate) fn pair(self, decision: u32) -> [f32; 2] {
        let seed = mix(self.pixel ^ decision.wrapping_mul(0x9e37_79b9));
        // Scrambling shuffles the index: any first 2^k become 2^k others that follow each other.
        let backwards = self.index.reverse_bits();
        let shuffled = owen_scramble_reversed(backwards, seed).reverse_bits();
        let number = |bits: u32, salt: u32| {
            let bits = owen_scramble_reversed(bits, mix(seed ^ salt)).reverse_bits();
            // 24 bits fit a float exactly, and a signed number, which has a vector instruction on every processor.
            (bits >> 8) as i32 as f32 * (1.0 / 16_777_216.0)
        };
        [number(shuffled, 0x68bc_21eb), number(sobol_second_reversed(shuffled), 0x02e5_be93)]
    }
}

/// The second dimension of Sobol's sequence, bits reversed: a product with Pascal's triangle modulo two, which has a pattern of halves in halves.
#[inline(always)]
fn sobol_second_reversed(index: u32) -> u32 {
    let mut v = index;
    v ^= v >> 16;
    v ^= (v & 0xff00_ff00) >> 8;
    v ^= (v & 0xf0f0_f0f0) >> 4;
    v ^= (v & 0xcccc_cccc) >> 2;
    v ^ ((v & 0xaaaa_aaaa) >> 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every box shape of 2^k boxes holds one each of the first 2^k pairs of any decision.
    #[test]
    fn the_pairs_of_a_decision_are_stratified() {
        for (pixel, decision) in [([0, 0], 0), ([5, 9], 1), ([637, 211], 40)] {
            for k in 0..=8 {
                for columns_log2 in 0..=k {
                    let (columns, rows) = (1 << columns_log2, 1 << (k - columns_log2));
                    let mut seen = vec![false; columns * rows];
                    for index in 0..1 << k {
                        let [u, v] = PathSamples::new(pixel, index).pair(decision);
                        assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v));
                        let place =
                            (v * rows as f32) as usize * columns + (u * columns as f32) as usize;
                        assert!(!seen[place], "two pairs in a box of {columns} x {rows}");
                        seen[place] = true;
                    }
                }
            }
        }
    }

    /// Numbers of different decisions, and of different pixels, have nothing to do with each other.
    #[test]
    fn decisions_and_pixels_are_not_correlated() {
        let correlation = |first: &dyn Fn(u32) -> f32, second: &dyn Fn(u32) -> f32| {
            let product = |i| (first(i) - 0.5) * (second(i) - 0.5);
            12.0 * (0..4096).map(product).sum::<f32>() / 4096.0
        };
        let number = |pixel, decision: u32, axis: usize| {
            move |index| PathSamples::new(pixel, index).pair(decision)[axis]
        };
        for (a, b) in [
            (number([3, 4], 0, 0), number([3, 4], 1, 0)),
            (number([3, 4], 0, 1), number([3, 4], 7, 0)),
            (number([3, 4], 2, 0), number([3, 4], 2, 1)),
            (number([3, 4], 2, 0), number([4, 4], 2, 0)),
        ] {
            let found = correlation(&a, &b);
            assert!(found.abs() < 0.05, "a correlation of {found}");
        }
    }
}
