//! The order of primitives along a space-filling curve.

use super::driver::{Around, around_all};
use super::morton::{Morton, NUMBER_BITS};
use super::radix_sort::sort_above;
use super::{PackedAabb, Work};
use crate::{BuildError, Geometry, parallel};

/// All primitives along the curve: for each the code of its centre, and its number; and what is around all, whose bounds are checked. O(n), in parallel, the same
/// for any number of threads.
pub(super) fn sorted_keys<G: Geometry>(
    geometry: &G,
    work: Work<'_>,
) -> Result<(Vec<u64>, Around), BuildError> {
    let [bounding, encoding, sorting] = work.shares([1.0, 2.0, 1.5]);
    let around = around_all(geometry, bounding)?;
    if geometry.is_empty() {
        return Ok((Vec::new(), around));
    }
    let morton = Morton::new(&around.centers);
    let key = |primitive: usize| key(geometry, &morton, primitive as u32);
    let mut keys = parallel::map_watched(geometry.len(), encoding, key)?;
    sort_above(NUMBER_BITS, &mut keys, sorting)?;
    Ok((keys, around))
}

/// The code of a primitive's centre, and its number.
#[inline(always)]
pub(super) fn key<G: Geometry>(geometry: &G, morton: &Morton, primitive: u32) -> u64 {
    morton.key(PackedAabb::from(geometry.bounds(primitive)).center(), primitive)
}
