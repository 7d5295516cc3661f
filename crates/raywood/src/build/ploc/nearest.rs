//! The search for the nearest neighbour of each cluster along the curve.

use super::clusters::Cluster;
use crate::build::{Cancelled, Work};
use crate::simd::{Float, Kernel, Simd, dispatch_on};
use crate::{SimdLevel, parallel};

/// How far along the curve neighbours are looked for: what is within this distance fits a vector together with the cluster itself.
const RADIUS: usize = 7;

/// How many clusters before one its vector begins: the first lane is not asked.
const BEFORE: usize = RADIUS + 1;

/// The lanes of a vector that hold neighbours: those behind, and from the tenth on those ahead.
const NEIGHBOURS: u32 = 0b1111_1110_1111_1110;

/// How many lanes a vector has.
const LANES: usize = 16;

/// A thread looks for the neighbours of so many clusters at a time.
const PIECE: usize = 1 << 12;

/// Of so many clusters the boxes are kept by coordinate, which fits the innermost cache.
const BLOCK: usize = 256;

/// The boxes of a block and of what is within the radius, in whole vectors.
const COLUMN: usize = BLOCK + 2 * BEFORE;

const _: () = assert!(2 * BEFORE == LANES && COLUMN.is_multiple_of(LANES));

/// Writes for each cluster how far along the curve its nearest neighbour is: the one with which it has the smallest box, by surface area.
///
/// Of several the one with which it would be paired along the curve, so that a crowd of equal boxes is halved in a round; else the next one ahead, else the next one
/// behind.
pub(super) fn find_nearest(
    clusters: &[Cluster],
    neighbours: &mut [i8],
    level: SimdLevel,
    work: Work<'_>,
) -> Result<(), Cancelled> {
    let pieces = neighbours.chunks_mut(PIECE).enumerate().collect();
    parallel::map_tasks(pieces, |(piece, neighbours)| {
        if work.ask().is_ok() {
            dispatch_on(level, FindNearest { clusters, first: piece * PIECE, neighbours });
        }
    });
    work.check()
}

/// Writes for each cluster how far along the curve the one is with which it is paired: the first with the second, and so on.
pub(super) fn pair_up(neighbours: &mut [i8]) {
    let count = neighbours.len();
    for (place, neighbour) in neighbours.iter_mut().enumerate() {
        *neighbour = partner(place, count);
    }
}

/// How far along the curve the cluster is with which one is paired; for the last of an odd number, which has none, the one before it.
#[inline(always)]
fn partner(place: usize, count: usize) -> i8 {
    if place.is_multiple_of(2) && place + 1 < count { 1 } else { -1 }
}

/// The search for some clusters that follow each other.
struct FindNearest<'a> {
    clusters: &'a [Cluster],
    first: usize,
    neighbours: &'a mut [i8],
}

impl Kernel for FindNearest<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { clusters, first, neighbours } = self;
        let mut columns = [[0.0; COLUMN]; 6];
        for (number, neighbours) in neighbours.chunks_mut(BLOCK).enumerate() {
            let start = first + number * BLOCK;
            fill(simd, &mut columns, clusters, start, neighbours.len());
            for (number, neighbour) in neighbours.iter_mut().enumerate() {
                let own = number + BEFORE;
                let areas = areas(simd, &columns, own, number);
                let least = simd.splat16(f32::INFINITY).replaced(NEIGHBOURS, areas).least();

                // Those behind by distance, one in the last of eight bits; then those ahead, one in the first.
                let nearest = areas.less_or_equal(simd.splat16(least)) & NEIGHBOURS;
                let (behind, ahead) = (nearest & 0xff, nearest >> (BEFORE + 1));
                let next_ahead = ahead.trailing_zeros() as i8 + 1;
                let next_behind = 31 - behind.leading_zeros() as i8 - BEFORE as i8;
                let nearest = if ahead != 0 { next_ahead } else { next_behind };
                let partner = partner(start + number, clusters.len());
                let of_partner = if partner == 1 { ahead } else { behind >> RADIUS };
                // Boxes too large to be measured are as near as what is beyond the ends.
                let is_partner = of_partner & 1 != 0 || least == f32::INFINITY;
                *neighbour = if is_partner { partner } else { nearest };
            }
        }
    }
}

