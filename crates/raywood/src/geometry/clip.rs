//! The part of a triangle inside a box: Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974.

use crate::{Aabb, Vec3};

/// The error of a computed point per unit of the largest coordinate: sixteen roundings in double precision, where six planes one after
/// the other cost at most about twelve.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A convex polygon: three corners, and one more for each of the six planes that cuts one off.
struct Polygon {
    corners: [[f64; 3]; 9],
    len: usize,
}

/// A box around the part of the triangle that lies in the cell, inside both the cell and the triangle's own box: what Wald and Havran, "On
/// building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)", 2006, call a perfect split.
///
/// Conservative: computed in double precision against a cell larger by the rounding errors, and rounded outwards. So it is never
/// empty if the triangle touches the cell. O(1), some forty interpolations at most.
pub(super) fn clipped_triangle_bounds(corners: [Vec3; 3], cell: &Aabb) -> Aabb {
    let bounds = Aabb::of_points(corners);
    let shared = bounds.intersection(cell);
    if shared.is_empty() || cell.contains(&bounds) {
        return shared;
    }

    let largest = [bounds.min, bounds.max, shared.min, shared.max]
        .into_iter()
        .fold(0.0f32, |largest, corner| largest.max(corner.abs().max_element()));
    let error = ROUNDING * f64::from(largest);

    // Cut at the planes that the triangle crosses, lowest corner of the cell first, then the highest.
    let mut polygon = Polygon::triangle(corners);
    for axis in 0..3 {
        if bounds.min[axis] < cell.min[axis] {
            polygon = polygon.cut(axis, 1.0, f64::from(cell.min[axis]) - error);
        }
        if bounds.max[axis] > cell.max[axis] {
            polygon = polygon.cut(axis, -1.0, -(f64::from(cell.max[axis]) + error));
        }
    }
    polygon.bounds(error).intersection(&shared)
}

impl Polygon {
    fn triangle(corners: [Vec3; 3]) -> Self {
        let mut polygon = Self { corners: [[0.0; 3]; 9], len: 0 };
        for corner in corners {
            polygon.push(corner.to_array().map(f64::from));
        }
        polygon
    }

    fn push(&mut self, corner: [f64; 3]) {
        // Rounding cannot make a convex polygon cross a plane more than twice, but nothing here should depend on that.
        if let Some(place) = self.corners.get_mut(self.len) {
            *place = corner;
            self.len += 1;
        }
    }

    /// The part where `sign * coordinate >= plane`.
    fn cut(&self, axis: usize, sign: f64, plane: f64) -> Self {
        let mut kept = Self { corners: [[0.0; 3]; 9], len: 0 };
        for place in 0..self.len {
            let (a, b) = (self.corners[place], self.corners[(place + 1) % self.len]);
            let (height_a, height_b) = (sign * a[axis] - plane, sign * b[axis] - plane);
            if height_a >= 0.0 {
                kept.push(a);
            }
            // Always from the corner inside, so that both directions of an edge give the same point.
            if (height_a >= 0.0) != (height_b >= 0.0) {
                let (inside, outside, share) = if height_a >= 0.0 {
                    (a, b, height_a / (height_a - height_b))
                } else {
                    (b, a, height_b / (height_b - height_a))
                };
                let mut point = [0, 1, 2].map(|i| inside[i] + share * (outside[i] - inside[i]));
                point[axis] = sign * plane;
                kept.push(point);
            }
        }
        kept
    }

    /// The box around the corners and their errors, rounded outwards.
    fn bounds(&self, error: f64) -> Aabb {
        self.corners[..self.len].iter().fold(Aabb::EMPTY, |bounds, corner| {
            let low = Vec3::from(corner.map(|x| round_down(x - error)));
            let high = Vec3::from(corner.map(|x| -round_down(-(x + error))));
            bounds.including(low).including(high)
        })
    }
}

/// The largest single-precision number not above `x`.
pub(crate) fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}
