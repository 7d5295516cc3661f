//! The full sweep of the surface area heuristic: MacDonald and Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990.

use super::driver::{Set, Split, Splitter};
use super::quicksort::sort;
use super::{Cancelled, PackedAabb, Primitive, Work};
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

/// How many primitives are looked at without asking whether to go on.
const STRETCH: usize = 1 << 17;

/// A split along one axis.
struct Candidate {
    axis: usize,
    left_count: usize,
    cost: f64,
}

impl Splitter for SweepSah {
    fn split(&self, set: &mut Set<'_>) -> Option<Split> {
        let (count, work) = (set.primitives.len(), set.work);
        let mut best = Candidate { axis: 0, left_count: 1, cost: f64::INFINITY };
        for axis in 0..3 {
            sort_along(set.primitives, axis, work).ok()?;
            let candidate = best_split(set.primitives, axis, work).ok()?;
            if axis == 0 || candidate.cost < best.cost {
                best = candidate;
            }
        }
        if count <= self.options.max_leaf_size
            && !self.options.split_is_cheaper(count, &set.around.bounds, best.cost)
        {
            return None;
        }
        if best.axis != 2 {
            sort_along(set.primitives, best.axis, work).ok()?;
        }
        Some(Split::at(set.primitives, best.left_count))
    }
}

/// Sorts primitives by centroid along an axis, equal ones by number: one order only, whatever it was before.
fn sort_along(primitives: &mut [Primitive], axis: usize, work: Work<'_>) -> Result<(), Cancelled> {
    sort(primitives, work, |a, b| {
        let by_center = a.center()[axis].total_cmp(&b.center()[axis]);
        by_center.then_with(|| a.number().cmp(&b.number()))
    })
}

/// The cheapest split of a sorted set of at least two.
fn best_split(
    primitives: &[Primitive],
    axis: usize,
    work: Work<'_>,
) -> Result<Candidate, Cancelled> {
    // From the right: the area of what lies at or beyond each place.
    let mut right = PackedAabb::EMPTY;
    let mut right_areas = vec![0.0; primitives.len()];
    for (primitives, areas) in primitives.chunks(STRETCH).zip(right_areas.chunks_mut(STRETCH)).rev()
    {
        work.ask()?;
        for (primitive, area) in primitives.iter().zip(areas).rev() {
            right.grow(primitive.bounds());
            *area = right.half_area();
        }
    }

    // From the left: the cost of splitting before each place.
    let mut left = PackedAabb::EMPTY;
    let mut best = Candidate { axis, left_count: 1, cost: f64::INFINITY };
    for (left_count, primitive) in (1..primitives.len()).zip(primitives) {
        if left_count % STRETCH == 0 {
            work.ask()?;
        }
        left.grow(primitive.bounds());
        let right_count = primitives.len() - left_count;
        let cost =
            left_count as f64 * left.half_area() + right_count as f64 * right_areas[left_count];
        if cost < best.cost {
            best = Candidate { axis, left_count, cost };
        }
    }
    Ok(best)
}
