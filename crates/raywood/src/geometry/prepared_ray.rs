//! A ray with everything that many box and primitive tests would otherwise compute again.

use crate::{Ray, Vec3};

/// A valid [`Ray`] together with what depends on it alone.
///
/// Traversals make one per ray and do not change it: what a ray hits of one primitive never depends on the others.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay {
    /// Where the ray starts.
    pub origin: Vec3,
    /// Where it goes.
    pub direction: Vec3,
    /// The smallest distance that counts.
    pub t_min: f32,
    /// The distance from which on hits no longer count.
    pub t_max: f32,
    /// One over each coordinate of the direction; infinite where that is zero.
    pub reciprocal: Vec3,
    /// Which corner of a box the ray's entry planes belong to, per axis: 0 the one of smallest coordinates, 1 the other.
    pub(crate) entry_corners: [usize; 3],
    /// The axes in an order in which the last is the direction's largest and the triangle's orientation is kept.
    pub(super) axes: [usize; 3],
    /// The origin with its coordinates in that order.
    pub(super) permuted_origin: [f32; 3],
    /// The shear that takes the direction to `(0, 0, 1)`: slopes along the first two axes, scale along the last.
    pub(super) shear: [f32; 3],
}

impl PreparedRay {
    /// Prepares a ray, or tells by `None` that it is not [valid](Ray::is_valid) and so hits nothing.
    #[inline]
    pub fn new(ray: &Ray) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let d = ray.direction;

        // Woop, Benthin and Wald 2013: the largest axis becomes z; the other two swap when it points backwards,
        // which keeps the orientation of triangles.
        let z = d.abs().max_axis();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let reciprocal = Vec3::new(1.0 / d.x, 1.0 / d.y, 1.0 / d.z);
        Some(Self {
            origin: ray.origin,
            direction: d,
            t_min: ray.t_min,
            t_max: ray.t_max,
            reciprocal,
            entry_corners: reciprocal.to_array().map(|r| usize::from(r < 0.0)),
            axes: [x, y, z],
            permuted_origin: [ray.origin[x], ray.origin[y], ray.origin[z]],
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        })
    }

    /// Whether a distance lies in the ray's interval. NaN does not.
    #[inline]
    pub fn accepts(&self, t: f32) -> bool {
        self.t_min <= t && t < self.t_max
    }
}
