//! Whether triangles reach into convex regions, by clipping in double precision: Sutherland and Hodgman 1974.

use raywood::{Aabb, Vec3};

use crate::oracle::{Point, cross, dot, double, length, sub};

/// Whether a part of the triangle lies where `normal . p + offset >= 0` for all planes. Touching counts as far as rounding lets it.
pub fn triangle_in_planes(corners: [Vec3; 3], planes: &[(Point, f64)]) -> bool {
    polygon_in_planes(&corners.map(double), planes)
}

/// The same of a triangle of double precision, or of any convex polygon.
pub fn polygon_in_planes(corners: &[Point], planes: &[(Point, f64)]) -> bool {
    let mut polygon = corners.to_vec();
    for &(normal, offset) in planes {
        let height = |p: Point| dot(normal, p) + offset;
        let mut clipped = Vec::new();
        for (number, &p) in polygon.iter().enumerate() {
            let q = polygon[(number + 1) % polygon.len()];
            let (h, k) = (height(p), height(q));
            if h >= 0.0 {
                clipped.push(p);
            }
            if (h < 0.0) != (k < 0.0) {
                let s = h / (h - k);
                clipped.push([0, 1, 2].map(|i| p[i] + s * (q[i] - p[i])));
            }
        }
        polygon = clipped;
    }
    !polygon.is_empty()
}

/// The planes of a box, that is larger by `margin` on all sides.
pub fn planes_of(region: &Aabb, margin: f64) -> Vec<(Point, f64)> {
    let axis = |axis: usize, sign: f64| [0, 1, 2].map(|i| if i == axis { sign } else { 0.0 });
    let (min, max) = (double(region.min), double(region.max));
    (0..3)
        .flat_map(|i| [(axis(i, 1.0), margin - min[i]), (axis(i, -1.0), margin + max[i])])
        .collect()
}

/// The planes around a triangle of sound shape, `across` away from its own plane on both sides and `beside` outside of its edges.
pub fn planes_around(corners: [Vec3; 3], across: f64, beside: f64) -> Vec<(Point, f64)> {
    planes_around_triangle(corners.map(double), across, beside)
}

/// The same of a triangle of double precision.
pub fn planes_around_triangle(
    [a, b, c]: [Point; 3],
    across: f64,
    beside: f64,
) -> Vec<(Point, f64)> {
    let unit = |v: Point| v.map(|x| x / length(v));
    let normal = unit(cross(sub(b, a), sub(c, a)));
    let back = normal.map(|x| -x);
    let mut planes = vec![(normal, across - dot(normal, a)), (back, across - dot(back, a))];
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let inwards = unit(cross(normal, sub(to, from)));
        planes.push((inwards, beside - dot(inwards, from)));
    }
    planes
}
