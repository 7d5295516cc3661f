//! The watertight ray-triangle test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2013.
//!
//! The triangle is moved so that the ray's origin is at zero and sheared so that the ray runs along z. What is left
//! is a question in the plane: on which side of each edge lies the point zero? Two triangles that share an edge
//! compute the same two products for it, so they never both say "outside". `docs/numerics.md` has the argument.

use super::{PreparedRay, PrimitiveHit};
use crate::Vec3;

/// Outside of this range of determinants single precision may have lost digits to underflow or come too near to overflow.
const TRUSTED_DETERMINANTS: std::ops::RangeInclusive<f32> = 1e-30..=1e30;

/// The hit of a ray with the triangle `p0 p1 p2`, from either side, edges and vertices included.
#[inline]
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
    let determinant = e0 + e1 + e2;

    // Where single precision cannot tell (a zero, an overflow, digits lost to underflow), double precision can.
    let no_edge_is_zero = e0 != 0.0 && e1 != 0.0 && e2 != 0.0;
    let in_range = TRUSTED_DETERMINANTS.contains(&determinant.abs());
    if !(no_edge_is_zero && in_range) {
        return intersect_in_double(ray, a, b, c);
    }

    let reciprocal = 1.0 / determinant;
    let (w, u, v) = (e0 * reciprocal, e1 * reciprocal, e2 * reciprocal);
    let t = (w * a[2] + u * b[2] + v * c[2]) * ray.shear[2];
    ray.accepts(t).then_some(PrimitiveHit { t, u, v })
}

/// A vertex in the ray's frame: relative to the origin, sheared so that the ray is the third axis (not yet scaled).
#[inline(always)]
fn shear(ray: &PreparedRay, vertex: Vec3) -> [f32; 3] {
    let vertex = vertex.to_array();
    let [x, y, z] = [0, 1, 2].map(|i| vertex[ray.axes[i]] - ray.permuted_origin[i]);
    [x - ray.shear[0] * z, y - ray.shear[1] * z, z]
}

/// The same test in double precision, where the products are exact and so the signs are.
#[cold]
#[inline(never)]
fn intersect_in_double(
    ray: &PreparedRay,
    a: [f32; 3],
    b: [f32; 3],
    c: [f32; 3],
) -> Option<PrimitiveHit> {
    let [a, b, c] = [a, b, c].map(|p| p.map(f64::from));
    let e0 = c[0] * b[1] - c[1] * b[0];
    let e1 = a[0] * c[1] - a[1] * c[0];
    let e2 = b[0] * a[1] - b[1] * a[0];
    if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) && (e0 > 0.0 || e1 > 0.0 || e2 > 0.0) {
        return None;
    }

    // Zero: the triangle is seen edge-on or has no area. NaN: coordinates too large even for this.
    let determinant = e0 + e1 + e2;
    if !(determinant.abs() > 0.0 && determinant.is_finite()) {
        return None;
    }
    let t = ((e0 * a[2] + e1 * b[2] + e2 * c[2]) * f64::from(ray.shear[2]) / determinant) as f32;
    let (u, v) = ((e1 / determinant) as f32, (e2 / determinant) as f32);
    ray.accepts(t).then_some(PrimitiveHit { t, u, v })
}
