//! The watertight ray-triangle test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013.
//!
//! The triangle is moved so that the ray's origin is at zero and sheared so that the ray runs along z. What is left
//! is a question in the plane: on which side of each edge lies the point zero? Two triangles that share an edge
//! compute the same two products for it, so they never both say "outside". `docs/numerics.md` has the argument, and
//! derives the bounds.

use super::{PreparedRay, PrimitiveHit};
use crate::Vec3;

/// Outside of this range of determinants single precision may have lost digits to underflow or come too near to overflow.
const TRUSTED_DETERMINANTS: std::ops::RangeInclusive<f32> = 1e-30..=1e30;

/// A distance that single precision may have wrong by more than this share of itself is computed again in double.
const DISTANCE_TOLERANCE: f32 = 1.0 / 8192.0;

/// The hit of a ray with the triangle `p0 p1 p2`, from either side, edges and vertices included.
#[inline(always)]
pub(super) fn intersect_triangle(
    ray: &PreparedRay,
    p0: Vec3,
    p1: Vec3,
    p2: Vec3,
) -> Option<PrimitiveHit> {
    // Move and shear the vertices. Each depends on its vertex and the ray alone, so neighbours agree on it.
    let a = shear(ray, p0);
    let b = shear(ray, p1);
    let c = shear(ray, p2);

    // Twice the signed areas that the origin spans with each edge. The sign of a difference of two rounded products
    // is right unless it is zero, for rounding never swaps the order of two numbers.
    let e0 = c[0] * b[1] - c[1] * b[0];
    let e1 = a[0] * c[1] - a[1] * c[0];
    let e2 = b[0] * a[1] - b[1] * a[0];
    if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) && (e0 > 0.0 || e1 > 0.0 || e2 > 0.0) {
        return None;
    }

    // Where single precision cannot tell the side (a zero, an overflow, digits lost to underflow), double precision can.
    let determinant = e0 + e1 + e2;
    let no_edge_is_zero = e0 != 0.0 && e1 != 0.0 && e2 != 0.0;
    if !(no_edge_is_zero && TRUSTED_DETERMINANTS.contains(&determinant.abs())) {
        let (u, v) = weights_in_double(a, b, c)?;
        return hit_in_double(ray, [p0, p1, p2], u, v);
    }
    let reciprocal = 1.0 / determinant;
    let (w, u, v) = (e0 * reciprocal, e1 * reciprocal, e2 * reciprocal);
    let z = w * a[2] + u * b[2] + v * c[2];

    // In slivers, at grazing angles and on large triangles nearby, rounding errors of the weights grow with the triangle's
    // reach across the ray, and z may be far off, even on the wrong side of the origin.
    let across = [a[0], a[1], b[0], b[1], c[0], c[1]].into_iter().fold(0.0, larger_abs);
    let along = [a[2], b[2], c[2]].into_iter().fold(0.0, larger_abs);
    let z_error = 4.0 * f32::EPSILON * along * (across * across * reciprocal.abs() + 1.0);
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
    let [x_axis, y_axis, z_axis] = ray.axes;
    let [origin_x, origin_y, origin_z] = ray.permuted_origin;
    let x = vertex[x_axis] - origin_x;
    let y = vertex[y_axis] - origin_y;
    let z = vertex[z_axis] - origin_z;
    [x - ray.shear[0] * z, y - ray.shear[1] * z, z]
}

/// The barycentric weights of the second and third vertex, from the vertices in the ray's frame, or `None` if the ray passes
/// outside. In double precision the products are exact and so the signs are.
#[cold]
#[inline(never)]
fn weights_in_double(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> Option<(f32, f32)> {
    let [a, b, c] = [a, b, c].map(|p| p.map(f64::from));
    let e0 = c[0] * b[1] - c[1] * b[0];
    let e1 = a[0] * c[1] - a[1] * c[0];
    let e2 = b[0] * a[1] - b[1] * a[0];
    if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) && (e0 > 0.0 || e1 > 0.0 || e2 > 0.0) {
        return None;
    }
    // Zero: the triangle is seen edge-on or has no area. NaN: coordinates too large even for this.
    let determinant = e0 + e1 + e2;
    let sound = determinant.abs() > 0.0 && determinant.is_finite();
    sound.then(|| ((e1 / determinant) as f32, (e2 / determinant) as f32))
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