/// Writes down the boxes of some clusters, coordinate by coordinate, with those that are within the radius; infinite ones beyond the ends.
#[inline(always)]
fn fill<S: Simd>(
    simd: S,
    columns: &mut [[f32; COLUMN]; 6],
    clusters: &[Cluster],
    start: usize,
    count: usize,
) {
    const BEYOND: [f32; 8] = {
        let (min, max) = (f32::NEG_INFINITY, f32::INFINITY);
        [min, min, min, min, max, max, max, max]
    };
    for place in (0..count + 2 * BEFORE).step_by(LANES) {
        let mut rows = [BEYOND; LANES];
        let first = (start + place).wrapping_sub(BEFORE);
        match clusters.get(first..).and_then(|clusters| clusters.first_chunk::<LANES>()) {
            Some(clusters) => {
                for (row, cluster) in rows.iter_mut().zip(clusters) {
                    *row = cluster.bounds().row();
                }
            }
            // At the ends. What would lie before the first cluster has a number beyond all.
            None => {
                for (lane, row) in rows.iter_mut().enumerate() {
                    if let Some(cluster) = clusters.get(first.wrapping_add(lane)) {
                        *row = cluster.bounds().row();
                    }
                }
            }
        }
        let [min_x, min_y, min_z, _, max_x, max_y, max_z, _] = simd.columns(&rows);
        store(&mut columns[0], place, min_x);
        store(&mut columns[1], place, min_y);
        store(&mut columns[2], place, min_z);
        store(&mut columns[3], place, max_x);
        store(&mut columns[4], place, max_y);
        store(&mut columns[5], place, max_z);
    }
}

/// Writes sixteen numbers to a column.
#[inline(always)]
fn store<F: Float<Array = [f32; 16]>>(column: &mut [f32; COLUMN], place: usize, numbers: F) {
    column[place..][..16].copy_from_slice(&numbers.to_array());
}

/// Half the areas of the boxes around that of one cluster and those of sixteen that follow each other. The boxes have finite edges, or infinite ones beyond the ends:
/// nothing becomes what is not a number.
#[inline(always)]
fn areas<S: Simd>(simd: S, columns: &[[f32; COLUMN]; 6], own: usize, start: usize) -> S::F16 {
    let x = edges(simd, [&columns[0], &columns[3]], own, start);
    let y = edges(simd, [&columns[1], &columns[4]], own, start);
    let z = edges(simd, [&columns[2], &columns[5]], own, start);
    x * y + y * z + z * x
}

/// The lengths of the boxes along one axis.
#[inline(always)]
fn edges<S: Simd>(simd: S, [min, max]: [&[f32; COLUMN]; 2], own: usize, start: usize) -> S::F16 {
    let least = load(simd, min, start).smaller(simd.splat16(min[own]));
    let most = load(simd, max, start).larger(simd.splat16(max[own]));
    most - least
}

/// Sixteen numbers of a column.
#[inline(always)]
fn load<S: Simd>(simd: S, column: &[f32; COLUMN], start: usize) -> S::F16 {
    simd.load16(column[start..].first_chunk().expect("margins on both sides"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;

    /// The same by brute force, one after the other.
    fn nearest(clusters: &[Cluster], place: usize) -> i8 {
        let area = |other: usize| {
            let around = clusters[place].bounds().union(*clusters[other].bounds());
            let [x, y, z, _] = around.extent();
            x * y + y * z + z * x
        };
        let ahead = place + 1..clusters.len().min(place + RADIUS + 1);
        let behind = (place.saturating_sub(RADIUS)..place).rev();
        let others: Vec<_> = ahead.chain(behind).collect();
        let least = others.iter().map(|&other| area(other)).fold(f32::INFINITY, f32::min);
        let partner = partner(place, clusters.len());
        let is_nearest = |other: &usize| area(*other) == least;
        let offset = |other: usize| (other as isize - place as isize) as i8;
        match others.iter().copied().filter(is_nearest).map(offset).find(|&at| at == partner) {
            Some(partner) => partner,
            None => offset(others.into_iter().find(is_nearest).expect("a neighbour")),
        }
    }

    #[test]
    fn the_nearest_is_found_on_every_level() {
        let mut state = 1u32;
        let mut random = |most: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % most
        };
        // Few places, so that there are many ties; with sizes around those of blocks and pieces.
        for (count, places) in
            [(2, 9), (3, 9), (17, 2), (255, 4), (257, 1000), (PIECE - 1, 3), (PIECE + 40, 100_000)]
        {
            let mut cluster = |place: usize| {
                let corner = [random(places), random(places), random(4)].map(|x| x as f32);
                let size = [random(3), random(3), random(2)].map(|x| x as f32);
                let bounds = Aabb::new(corner, [0, 1, 2].map(|axis| corner[axis] + size[axis]));
                Cluster::new(bounds.into(), place as u32, 1)
            };
            let clusters: Vec<_> = (0..count).map(&mut cluster).collect();
            let expected: Vec<_> = (0..count).map(|place| nearest(&clusters, place)).collect();
            for level in SimdLevel::available() {
                let mut found = vec![0; count];
                find_nearest(&clusters, &mut found, level, Work::UNWATCHED).expect("not stopped");
                assert_eq!(found, expected, "{count} clusters, {places} places, {level:?}");
            }
        }
    }
}
