//! The order of primitives along a space-filling curve.

use super::driver::Around;
use super::encode::Encoder;
use super::morton::{FAR, KeyBits, Morton};
use super::radix_sort::sort_above;
use super::{PackedAabb, Work};
use crate::simd::huge_pages;
use crate::{BuildError, Geometry};

/// So many primitives, from the first to the last, tell beforehand where about all centres lie.
const SAMPLES: usize = 4096;

/// One of so many primitives may lie outside of where they were expected. What is near falls into the cells at the sides; for what is far a curve of its own follows on that
/// of all others.
const FEW_OUTSIDE: usize = 128;

/// All primitives along the curve.
pub(crate) struct SortedKeys {
    /// For each the code of its centre, and its number.
    pub(crate) keys: Vec<u64>,
    /// How the bits of keys are divided.
    pub(crate) bits: KeyBits,
    /// What is around all.
    pub(crate) around: Around,
}

/// By how much of their codes keys are sorted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// By the first 32 bits, which takes three quarters of the time: what these cannot tell apart is in no order.
    Coarse,
    /// By all bits.
    Full,
}

/// Finds the order of primitives along the curve, and checks their bounds. O(n), in parallel, the same for any number of threads.
pub(crate) fn sorted_keys<G: Geometry>(
    geometry: &G,
    precision: Precision,
    work: Work<'_>,
) -> Result<SortedKeys, BuildError> {
    let primitives = geometry.len();
    if primitives > BuildError::MAX_PRIMITIVES {
        return Err(BuildError::TooManyPrimitives { primitives });
    }
    if primitives == 0 {
        let bits = KeyBits::for_primitives(0);
        return Ok(SortedKeys { keys: Vec::new(), bits, around: Around::NOTHING });
    }
    let bits = KeyBits::for_primitives(primitives);
    let [encoding, encoding_anew, sorting] = work.shares([2.0, 1.0, 1.5]);
    let mut keys = huge_pages::zeros(primitives);
    // Codes count cells of a box around nearly all centres. Most scenes need not be looked at twice, for a few primitives tell where that lies; and where it leaves
    // out what is far away, such as the ground around a house, cells are finer.
    let encoder = Encoder::for_centers_in(expected_centers(geometry), geometry, bits);
    let seen = encoder.encode(&mut keys, encoding)?;
    if let Some(primitive) = seen.first_bad {
        let bounds = geometry.bounds(primitive);
        return Err(BuildError::BadBounds { primitive, bounds });
    }
    let are_few = seen.outside <= primitives / FEW_OUTSIDE;
    if are_few {
        encoding_anew.done()?;
    } else {
        Encoder::for_centers_in(seen.around.centers, geometry, bits)
            .encode(&mut keys, encoding_anew)?;
    }
    let unsorted = match precision {
        Precision::Coarse => bits.below_coarse_code(),
        Precision::Full => bits.below_code(),
    };
    sort_above(unsorted, &mut keys, sorting)?;
    if are_few {
        let near = keys.len() - seen.far;
        order_far(geometry, bits, &mut keys[near..]);
    }
    Ok(SortedKeys { keys, bits, around: seen.around })
}

/// Orders the primitives that lie far outside along a curve of their own.
fn order_far<G: Geometry>(geometry: &G, bits: KeyBits, keys: &mut [u64]) {
    if keys.is_empty() {
        return;
    }
    let center = |key: u64| PackedAabb::from(geometry.bounds(bits.number(key))).center();
    let centers =
        keys.iter().map(|&key| center(key)).fold(PackedAabb::EMPTY, PackedAabb::including);
    let morton = Morton::new(&centers, bits);
    for key in &mut *keys {
        *key = FAR | morton.key(center(*key), bits.number(*key));
    }
    keys.sort_unstable();
}

/// About where all centres lie.
fn expected_centers<G: Geometry>(geometry: &G) -> PackedAabb {
    let primitives = geometry.len();
    let samples = primitives.min(SAMPLES);
    let centers = (0..samples).map(|sample| {
        let bounds = geometry.bounds((sample * primitives / samples) as u32);
        PackedAabb::from(bounds).center()
    });
    centers.fold(PackedAabb::EMPTY, PackedAabb::including)
}
