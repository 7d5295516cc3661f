//! Boxes around what lies around a segment, and what boxes have to do with it: what capsules, cylinders and discs share.

use super::chord::Chord;
use crate::double::{Double3, add, dot, double, scale, share_along, single, sub};
use crate::{Aabb, Vec3};

/// How thick a surface is where it is asked for cells that it passes through, per unit of its coordinates: some roundings of points on it.
const OVERLAP_SLACK: f64 = 8.0 * f32::EPSILON as f64;

/// The error of a computed point, and of what it is compared with, per unit of the largest coordinate.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How far a disc reaches from its centre along each coordinate axis; its normal, of any length, is not zero.
pub(super) fn disc_reach(normal: Double3, radius: f64) -> Double3 {
    let [x, y, z] = [normal[0] * normal[0], normal[1] * normal[1], normal[2] * normal[2]];
    let square = x + y + z;
    [y + z, z + x, x + y].map(|across| radius * (across / square).sqrt())
}

/// The box around all that is up to `reach` away from a segment along each coordinate axis, rounded outwards, flat where that is zero.
pub(super) fn bounds_around(start: Vec3, end: Vec3, reach: Double3) -> Aabb {
    bounds_of(double(start.min(end)), double(start.max(end)), reach)
}

fn bounds_of(min: Double3, max: Double3, reach: Double3) -> Aabb {
    let rounded = |exact: f64, outwards: fn(f32) -> f32, reach: f64| {
        if reach == 0.0 { exact as f32 } else { outwards(exact as f32) }
    };
    let least = |i: usize| rounded(min[i] - reach[i], f32::next_down, reach[i]);
    let greatest = |i: usize| rounded(max[i] + reach[i], f32::next_up, reach[i]);
    Aabb {
        min: Vec3::new(least(0), least(1), least(2)),
        max: Vec3::new(greatest(0), greatest(1), greatest(2)),
    }
}

/// The box around the part of the same that lies in a cell: around the part of the segment that is near enough.
pub(super) fn clipped_bounds_around(start: Vec3, end: Vec3, reach: Double3, cell: &Aabb) -> Aabb {
    let bounds = bounds_around(start, end, reach);
    let shared = bounds.intersection(cell);
    if shared.is_empty() || cell.contains(&bounds) {
        return shared;
    }
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let error = ROUNDING * f64::from(largest);
    let (from, axis) = (double(start), sub(double(end), double(start)));
    let (min, max) = (double(shared.min), double(shared.max));
    let mut near = Chord { enter: 0.0, leave: 1.0 };
    for i in 0..3 {
        let margin = reach[i] + error;
        let (low, high) = (min[i] - margin - from[i], max[i] + margin - from[i]);
        match Chord::between(axis[i], low, high).and_then(|slab| near.and(slab)) {
            Some(rest) => near = rest,
            None => return Aabb::EMPTY,
        }
    }
    let [a, b] = [near.enter, near.leave].map(|share| add(from, scale(share, axis)));
    let [min, max] = [f64::min, f64::max]
        .map(|of: fn(f64, f64) -> f64| [of(a[0], b[0]), of(a[1], b[1]), of(a[2], b[2])]);
    bounds_of(min, max, reach.map(|reach| reach + error)).intersection(&shared)
}

/// Whether the surface of a capsule passes through a cell, within some roundings of its coordinates.
pub(super) fn capsule_overlaps(start: Vec3, end: Vec3, radius: f32, cell: &Aabb) -> bool {
    if !capsule_touches(start, end, radius, cell) {
        return false;
    }
    // Not where the cell lies inside, as it does if all of its corners do.
    let slack = overlap_slack(start, end, radius);
    let (from, axis, radius) = (double(start), sub(double(end), double(start)), f64::from(radius));
    let is_inside = |corner: Double3| {
        let offset = sub(corner, add(from, scale(share_along(corner, from, axis), axis)));
        dot(offset, offset).sqrt() < radius - slack
    };
    !corners(cell).all(is_inside)
}

