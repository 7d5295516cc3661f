//! The surface area heuristic for a few primitives: every split is tried, as bins for them would be mostly empty.

use super::driver::{Set, Split};
use super::{PackedAabb, Primitive};
use crate::BuildOptions;

/// The most primitives in such a set.
pub(super) const SMALL_SET: usize = 8;

/// Sorts centroids along each axis and splits where `N_l*A_l + N_r*A_r` is smallest, or nowhere where a leaf is cheaper.
pub(super) fn split(set: &mut Set<'_>, options: &BuildOptions) -> Option<Split> {
    let count = set.primitives.len();
    let mut best = ([0; SMALL_SET], 1, f64::INFINITY);
    // Two can be divided in one way only.
    let axes = if count == 2 { 1 } else { 3 };
    for axis in 0..axes {
        let order = order_along(set.primitives, axis);
        let mut right_costs = [0.0; SMALL_SET];
        let mut right = PackedAabb::EMPTY;
        for place in (1..count).rev() {
            right.grow(set.primitives[order[place]].bounds());
            right_costs[place] = (count - place) as f64 * right.half_area();
        }
        let mut left = PackedAabb::EMPTY;
        for place in 1..count {
            left.grow(set.primitives[order[place - 1]].bounds());
            let cost = place as f64 * left.half_area() + right_costs[place];
            if cost < best.2 {
                best = (order, place, cost);
            }
        }
    }

    let (order, left_count, cost) = best;
    if count <= options.max_leaf_size && !options.split_is_cheaper(count, &set.around.bounds, cost)
    {
        return None;
    }
    let mut sorted = [set.primitives[0]; SMALL_SET];
    for (copy, &place) in sorted.iter_mut().zip(&order[..count]) {
        *copy = set.primitives[place];
    }
    set.primitives.copy_from_slice(&sorted[..count]);
    Some(Split::at(set.primitives, left_count))
}

/// The places of primitives in the order of their centroids along an axis, equal ones as they stand.
fn order_along(primitives: &[Primitive], axis: usize) -> [usize; SMALL_SET] {
    let mut centers = [0.0; SMALL_SET];
    for (center, primitive) in centers.iter_mut().zip(primitives) {
        *center = primitive.center()[axis];
    }
    // The place of each is the number of those before it.
    let mut order = [0; SMALL_SET];
    let centers = &centers[..primitives.len()];
    for (place, center) in centers.iter().enumerate() {
        let before = centers[..place].iter().filter(|other| *other <= center).count();
        let before = before + centers[place + 1..].iter().filter(|other| *other < center).count();
        order[before % SMALL_SET] = place;
    }
    order
}
