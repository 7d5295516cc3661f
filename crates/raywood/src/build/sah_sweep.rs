//! The full sweep of the surface area heuristic: MacDonald and Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990.

use super::PackedAabb;
use super::driver::{Split, Splitter};
use crate::BuildOptions;

/// Sorts the centroids along each axis and tries every split between two of them; takes the one where `N_l*A_l + N_r*A_r` is smallest, or
/// none where a leaf is cheaper. O(N log^2 N) in all: the reference for binning, which tries few splits and is much faster.
pub(super) struct SweepSah {
    options: BuildOptions,
}

impl SweepSah {
    pub(super) fn new(options: &BuildOptions) -> Self {
        Self { options: options.clamped() }
    }
}

/// A split along one axis.
struct Candidate {
    axis: usize,
    left_count: usize,
    cost: f64,
}

impl Splitter for SweepSah {
    fn split(
        &self,
        bounds: &[PackedAabb],
        indices: &mut [u32],
        node_bounds: &PackedAabb,
    ) -> Option<Split> {
        let count = indices.len();
        let best = (0..3).map(|axis| {
            sort_along(bounds, indices, axis);
            best_split(bounds, indices, axis)
        });
        let best = best.reduce(|best, next| if next.cost < best.cost { next } else { best })?;
        if count <= self.options.max_leaf_size
            && !self.options.split_is_cheaper(count, node_bounds, best.cost)
        {
            return None;
        }
        if best.axis != 2 {
            sort_along(bounds, indices, best.axis);
        }
        Some(Split::at(bounds, indices, best.left_count))
    }
}

/// Sorts primitives by centroid along an axis, equal ones by number: one order only, whatever it was before.
fn sort_along(bounds: &[PackedAabb], indices: &mut [u32], axis: usize) {
    let center = |i: u32| bounds[i as usize].center()[axis];
    crate::parallel::sort_unstable_by(indices, |&a, &b| {
        center(a).total_cmp(&center(b)).then_with(|| a.cmp(&b))
    });
}

/// The cheapest split of a sorted set of at least two.
fn best_split(bounds: &[PackedAabb], indices: &[u32], axis: usize) -> Candidate {
    // From the right: the area of what lies at or beyond each place.
    let mut right = PackedAabb::EMPTY;
    let mut right_areas = vec![0.0; indices.len()];
    for (&i, area) in indices.iter().zip(&mut right_areas).rev() {
        right.grow(&bounds[i as usize]);
        *area = right.half_area();
    }

    // From the left: the cost of splitting before each place.
    let mut left = PackedAabb::EMPTY;
    let mut best = Candidate { axis, left_count: 1, cost: f64::INFINITY };
    for (left_count, &i) in (1..indices.len()).zip(indices) {
        left.grow(&bounds[i as usize]);
        let right_count = indices.len() - left_count;
        let cost =
            left_count as f64 * left.half_area() + right_count as f64 * right_areas[left_count];
        if cost < best.cost {
            best = Candidate { axis, left_count, cost };
        }
    }
    best
}
