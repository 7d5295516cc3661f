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

/// The axes in an order in which the first, second or third is last, by that axis and whether the direction runs backwards along it: the others then swap,
/// which keeps the orientation of triangles (Woop, Benthin and Wald 2013).
static AXES: [[usize; 3]; 6] = [[1, 2, 0], [2, 1, 0], [2, 0, 1], [0, 2, 1], [0, 1, 2], [1, 0, 2]];

impl PreparedRay {
    /// Prepares a ray, or tells by `None` that it is not [valid](Ray::is_valid) and so hits nothing.
    #[inline]
    pub fn new(ray: &Ray) -> Option<Self> {
        ray.is_valid().then(|| Self::of_valid(ray))
    }

    /// Prepares a ray that is valid; without branches on the direction, which nobody could predict.
    #[inline(always)]
    pub(crate) fn of_valid(ray: &Ray) -> Self {
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let (dx, dy, dz) = (d[0].abs(), d[1].abs(), d[2].abs());
        let main = usize::from(!(dx >= dy && dx >= dz)) * (1 + usize::from(dy < dz));
        let axes = AXES[2 * main + usize::from(d[main] < 0.0)];
        let [x, y, z] = axes;
        let reciprocal = [1.0 / d[0], 1.0 / d[1], 1.0 / d[2]];
        Self {
            origin: ray.origin,
            direction: ray.direction,
            t_min: ray.t_min,
            t_max: ray.t_max,
            reciprocal: reciprocal.into(),
            entry_corners: [
                usize::from(reciprocal[0] < 0.0),
                usize::from(reciprocal[1] < 0.0),
                usize::from(reciprocal[2] < 0.0),
            ],
            axes,
            permuted_origin: [o[x], o[y], o[z]],
            shear: [d[x] / d[z], d[y] / d[z], reciprocal[z]],
        }
    }

    /// Whether a distance lies in the ray's interval. NaN does not.
    #[inline]
    pub fn accepts(&self, t: f32) -> bool {
        self.t_min <= t && t < self.t_max
    }
}
