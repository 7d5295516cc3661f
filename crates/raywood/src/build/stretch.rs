//! Primitives side by side on a space-filling curve, and where they are divided: where the curve turns. Lauterbach et al., "Fast BVH Construction on GPUs", Eurographics 2009;
//! Karras, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", HPG 2012. Where codes cannot tell primitives apart, they get codes of their own.

use super::curve::key;
use super::driver::must_halve;
use super::morton::{Morton, NUMBER_BITS, number, same_code};
use super::radix_sort::sort_above;
use super::{Cancelled, PackedAabb, Work};
use crate::{Geometry, parallel};

/// Some primitives side by side on the curve, from which a subtree is made.
pub(crate) struct Stretch<'a> {
    /// Their codes and numbers, in ascending order.
    keys: &'a mut [u64],
    /// Where they start in the array of all.
    first: usize,
    /// The level of their node, from 1.
    depth: usize,
    /// Whether no code can tell them apart: their centres are in one place.
    alike: bool,
    /// What building their subtree is of the whole build.
    work: Work<'a>,
}

impl<'a> Stretch<'a> {
    /// All primitives.
    pub(crate) fn all(keys: &'a mut [u64], work: Work<'a>) -> Self {
        Self { keys, first: 0, depth: 1, alike: false, work }
    }

    /// How many primitives there are.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.keys.len()
    }

    /// Where they start in the array of all.
    pub(crate) fn first(&self) -> usize {
        self.first
    }

    /// Their codes and numbers.
    pub(crate) fn keys(&self) -> &[u64] {
        self.keys
    }

    /// What building their subtree is of the whole build.
    pub(crate) fn work(&self) -> Work<'a> {
        self.work
    }

    /// The same primitives, of which nobody is told how far they are.
    pub(crate) fn unwatched(&mut self) -> Stretch<'_> {
        Stretch { keys: &mut *self.keys, work: Work::UNWATCHED, ..*self }
    }

    /// Divides it where the highest bit changes in which codes differ; in the middle where the tree might else become too deep, or where no code can tell the
    /// primitives apart. There must be two of them.
    pub(crate) fn split<G: Geometry>(self, geometry: &G) -> (Self, Self) {
        let Self { keys, first, depth, mut alike, work } = self;
        let count = keys.len();
        let halve = alike || must_halve(count, depth);
        if !halve && same_code(keys[0], keys[count - 1]) {
            // Of a build that is stopped it does not matter.
            alike = !encode_anew(geometry, keys, work).unwrap_or(false);
        }
        let left_count = match halve || alike {
            true => count / 2,
            false => {
                let differing = keys[0] ^ keys[count - 1];
                let prefix = keys[count - 1] & !(u64::MAX >> 1 >> differing.leading_zeros());
                keys.partition_point(|key| *key < prefix)
            }
        };
        let (left, right) = keys.split_at_mut(left_count);
        let depth = depth + 1;
        let [left_work, right_work] = work.shares([left.len() as f64, right.len() as f64]);
        (
            Self { keys: left, first, depth, alike, work: left_work },
            Self { keys: right, first: first + left_count, depth, alike, work: right_work },
        )
    }
}

/// Gives primitives whose codes are the same new ones, which tell them apart, and sorts them. Says whether that can be done.
#[inline(never)]
fn encode_anew<G: Geometry>(
    geometry: &G,
    keys: &mut [u64],
    work: Work<'_>,
) -> Result<bool, Cancelled> {
    let around = |centers: &mut PackedAabb, place: usize| {
        let bounds = PackedAabb::from(geometry.bounds(number(keys[place])));
        *centers = centers.including(bounds.center());
    };
    let (count, work) = (keys.len(), work.without_progress());
    let nothing = PackedAabb::EMPTY;
    let centers = parallel::fold_numbers(count, work, nothing, around, PackedAabb::grow)?;
    let morton = Morton::new(&centers);
    let key = |place: usize| key(geometry, &morton, number(keys[place]));
    let mut sorted = parallel::map_watched(count, work, key)?;
    sort_above(NUMBER_BITS, &mut sorted, work)?;
    keys.copy_from_slice(&sorted);
    Ok(!same_code(keys[0], keys[count - 1]))
}