/// Whether a capsule has a point in a cell, within the same roundings, be it on its surface or inside.
pub(super) fn capsule_touches(start: Vec3, end: Vec3, radius: f32, cell: &Aabb) -> bool {
    let axis = sub(double(end), double(start));
    let distance = distance_of_box(double(start), axis, cell);
    distance <= f64::from(radius) + overlap_slack(start, end, radius)
}

/// By how much surfaces count as thicker where they are asked for cells.
pub(super) fn overlap_slack(start: Vec3, end: Vec3, radius: f32) -> f64 {
    let largest = start.abs().max(end.abs()).max_element();
    OVERLAP_SLACK * (f64::from(largest) + f64::from(radius))
}

/// The eight corners of a box.
pub(super) fn corners(cell: &Aabb) -> impl Iterator<Item = Double3> {
    let ends = [double(cell.min), double(cell.max)];
    (0..8).map(move |corner| [ends[corner & 1][0], ends[corner >> 1 & 1][1], ends[corner >> 2][2]])
}

/// The distance of a segment from a solid box.
fn distance_of_box(start: Double3, axis: Double3, cell: &Aabb) -> f64 {
    let (min, max) = (double(cell.min), double(cell.max));
    let outside = |share: f64| {
        [0, 1, 2].map(|i| {
            let x = start[i] + share * axis[i];
            (x - max[i]).max(0.0) - (min[i] - x).max(0.0)
        })
    };
    // The square of the distance along the segment is convex, and its slope a straight line between the planes of the box.
    let slope = |share: f64| dot(outside(share), axis);
    let (mut low, mut high) = (0.0, 1.0);
    let nearest = if slope(low) >= 0.0 {
        low
    } else if slope(high) <= 0.0 {
        high
    } else {
        for i in 0..3 {
            for plane in [min[i], max[i]] {
                let share = (plane - start[i]) / axis[i];
                if low < share && share < high {
                    if slope(share) < 0.0 { low = share } else { high = share }
                }
            }
        }
        let (at_low, at_high) = (slope(low), slope(high));
        low + (high - low) * (at_low / (at_low - at_high))
    };
    let offset = outside(nearest);
    dot(offset, offset).sqrt()
}

/// The ball around all that is up to `reach` away from a point that single precision may not have; `None` if it is too large.
pub(super) fn ball_around(middle: Double3, reach: f64) -> Option<(Vec3, f32)> {
    let center = single(middle);
    let off = sub(double(center), middle);
    let radius = ((reach + dot(off, off).sqrt()) as f32).next_up();
    radius.is_finite().then_some((center, radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_beside_boxes() {
        let cell = Aabb::new([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]);
        let distance = |a: [f64; 3], b: [f64; 3]| distance_of_box(a, sub(b, a), &cell);
        assert_eq!(distance([3.0, 0.0, 0.0], [5.0, 0.0, 0.0]), 2.0);
        assert_eq!(distance([5.0, 0.0, 0.0], [3.0, 0.0, 0.0]), 2.0);
        assert_eq!(distance([-9.0, 0.5, 4.0], [9.0, 0.5, 4.0]), 3.0);
        assert_eq!(distance([-9.0, 0.5, 0.0], [9.0, 0.5, 0.0]), 0.0);
        assert_eq!(distance([4.0, 5.0, 0.0], [4.0, 5.0, 0.0]), 5.0);
        // Past an edge, along the diagonal of a face.
        let beside = distance([4.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
        assert!((beside - 2f64.sqrt()).abs() < 1e-12, "{beside}");
    }

    #[test]
    fn a_part_of_a_long_segment_has_a_small_box() {
        let cell = Aabb::new([4.0, 4.0, 4.0], [6.0, 6.0, 6.0]);
        let (start, end) = (Vec3::ZERO, Vec3::new(10.0, 10.0, 0.0));
        let reach = [0.1; 3];
        assert!(clipped_bounds_around(start, end, reach, &cell).is_empty());
        let cell = Aabb::new([4.0, 4.5, -1.0], [6.0, 6.0, 1.0]);
        let part = clipped_bounds_around(start, end, reach, &cell);
        assert!(part.min.x > 4.29 && part.max.x == 6.0 && part.max.z < 0.11, "{part:?}");
    }
}
