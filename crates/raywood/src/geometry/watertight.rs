//! The watertight ray-triangle test: Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013, with a filter.
//!
//! The triangle is moved so that the ray's origin is at zero and sheared so that the ray runs along z. What is left is a question in the
//! plane: on which side of each edge lies the point zero? Single precision answers where its rounding errors are certainly smaller than
//! the answer, double precision elsewhere. `docs/numerics.md` derives the bounds and tells why no ray slips through.

use super::{PreparedRay, PrimitiveHit};
use crate::Vec3;
use crate::minmax::{larger, smaller};

/// Outside of this range of determinants single precision may have lost digits to underflow or come too near to overflow.
pub(super) const LEAST_DETERMINANT: f32 = 1e-30;
/// See [`LEAST_DETERMINANT`].
pub(super) const GREATEST_DETERMINANT: f32 = 1e30;

/// An edge function's rounding error is at most this times the triangle's reach across the ray times its reach in all.
pub(super) const EDGE_ERROR: f32 = 8.0 * f32::EPSILON;

/// The depth's rounding error is at most this times the reach along the ray, in a triangle of sound shape.
pub(super) const DEPTH_ERROR: f32 = 4.0 * f32::EPSILON;

/// A distance that single precision may have wrong by more than this share of itself is computed again in double.
pub(super) const DISTANCE_TOLERANCE: f32 = 1.0 / 8192.0;

/// The hit of a ray with the triangle `p0 p1 p2`, from either side, edges and vertices included.
#[inline(always)]
pub(super) fn intersect_triangle(
    ray: &PreparedRay,
    p0: Vec3,
    p1: Vec3,
    p2: Vec3,
) -> Option<PrimitiveHit> {
    // Move and shear the vertices.
    let a = shear(ray, p0);
    let b = shear(ray, p1);
    let c = shear(ray, p2);

    // Twice the signed areas that the origin spans with each edge: all of one sign if it lies inside.
    let e0 = c[0] * b[1] - c[1] * b[0];
    let e1 = a[0] * c[1] - a[1] * c[0];
    let e2 = b[0] * a[1] - b[1] * a[0];
    let least = smaller(smaller(e0, e1), e2);
    let greatest = larger(larger(e0, e1), e2);

    // Believe the signs of what is larger than its error; NaN is believed nothing.
    let across = [a[0], a[1], b[0], b[1], c[0], c[1]].into_iter().fold(0.0, larger_abs);
    let along = [a[2], b[2], c[2]].into_iter().fold(0.0, larger_abs);
    let edge_error = EDGE_ERROR * across * (across + along) + f32::MIN_POSITIVE;
    if least < -edge_error && greatest > edge_error {
        return None;
    }
    let determinant = e0 + e1 + e2;
    let certain = least > edge_error || greatest < -edge_error;
    if !(certain && (LEAST_DETERMINANT..=GREATEST_DETERMINANT).contains(&determinant.abs())) {
        return intersect_in_double(ray, [p0, p1, p2]);
    }
    let reciprocal = 1.0 / determinant;
    let (w, u, v) = (e0 * reciprocal, e1 * reciprocal, e2 * reciprocal);
    let z = w * a[2] + u * b[2] + v * c[2];

    // In slivers, at grazing angles and on large triangles nearby, rounding errors of the weights grow with the triangle's
    // reach across the ray, and z may be far off, even on the wrong side of the origin.
    let z_error = DEPTH_ERROR * along * (across * across * reciprocal.abs() + 1.0);
    if z_error > DISTANCE_TOLERANCE * z.abs() {
        return hit_in_double(ray, [p0, p1, p2], u, v);
    }
    let t = z * ray.shear[2];
    ray.accepts(t).then_some(PrimitiveHit { t, u, v })
}

/// The larger of a positive number and the absolute value of another.
#[inline]
fn larger_abs(largest: f32, x: f32) -> f32 {
    if x.abs() > largest { x.abs() } else { largest }
}

/// A vertex in the ray's frame: relative to the origin, sheared so that the ray is the third axis (not yet scaled).
#[inline(always)]
fn shear(ray: &PreparedRay, vertex: Vec3) -> [f32; 3] {
    let vertex = vertex.to_array();
    let [x_axis, y_axis, z_axis] = ray.axes.numbers();
    let [origin_x, origin_y, origin_z] = ray.permuted_origin;
    let x = vertex[x_axis] - origin_x;
    let y = vertex[y_axis] - origin_y;
    let z = vertex[z_axis] - origin_z;
    [x - ray.shear[0] * z, y - ray.shear[1] * z, z]
}

/// The same test in double precision: from the vertices as they are, so that what single precision rounded away is there again.
///
/// Each moved and sheared vertex depends on the vertex and the ray alone, so neighbours agree on it, and each edge function is a
/// difference of two products whose order rounding cannot swap; the neighbour has the same two products the other way round.
#[cold]
#[inline(never)]
fn intersect_in_double(ray: &PreparedRay, corners: [Vec3; 3]) -> Option<PrimitiveHit> {
    let [x, y, z] = ray.axes.numbers();
    let [dx, dy, dz] = [x, y, z].map(|axis| f64::from(ray.direction[axis]));
    let [a, b, c] = corners.map(|corner| {
        let p = |axis: usize| f64::from(corner[axis]) - f64::from(ray.origin[axis]);
        [p(x) - dx / dz * p(z), p(y) - dy / dz * p(z)]
    });
    let e0 = c[0] * b[1] - c[1] * b[0];
    let e1 = a[0] * c[1] - a[1] * c[0];
    let e2 = b[0] * a[1] - b[1] * a[0];
    if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) && (e0 > 0.0 || e1 > 0.0 || e2 > 0.0) {
        return None;
    }
    // Zero: the triangle is seen edge-on or has no area.
    let determinant = e0 + e1 + e2;
    if determinant == 0.0 {
        return None;
    }
    hit_in_double(ray, corners, (e1 / determinant) as f32, (e2 / determinant) as f32)
}

/// The hit of a ray that passes inside a triangle, its distance from the plane's equation in double precision.
#[cold]
#[inline(never)]
fn hit_in_double(ray: &PreparedRay, corners: [Vec3; 3], u: f32, v: f32) -> Option<PrimitiveHit> {
    let double = |p: Vec3| p.to_array().map(f64::from);
    let sub = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let [p0, p1, p2] = corners.map(double);
    let (e, f) = (sub(p1, p0), sub(p2, p0));
    let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let t = (dot(normal, sub(p0, double(ray.origin))) / dot(normal, double(ray.direction))) as f32;
    ray.accepts(t).then_some(PrimitiveHit { t, u, v })
}
