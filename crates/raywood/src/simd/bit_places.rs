//! Where the bits of a number go in a longer one.

/// How many bits a half of the number has.
const HALF_BITS: u32 = 8;

/// How many values a half has.
const HALF: usize = 1 << HALF_BITS;

/// The places that the sixteen lowest bits of a number get, the lowest first.
pub(crate) struct BitPlaces {
    /// The places, as bits that are set.
    #[cfg_attr(
        not(target_arch = "x86_64"),
        expect(dead_code, reason = "only one level has an instruction")
    )]
    pub(super) mask: u64,
    /// For processors without a fast instruction: what the values of the lower half become, and those of the upper.
    spread: [[u64; HALF]; 2],
}

impl BitPlaces {
    /// As many bits as it has places.
    pub(crate) const MOST: u32 = 2 * HALF_BITS;

    /// The places that are set in a mask, [`MOST`](Self::MOST) at most.
    pub(crate) fn new(mask: u64) -> Self {
        debug_assert!(mask.count_ones() <= Self::MOST);
        let mut spread = [[0; HALF]; 2];
        let mut rest = mask;
        for bit in 0..Self::MOST {
            let half = &mut spread[(bit / HALF_BITS) as usize];
            // Values with this bit, of which it is the highest, are those without it once more.
            let (without, with) = half.split_at_mut(1 << (bit % HALF_BITS));
            for (value, without) in with.iter_mut().zip(without) {
                *value = *without | rest & rest.wrapping_neg();
            }
            rest &= rest.wrapping_sub(1);
        }
        Self { mask, spread }
    }

    /// The number with its bits in their places.
    #[inline(always)]
    pub(super) fn look_up(&self, number: u32) -> u64 {
        let [low, high] = &self.spread;
        low[number as usize % HALF] | high[number as usize / HALF % HALF]
    }
}
