//! Merging clusters two by two, and what is remembered of it.

use super::clusters::{Cluster, Id};
use crate::build::{Cancelled, PackedAabb, Work};
use crate::parallel;

/// A thread merges so many clusters at a time.
const PIECE: usize = 1 << 12;

/// Two clusters that were merged: the box around both and, in the lanes of the box that mean nothing, what they are.
#[derive(Clone, Copy)]
struct Merge(PackedAabb);

/// All merges, in the order in which they were made.
pub(super) struct Merges {
    /// Those that were made, and room for the others.
    merges: Vec<Merge>,
    /// How many primitives each has.
    sizes: Vec<u32>,
    /// How many were made.
    made: usize,
    /// How many primitives there are, whose numbers come before those of merges.
    primitives: usize,
}

impl Merges {
    /// None, with room for all that so many primitives need. That is touched here, in parallel: page by page, as merges are made, would take longer.
    pub(super) fn with_room(primitives: usize, work: Work<'_>) -> Result<Self, Cancelled> {
        let merges = work.copies(Merge(PackedAabb::EMPTY), primitives)?;
        Ok(Self { merges, sizes: work.copies(0, primitives)?, made: 0, primitives })
    }

    /// The cluster that was made last: with the last of all merges that of all primitives.
    pub(super) fn last(&self) -> Id {
        (self.primitives + self.made - 1) as Id
    }

    /// The number of a merge; none if the cluster is a primitive.
    #[inline(always)]
    pub(super) fn number(&self, id: Id) -> Option<usize> {
        (id as usize).checked_sub(self.primitives)
    }

    /// The box around a merge.
    #[inline(always)]
    pub(super) fn bounds(&self, number: usize) -> &PackedAabb {
        &self.merges[number].0
    }

    /// The clusters that were merged: the one that came first along the curve, and the other.
    #[inline(always)]
    pub(super) fn children(&self, number: usize) -> [Id; 2] {
        self.merges[number].0.tags()
    }

    /// How many primitives a cluster has.
    #[inline(always)]
    pub(super) fn size(&self, id: Id) -> usize {
        self.number(id).map_or(1, |number| self.sizes[number] as usize)
    }
}

/// Merges any two clusters that are each other's neighbours. What is left keeps the order of the curve, both in the place of the first; it stands in the first places of
/// `merged`, which has room for as many as there were. Returns how many they are.
pub(super) fn merge(
    clusters: &[Cluster],
    neighbours: &[i8],
    merged: &mut [Cluster],
    merges: &mut Merges,
    work: Work<'_>,
) -> Result<usize, Cancelled> {
    // Count what becomes of each piece, so that all know where to write.
    let places = |first: usize| first..clusters.len().min(first + PIECE);
    let firsts: Vec<_> = (0..clusters.len()).step_by(PIECE).collect();
    let counts = parallel::map_tasks(firsts.clone(), |first| {
        places(first).fold([0; 2], |[pairs, vanishing], place| {
            let pair = Pair::at(place, neighbours);
            [pairs + usize::from(pair.is_first), vanishing + usize::from(pair.is_second)]
        })
    });

    let pairs: usize = counts.iter().map(|[pairs, _]| pairs).sum();
    let made = merges.made;
    merges.made += pairs;
    let mut rest = (merged, &mut merges.merges[made..], &mut merges.sizes[made..]);
    let mut first_id = merges.primitives + made;
    let mut tasks = Vec::with_capacity(firsts.len());
    for (first, [pairs, vanishing]) in firsts.into_iter().zip(counts) {
        let places = places(first);
        let output = Output {
            clusters: take(&mut rest.0, places.len() - vanishing),
            merges: take(&mut rest.1, pairs),
            sizes: take(&mut rest.2, pairs),
            first_id: first_id as Id,
        };
        tasks.push((places, output));
        first_id += pairs;
    }
    parallel::map_tasks(tasks, |(places, output)| {
        if work.ask().is_ok() {
            let pairs = places.map(|place| (place, Pair::at(place, neighbours)));
            output.write(clusters, pairs);
        }
    });
    work.check()?;
    Ok(clusters.len() - pairs)
}

/// What becomes of some clusters.
struct Output<'a> {
    clusters: &'a mut [Cluster],
    merges: &'a mut [Merge],
    sizes: &'a mut [u32],
    /// What the first merge is.
    first_id: Id,
}

impl Output<'_> {
    /// Writes the clusters that are left, and the merges. Without branches, since nobody can foresee which clusters are pairs: the box around a cluster that stays
    /// and itself is its own.
    fn write(self, clusters: &[Cluster], pairs: impl Iterator<Item = (usize, Pair)>) {
        let Self { clusters: left, merges, sizes, first_id } = self;
        let (mut written, mut made) = (0, 0);
        for (place, pair) in pairs {
            let other = if pair.is_first { pair.other } else { place };
            let (first, second) = (&clusters[place], &clusters[other]);
            let bounds = first.bounds().union(*second.bounds());
            let size = first.size() + second.size();
            if let (Some(merge), Some(merged_size)) = (merges.get_mut(made), sizes.get_mut(made)) {
                *merge = Merge(bounds.with_tags([first.id(), second.id()]));
                *merged_size = size;
            }
            if let Some(left) = left.get_mut(written) {
                *left = match pair.is_first {
                    true => Cluster::new(bounds, first_id + made as Id, size),
                    false => *first,
                };
            }
            made += usize::from(pair.is_first);
            written += usize::from(!pair.is_second);
        }
    }
}

/// The first so many items of a slice, which then begins behind them.
fn take<'a, T>(slice: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(slice).split_at_mut(count);
    *slice = rest;
    first
}

/// What becomes of a cluster.
struct Pair {
    /// Where its neighbour is.
    other: usize,
    /// Whether both are merged, this one being the first.
    is_first: bool,
    /// Whether both are merged, this one being the second.
    is_second: bool,
}

impl Pair {
    #[inline(always)]
    fn at(place: usize, neighbours: &[i8]) -> Self {
        let offset = neighbours[place];
        let other = place.wrapping_add_signed(isize::from(offset));
        let is_pair = neighbours[other] == -offset;
        Self { other, is_first: is_pair & (offset > 0), is_second: is_pair & (offset < 0) }
    }
}
