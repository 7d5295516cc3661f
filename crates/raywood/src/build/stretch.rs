//! Primitives side by side on a space-filling curve, and where they are divided: where the curve turns. Lauterbach et al., "Fast BVH Construction on GPUs", Eurographics 2009;
//! Karras, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", HPG 2012. Where codes cannot tell primitives apart, they get codes of their own.

use super::driver::must_halve;
use super::morton::{KeyBits, Morton};
use super::radix_sort::{sort_above, sort_slice_above};
use super::{Cancelled, PackedAabb, Work};
use crate::{Geometry, parallel};

/// Some primitives side by side on the curve, from which a subtree is made.
pub(crate) struct Stretch<'a> {
    /// Their codes and numbers, in ascending order as far as `order` says.
    keys: &'a mut [u64],
    bits: KeyBits,
    /// Where they start in the array of all.
    first: usize,
    /// The level of their node, from 1.
    depth: u32,
    order: Order,
}

/// How keys are sorted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    /// By the first 32 bits of their codes.
    Coarse,
    /// By all bits.
    Full,
    /// No code can tell the primitives apart: their centres are in one place.
    Alike,
}

impl<'a> Stretch<'a> {
    /// All primitives, sorted by the first bits of their codes at least.
    pub(crate) fn all(keys: &'a mut [u64], bits: KeyBits) -> Self {
        Self { keys, bits, first: 0, depth: 1, order: Order::Coarse }
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

    /// The same primitives, for a while.
    pub(crate) fn reborrowed(&mut self) -> Stretch<'_> {
        Stretch { keys: &mut *self.keys, ..*self }
    }

    /// Divides it where the highest bit changes in which codes differ; in the middle where the tree might else become too deep, or where no code can tell the
    /// primitives apart. There must be two of them.
    #[inline(always)]
    pub(crate) fn split<G: Geometry>(self, geometry: &G, work: Work<'_>) -> (Self, Self) {
        let Self { keys, bits, first, depth, mut order } = self;
        let count = keys.len();
        let must_halve = must_halve(count, depth as usize);
        let same = bits.same_coarse_code(keys[0], keys[count - 1]);
        if same && !must_halve && order != Order::Alike {
            // Of a build that is stopped no order matters.
            order = tell_apart(geometry, keys, bits, order, work).unwrap_or(order);
        }
        let left_count = match must_halve || order == Order::Alike {
            true => count / 2,
            false => {
                let differing = keys[0] ^ keys[count - 1];
                let prefix = keys[count - 1] & !(u64::MAX >> 1 >> differing.leading_zeros());
                keys.partition_point(|key| *key < prefix)
            }
        };
        let (left, right) = keys.split_at_mut(left_count);
        let depth = depth + 1;
        (
            Self { keys: left, bits, first, depth, order },
            Self { keys: right, bits, first: first + left_count, depth, order },
        )
    }
}

/// Sorts keys of which the first 32 bits of the codes are the same by the others, if they are not yet, and if these are the same too, by codes of their own. Says how they are sorted
/// then.
#[cold]
#[inline(never)]
fn tell_apart<G: Geometry>(
    geometry: &G,
    keys: &mut [u64],
    bits: KeyBits,
    mut order: Order,
    work: Work<'_>,
) -> Result<Order, Cancelled> {
    let last = keys.len() - 1;
    if order == Order::Coarse {
        sort_slice_above(bits.below_code(), keys, work.without_progress())?;
        order = Order::Full;
    }
    if bits.same_code(keys[0], keys[last]) {
        order = encode_anew(geometry, keys, bits, work)?;
    }
    Ok(order)
}

/// Gives primitives whose codes are the same new ones, which tell them apart if that can be done, and sorts them.
#[inline(never)]
fn encode_anew<G: Geometry>(
    geometry: &G,
    keys: &mut [u64],
    bits: KeyBits,
    work: Work<'_>,
) -> Result<Order, Cancelled> {
    let center = |primitive| PackedAabb::from(geometry.bounds(primitive)).center();
    let around = |centers: &mut PackedAabb, place: usize| {
        *centers = centers.including(center(bits.number(keys[place])));
    };
    let (count, work) = (keys.len(), work.without_progress());
    let nothing = PackedAabb::EMPTY;
    let centers = parallel::fold_numbers(count, work, nothing, around, PackedAabb::grow)?;
    let morton = Morton::new(&centers, bits);
    let key = |place: usize| {
        let number = bits.number(keys[place]);
        morton.key(center(number), number)
    };
    let mut sorted = parallel::map_watched(count, work, key)?;
    sort_above(bits.below_code(), &mut sorted, work)?;
    keys.copy_from_slice(&sorted);
    match bits.same_code(keys[0], keys[count - 1]) {
        true => Ok(Order::Alike),
        false => Ok(Order::Full),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{Precision, SortedKeys, sorted_keys};
    use crate::{Spheres, Vec3};

    /// How often halves have been told apart by the rest of their codes, or by new ones, and not at all.
    #[derive(Default)]
    struct Told {
        by_rest: usize,
        not: usize,
    }

    /// Divides everything down to single primitives. What lies left must come first along the curve.
    fn divide(geometry: &Spheres, stretch: Stretch<'_>, told: &mut Told) {
        if stretch.len() < 2 {
            return;
        }
        let before = stretch.order;
        let (left, right) = stretch.split(geometry, Work::UNWATCHED);
        let last_left = left.keys.iter().max().expect("something lies left");
        let first_right = right.keys.iter().min().expect("something lies right");
        assert!(last_left < first_right);
        told.by_rest += usize::from(before == Order::Coarse && left.order == Order::Full);
        told.not += usize::from(before != Order::Alike && left.order == Order::Alike);
        divide(geometry, left, told);
        divide(geometry, right, told);
    }

    #[test]
    fn crowds_are_divided_in_order() {
        // Cells of the first 32 bits are about a thousandth of the scene long, and those of all bits a hundredth of that.
        let mut state = 3u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let mut spheres = vec![(Vec3::ZERO, 0.1), (Vec3::splat(1.0), 0.1)];
        for (size, count) in [(1e-3, 3000), (1e-5, 500), (1e-7, 200), (0.0, 100)] {
            let corner = Vec3::new(random(), random(), random());
            let mut point = || corner + size * Vec3::new(random(), random(), random());
            spheres.extend((0..count).map(|_| (point(), 1e-4)));
        }
        let spheres = Spheres::new(spheres).expect("finite spheres");
        let sorted = sorted_keys(&spheres, Precision::Coarse, Work::UNWATCHED);
        let SortedKeys { mut keys, bits, .. } =
            sorted.unwrap_or_else(|_| panic!("nobody stops it"));
        let mut told = Told::default();
        divide(&spheres, Stretch::all(&mut keys, bits), &mut told);
        assert!(told.by_rest > 10 && told.not > 0, "{} {}", told.by_rest, told.not);
        let mut numbers: Vec<_> = keys.iter().map(|&key| bits.number(key)).collect();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..keys.len() as u32));
    }
}
