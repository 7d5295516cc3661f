//! The answer to a closest-hit query in double precision.

use crate::hit::RayHit;

/// Where a ray first meets a [`TriangleMesh64`](crate::TriangleMesh64).
///
/// `t` is off the exact distance by less than 1e-12 of itself, and `u` and `v` by less than 1e-12, whatever the triangle's coordinates and the ray's
/// length are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit64 {
    /// Distance along the ray, in units of the direction's length; `t_min <= t < t_max`.
    pub t: f64,
    /// The barycentric weight of `p1`: `p = (1-u-v) p0 + u p1 + v p2`. From 0 to 1.
    pub u: f64,
    /// The barycentric weight of `p2`. From 0 to 1.
    pub v: f64,
    /// Which triangle; at exactly equal `t` the lowest number wins.
    pub primitive: u32,
}

impl RayHit for Hit64 {
    type Distance = f64;

    #[inline(always)]
    fn distance(&self) -> f64 {
        self.t
    }

    #[inline(always)]
    fn numbers(&self) -> (u32, u32) {
        (0, self.primitive)
    }
}
