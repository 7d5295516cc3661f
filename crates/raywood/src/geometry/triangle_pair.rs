//! Whether two triangles touch: an edge of one passes through the other, or a corner or edge lies on it. In double precision, and as well for triangles without
//! area, which are points or segments.

use super::closest_to_zero;
use crate::double::{Double3, add, cross, dot, double, largest_magnitude, scale, sub};
use crate::{Aabb, Vec3};

/// What counts as lying on each other, per unit of the largest coordinate: ample for the rounding of all that is computed here.
pub(crate) const SLACK: f64 = 1.0 / (1u64 << 40) as f64;

/// Whether two triangles have a point in common, within `2^-40` of the largest coordinate where their boxes touch. Symmetric.
pub(crate) fn triangles_touch(first: [Vec3; 3], second: [Vec3; 3]) -> bool {
    let (a, b) = (Aabb::of_points(first), Aabb::of_points(second));
    if a.intersection(&b).is_empty() {
        return false;
    }
    let largest = a.min.abs().max(a.max.abs()).max(b.min.abs()).max(b.max.abs()).max_element();
    let first = [double(first[0]), double(first[1]), double(first[2])];
    let second = [double(second[0]), double(second[1]), double(second[2])];
    touch_within(first, second, SLACK * f64::from(largest))
}

/// The same of triangles in double precision, whose corners may have been rounded: within `2^-40` of the largest coordinate.
pub(crate) fn triangles_touch_in_double(first: [Double3; 3], second: [Double3; 3]) -> bool {
    let largest = first.iter().chain(&second).map(|p| largest_magnitude(*p)).fold(0.0, f64::max);
    let slack = SLACK * largest;
    let range = |[a, b, c]: [Double3; 3], axis: usize| {
        let (a, b, c) = (a[axis], b[axis], c[axis]);
        (a.min(b).min(c), a.max(b).max(c))
    };
    let boxes_touch = (0..3).all(|axis| {
        let ((a, b), (c, d)) = (range(first, axis), range(second, axis));
        a <= d + slack && c <= b + slack
    });
    boxes_touch && touch_within(first, second, slack)
}

fn touch_within(first: [Double3; 3], second: [Double3; 3], slack: f64) -> bool {
    !lies_beside(first, second, slack)
        && !lies_beside(second, first, slack)
        && (pierces(first, second)
            || pierces(second, first)
            || has_corner_on(first, second, slack)
            || has_corner_on(second, first, slack)
            || have_edges_in_touch(first, second, slack))
}

fn edges([a, b, c]: [Double3; 3]) -> [(Double3, Double3); 3] {
    [(a, b), (b, c), (c, a)]
}

fn normal([a, b, c]: [Double3; 3]) -> Double3 {
    cross(sub(b, a), sub(c, a))
}

/// Whether a triangle lies on one side of the other's plane.
fn lies_beside(triangle: [Double3; 3], other: [Double3; 3], slack: f64) -> bool {
    let normal = normal(other);
    let margin = slack * dot(normal, normal).sqrt();
    let heights = triangle.map(|corner| dot(normal, sub(corner, other[0])));
    heights.iter().all(|&height| height > margin) || heights.iter().all(|&height| height < -margin)
}

/// Whether an edge of a triangle passes through the inside of the other.
fn pierces(triangle: [Double3; 3], other: [Double3; 3]) -> bool {
    let normal = normal(other);
    edges(triangle).into_iter().any(|(p, q)| {
        let (above, below) = (dot(normal, sub(p, other[0])), dot(normal, sub(q, other[0])));
        let way = sub(q, p);
        let sides = edges(other).map(|(from, to)| dot(way, cross(sub(from, p), sub(to, p))));
        above * below < 0.0
            && (sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0))
    })
}

/// Whether a corner of a triangle lies on the other.
fn has_corner_on(triangle: [Double3; 3], other: [Double3; 3], slack: f64) -> bool {
    triangle.into_iter().any(|corner| {
        let (beside, ..) = closest_to_zero(other.map(|p| sub(p, corner)));
        dot(beside, beside) <= slack * slack
    })
}

/// Whether edges of two triangles cross. Those that are parallel have their corners to tell.
fn have_edges_in_touch(first: [Double3; 3], second: [Double3; 3], slack: f64) -> bool {
    let touch = |(p, q): (Double3, Double3), (r, s): (Double3, Double3)| {
        let (d, e, apart) = (sub(q, p), sub(s, r), sub(p, r));
        let (dd, ee, de) = (dot(d, d), dot(e, e), dot(d, e));
        let (along_d, along_e) = (dot(d, apart), dot(e, apart));
        let determinant = dd * ee - de * de;
        if determinant <= 0.0 {
            return false;
        }
        let share = ((de * along_e - along_d * ee) / determinant).clamp(0.0, 1.0);
        let other = ((de * share + along_e) / ee).clamp(0.0, 1.0);
        let beside = sub(add(apart, scale(share, d)), scale(other, e));
        dot(beside, beside) <= slack * slack
    };
    edges(first).into_iter().any(|edge| edges(second).into_iter().any(|other| touch(edge, other)))
}
