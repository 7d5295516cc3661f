//! The binned surface area heuristic: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.

use super::PackedAabb;
use super::driver::{Split, Splitter, partition, split_at_median};
use crate::BuildOptions;

/// The most bins per axis.
pub(super) const MAX_BINS: usize = 32;

/// Sets up to this size are sorted into few bins: clearing and sweeping many would take longer than all the rest.
const SMALL_SET: usize = 24;

/// The bins of a small set.
const SMALL_SET_BINS: usize = 8;

/// Sorts centroids into equal bins along each axis and splits between the two bins where `N_l*A_l + N_r*A_r` is smallest.
/// Does not split where a leaf is cheaper (natural termination).
pub(super) struct BinnedSah {
    options: BuildOptions,
}

impl BinnedSah {
    /// With options whose values are in range.
    pub(super) fn new(options: &BuildOptions) -> Self {
        Self { options: options.clamped() }
    }
}

/// The primitives whose centroids fall into one slab.
#[derive(Clone, Copy)]
struct Bin {
    bounds: PackedAabb,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: PackedAabb::EMPTY, count: 0 };

    #[inline]
    fn merged(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Number of primitives times surface area; there is at least one.
    #[inline]
    fn cost(&self) -> f64 {
        f64::from(self.count) * self.bounds.half_area()
    }
}

/// Which bin a centroid belongs to, on each axis.
#[derive(Clone, Copy)]
struct Binning {
    start: [f32; 4],
    scale: [f32; 4],
    last: i32,
}

impl Binning {
    /// `bins` equal bins over the box of all centroids.
    fn new(centers: &PackedAabb, bins: usize) -> Self {
        Self {
            start: centers.min(),
            scale: centers.extent().map(|e| bins as f32 / e),
            last: bins as i32 - 1,
        }
    }

    /// The bin on one axis. The cast takes NaN (no extent) to zero and saturates, so the answer is always in range.
    #[inline]
    fn bin(&self, center: [f32; 4], axis: usize) -> usize {
        (((center[axis] - self.start[axis]) * self.scale[axis]) as i32).clamp(0, self.last) as usize
    }
}

/// A place to split: between two bins of an axis.
struct Candidate {
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
    cost: f64,
    left: Bin,
    right: Bin,
}

impl Splitter for BinnedSah {
    fn split(
        &self,
        bounds: &[PackedAabb],
        indices: &mut [u32],
        node_bounds: &PackedAabb,
    ) -> Option<Split> {
        let count = indices.len();
        let centers = crate::parallel::fold(
            indices,
            PackedAabb::EMPTY,
            |centers, &i| *centers = centers.including(bounds[i as usize].center()),
            PackedAabb::grow,
        );
        let bins = if count <= SMALL_SET {
            self.options.bins.min(SMALL_SET_BINS)
        } else {
            self.options.bins
        };
        let binning = Binning::new(&centers, bins);
        let best = if bins <= SMALL_SET_BINS {
            best_split::<SMALL_SET_BINS>(bounds, indices, &binning)
        } else {
            best_split::<MAX_BINS>(bounds, indices, &binning)
        };

        // Natural termination: leave the set whole where testing all of it costs no more than the best split, as long
        // as it is small enough to be a leaf.
        let is_cheaper =
            |best: &Candidate| self.options.split_is_cheaper(count, node_bounds, best.cost);
        if count <= self.options.max_leaf_size && !best.as_ref().is_some_and(is_cheaper) {
            return None;
        }

        // All centroids in one place, or too close to tell apart: any half is as good as another.
        let Some(Candidate { axis, bin, left, right, .. }) = best else {
            return Some(split_at_median(bounds, indices));
        };
        let left_count =
            partition(indices, |i| binning.bin(bounds[i as usize].center(), axis) < bin);
        debug_assert_eq!(left_count, left.count as usize);
        Some(Split { left_count, left: left.bounds, right: right.bounds })
    }
}

/// The cheapest of all places between two bins, if any separates the primitives.
fn best_split<const BINS: usize>(
    bounds: &[PackedAabb],
    indices: &[u32],
    binning: &Binning,
) -> Option<Candidate> {
    let bins = crate::parallel::fold(
        indices,
        [[Bin::EMPTY; BINS]; 3],
        |bins, &i| {
            let primitive = bounds[i as usize];
            let center = primitive.center();
            for (axis, bins) in bins.iter_mut().enumerate() {
                let bin = &mut bins[binning.bin(center, axis) % BINS];
                bin.bounds.grow(&primitive);
                bin.count += 1;
            }
        },
        |all, piece| {
            for (all, piece) in all.as_flattened_mut().iter_mut().zip(piece.as_flattened()) {
                *all = all.merged(*piece);
            }
        },
    );

    let mut best: Option<Candidate> = None;
    for (axis, bins) in bins.iter().enumerate() {
        sweep(&bins[..=binning.last as usize], axis, &mut best);
    }
    best
}

/// Replaces `best` by the cheapest place to split along one axis, if that is cheaper.
fn sweep(bins: &[Bin], axis: usize, best: &mut Option<Candidate>) {
    // From the right: what lies at or beyond each bin.
    let mut rights = [Bin::EMPTY; MAX_BINS];
    let mut right = Bin::EMPTY;
    for (bin, slot) in bins.iter().zip(&mut rights).rev() {
        right = right.merged(*bin);
        *slot = right;
    }

    // From the left: the cost of splitting before each bin that is not empty.
    let mut left = bins[0];
    for (number, (bin, &right)) in bins.iter().zip(&rights).enumerate().skip(1) {
        if bin.count > 0 && left.count > 0 {
            let cost = left.cost() + right.cost();
            if best.as_ref().is_none_or(|best| cost < best.cost) {
                *best = Some(Candidate { axis, bin: number, cost, left, right });
            }
        }
        left = left.merged(*bin);
    }
}
