//! The point of a triangle that is closest to another point, in double precision.
//!
//! It lies where the point is projected to if that is inside, else on the closest of the three edges. That asks for no order of cases, and so
//! holds for triangles without area too, which are points or segments.

use crate::Vec3;
use crate::double::{Double3, add, clamp, cross, dot, double, max, min, scale, single, sub};

/// The point of one primitive that is closest to a given one: what [`Geometry::closest_point`](super::Geometry::closest_point) tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitivePoint {
    /// Where it lies.
    pub point: Vec3,
    /// How far it is from the given point; not negative.
    pub distance: f32,
    /// First surface coordinate, as that of a [`Hit`](crate::Hit).
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
}

/// The point of a triangle that is closest to `point`.
///
/// With `M` the largest coordinate of all, double precision adds less than `2^-40 M` to the rounding of the answer to single precision. Edges give
/// the same distance for both triangles that share them, whatever their direction.
#[inline]
pub(crate) fn closest_on_triangle(point: Vec3, corners: [Vec3; 3]) -> PrimitivePoint {
    let p = double(point);
    // Everything relative to the point.
    let [a, b, c] =
        [sub(double(corners[0]), p), sub(double(corners[1]), p), sub(double(corners[2]), p)];
    let (offset, u, v) = closest_to_zero([a, b, c]);
    PrimitivePoint {
        point: single(add(p, offset)),
        distance: dot(offset, offset).sqrt() as f32,
        u: u as f32,
        v: v as f32,
    }
}

/// The point of a triangle that is closest to zero, and its surface coordinates. It lies in the box of the triangle, whatever rounding does.
#[inline]
pub(crate) fn closest_to_zero([a, b, c]: [Double3; 3]) -> (Double3, f64, f64) {
    // The plane: the weight of a corner is the area across from it, seen along the normal.
    let (ab, bc, ca) = (sub(b, a), sub(c, b), sub(a, c));
    let normal = cross(ab, sub(c, a));
    let squared = dot(normal, normal);
    let weights = [dot(normal, cross(b, bc)), dot(normal, cross(c, ca)), dot(normal, cross(a, ab))];
    let inside = weights[0] >= 0.0 && weights[1] >= 0.0 && weights[2] >= 0.0;
    let sum = weights[0] + weights[1] + weights[2];
    if inside && squared > 0.0 && sum > 0.0 {
        let offset = scale(dot(normal, a) / squared, normal);
        // Rounding takes it no nearer than a box around the triangle, which may have been left out for that.
        let offset = clamp(offset, min(min(a, b), c), max(max(a, b), c));
        return (offset, weights[1] / sum, weights[2] / sum);
    }

    // The edges.
    let edges = [closest_on_segment(a, b), closest_on_segment(b, c), closest_on_segment(c, a)];
    let squares = [0, 1, 2].map(|i| dot(edges[i].0, edges[i].0));
    let (offset, s) = match squares {
        [x, y, z] if x <= y && x <= z => return (edges[0].0, edges[0].1, 0.0),
        [_, y, z] if y <= z => edges[1],
        _ => return (edges[2].0, 0.0, 1.0 - edges[2].1),
    };
    (offset, 1.0 - s, s)
}

/// The point of the segment from `a` to `b` that is closest to zero, and what share of the way it lies. The same point for the segment from `b` to `a`, to the
/// bit.
#[inline(always)]
fn closest_on_segment(a: Double3, b: Double3) -> (Double3, f64) {
    let swapped = b < a;
    let (from, to) = if swapped { (b, a) } else { (a, b) };
    let edge = sub(to, from);
    let (along, length) = (-dot(from, edge), dot(edge, edge));
    let (point, s) = if along <= 0.0 || length == 0.0 {
        (from, 0.0)
    } else if along >= length {
        (to, 1.0)
    } else {
        let s = along / length;
        (clamp(add(from, scale(s, edge)), min(from, to), max(from, to)), s)
    };
    (point, if swapped { 1.0 - s } else { s })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(point: [f32; 3], corners: [[f32; 3]; 3]) -> PrimitivePoint {
        closest_on_triangle(point.into(), corners.map(Vec3::from))
    }

    const UNIT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn faces_edges_and_corners() {
        let expect = |p, point: [f32; 3], distance, u, v| {
            assert_eq!(at(p, UNIT), PrimitivePoint { point: point.into(), distance, u, v });
        };
        expect([1.0, 2.0, 3.0], [1.0, 2.0, 0.0], 3.0, 0.25, 0.5);
        expect([2.0, -3.0, 4.0], [2.0, 0.0, 0.0], 5.0, 0.5, 0.0);
        expect([-3.0, 3.0, 0.0], [0.0, 3.0, 0.0], 3.0, 0.0, 0.75);
        expect([4.0, 4.0, 0.0], [2.0, 2.0, 0.0], 8.0f32.sqrt(), 0.5, 0.5);
        expect([-3.0, -4.0, 12.0], [0.0, 0.0, 0.0], 13.0, 0.0, 0.0);
        expect([7.0, -4.0, 0.0], [4.0, 0.0, 0.0], 5.0, 1.0, 0.0);
        expect([-3.0, 8.0, 0.0], [0.0, 4.0, 0.0], 5.0, 0.0, 1.0);
    }

    #[test]
    fn points_and_segments() {
        assert_eq!(at([3.0, 4.0, 0.0], [[0.0; 3]; 3]).distance, 5.0);
        let row = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        for corners in [row, [row[1], row[0], row[2]], [row[2], row[1], row[0]]] {
            let closest = at([3.0, 3.0, 4.0], corners);
            assert_eq!((closest.point, closest.distance), (Vec3::new(3.0, 0.0, 0.0), 5.0));
        }
    }
}
