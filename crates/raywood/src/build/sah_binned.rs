//! The binned surface area heuristic: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.

use super::driver::{Split, Splitter, split_at_median};
use crate::{Aabb, BuildOptions, Vec3};

/// The most bins per axis.
pub(crate) const MAX_BINS: usize = 64;

/// Sorts centroids into equal bins along each axis and splits between the two bins where `N_l*A_l + N_r*A_r` is smallest.
/// Does not split where a leaf is cheaper (natural termination).
pub(crate) struct BinnedSah {
    options: BuildOptions,
}

impl BinnedSah {
    /// With options whose values are in range.
    pub(crate) fn new(options: &BuildOptions) -> Self {
        Self { options: options.clamped() }
    }
}

/// The primitives whose centroids fall into one slab.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    fn merged(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Number of primitives times surface area. In double precision, where no finite box overflows or vanishes.
    fn cost(&self) -> f64 {
        if self.count == 0 { 0.0 } else { f64::from(self.count) * half_area(&self.bounds) }
    }
}

/// Half the surface area of a box that is not empty.
fn half_area(bounds: &Aabb) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]));
    x * y + y * z + z * x
}

/// The bins of all three axes.
type Bins = [[Bin; MAX_BINS]; 3];

/// Which bin a centroid belongs to, on each axis.
#[derive(Clone, Copy)]
struct Binning {
    start: Vec3,
    scale: Vec3,
    last: u32,
}

impl Binning {
    fn new(centers: &Aabb, bins: usize) -> Self {
        let scale = |extent: f32| bins as f32 / extent;
        let extent = centers.extent();
        Self {
            start: centers.min,
            scale: Vec3::new(scale(extent.x), scale(extent.y), scale(extent.z)),
            last: bins as u32 - 1,
        }
    }

    /// The bin on one axis. The cast takes NaN (no extent) to zero and saturates, so the answer is always in range.
    #[inline]
    fn bin(&self, center: f32, axis: usize) -> usize {
        (((center - self.start[axis]) * self.scale[axis]) as u32).min(self.last) as usize
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
    fn split(&self, bounds: &[Aabb], indices: &mut [u32], node_bounds: &Aabb) -> Option<Split> {
        let count = indices.len();
        let best = self.best_split(bounds, indices);

        // Natural termination: leave the set whole where testing all of it costs no more than the best split, as long
        // as it is small enough to be a leaf.
        let options = &self.options;
        let area = half_area(node_bounds);
        let (node_cost, primitive_cost) =
            (f64::from(options.node_cost), f64::from(options.primitive_cost));
        let leaf_cost = primitive_cost * count as f64 * area;
        let split_is_cheaper =
            |cost: f64| 2.0 * node_cost * area + primitive_cost * cost < leaf_cost;
        if count <= options.max_leaf_size
            && !best.as_ref().is_some_and(|(_, best)| split_is_cheaper(best.cost))
        {
            return None;
        }

        // All centroids in one place, or too close to tell apart: any half is as good as another.
        let Some((binning, best)) = best else { return Some(split_at_median(bounds, indices)) };

        let Candidate { axis, bin, left, right, .. } = best;
        let goes_left = |i: u32| binning.bin(bounds[i as usize].center()[axis], axis) < bin;
        let left_count = partition(indices, goes_left);
        debug_assert_eq!(left_count, left.count as usize);
        Some(Split { left_count, left: left.bounds, right: right.bounds })
    }
}

impl BinnedSah {
    /// The cheapest of all places between two bins, if any separates the primitives.
    fn best_split(&self, bounds: &[Aabb], indices: &[u32]) -> Option<(Binning, Candidate)> {
        let bin_count = self.options.bins;
        let centers = crate::parallel::fold(
            indices,
            Aabb::EMPTY,
            |centers, &i| centers.including(bounds[i as usize].center()),
            Aabb::union,
        );
        let binning = Binning::new(&centers, bin_count);
        let bins = crate::parallel::fold(
            indices,
            [[Bin::EMPTY; MAX_BINS]; 3],
            |mut bins: Bins, &i| {
                let primitive = bounds[i as usize];
                let center = primitive.center();
                for (axis, bins) in bins.iter_mut().enumerate() {
                    let bin = &mut bins[binning.bin(center[axis], axis)];
                    bin.bounds = bin.bounds.union(primitive);
                    bin.count += 1;
                }
                bins
            },
            |mut a, b| {
                for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
                    *a = a.merged(*b);
                }
                a
            },
        );

        let mut best: Option<Candidate> = None;
        for (axis, bins) in bins.iter().enumerate() {
            if centers.min[axis] < centers.max[axis] {
                sweep(&bins[..bin_count], axis, &mut best);
            }
        }
        Some((binning, best?))
    }
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

    // From the left: the cost of splitting before each bin.
    let mut left = Bin::EMPTY;
    for (bin, &right) in (1..).zip(&rights[1..bins.len()]) {
        left = left.merged(bins[bin - 1]);
        if left.count == 0 || right.count == 0 {
            continue;
        }
        let cost = left.cost() + right.cost();
        if best.as_ref().is_none_or(|best| cost < best.cost) {
            *best = Some(Candidate { axis, bin, cost, left, right });
        }
    }
}

/// Moves the numbers for which `goes_left` holds to the front, in place, and tells how many they are.
fn partition(indices: &mut [u32], goes_left: impl Fn(u32) -> bool) -> usize {
    let (mut left, mut right) = (0, indices.len());
    while left < right {
        if goes_left(indices[left]) {
            left += 1;
        } else {
            right -= 1;
            indices.swap(left, right);
        }
    }
    left
}
