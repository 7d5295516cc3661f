//! Rays that certainly leave the plane of a triangle: what shadow rays do with the triangle that they start on, and with its neighbours.
//!
//! They begin so close to these that the packet, which measures depths from the light, cannot tell on which side. Where the ray begins and where it goes can
//! be told apart much better by the ray itself.

use crate::{Ray, Vec3};

/// The plane of a triangle, in double precision.
pub(super) struct Plane {
    normal: [f64; 3],
    corner: [f64; 3],
    /// The size of the normal.
    size: f64,
}

/// What is computed here is off by less than this share of its largest term: a few roundings of double precision.
const ERROR: f64 = 1e-13;

impl Plane {
    pub(super) fn of([a, b, c]: [Vec3; 3]) -> Self {
        let [a, b, c] = [a, b, c].map(wide);
        // Differences of single numbers are rounded in their last double digit, if at all.
        let (u, v) = (minus(b, a), minus(c, a));
        let normal =
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        Self { normal, corner: a, size: length(u) * length(v) }
    }

    /// Whether the ray starts beside the plane and goes away from it, beyond all doubt.
    #[inline]
    pub(super) fn is_left_by(&self, ray: &Ray) -> bool {
        let direction = wide(ray.direction);
        let start = minus(wide(ray.origin), self.corner);
        let (height, rise) = (dot(self.normal, start), dot(self.normal, direction));
        let certain = |value: f64, vector| value.abs() > ERROR * self.size * length(vector);
        height * rise > 0.0 && certain(height, start) && certain(rise, direction)
    }
}

#[inline]
fn wide(v: Vec3) -> [f64; 3] {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

#[inline]
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The sum of the coordinates' sizes: at least the length.
#[inline]
fn length(v: [f64; 3]) -> f64 {
    v[0].abs() + v[1].abs() + v[2].abs()
}
