//! The frame of a surface, and directions distributed in it.

use std::f32::consts::FRAC_PI_4;

use raywood::Vec3;

use crate::sines::sin_cos_of_eighth;

/// An orthonormal basis whose z is a normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingFrame {
    pub(crate) s: Vec3,
    pub(crate) t: Vec3,
    pub(crate) n: Vec3,
}

impl ShadingFrame {
    /// The frame around a normal of unit length.
    #[inline(always)]
    pub(crate) fn around(normal: Vec3) -> Self {
        let (s, t) = normal.orthonormal_basis();
        Self { s, t, n: normal }
    }

    /// A direction of the world in this frame.
    #[inline(always)]
    pub(crate) fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// A direction of this frame in the world.
    #[inline(always)]
    pub(crate) fn to_world(self, v: Vec3) -> Vec3 {
        v.x * self.s + v.y * self.t + v.z * self.n
    }
}

/// A direction around z distributed like the cosine, whose density is `z / pi`: a point of the disk, lifted (Malley's method).
#[inline(always)]
pub(crate) fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let [x, y] = disk(u);
    let left = 1.0 - x * x - y * y;
    Vec3::new(x, y, if left > 0.0 { left.sqrt() } else { 0.0 })
}

/// A point of the unit disk, evenly distributed and without tearing neighbours apart: Shirley and Chiu, "A Low Distortion Map Between Disk and
/// Square", 1997. Without branches, as all here, so that a loop over many becomes vectors.
#[inline(always)]
pub(crate) fn disk([u, v]: [f32; 2]) -> [f32; 2] {
    let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let is_wide = x.abs() > y.abs();
    let (radius, other) = if is_wide { (x, y) } else { (y, x) };
    let ratio = if radius == 0.0 { 0.0 } else { other / radius };
    // From the axis that is nearer.
    let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * ratio);
    let (along, across) = (radius * cos, radius * sin);
    if is_wide { [along, across] } else { [across, along] }
}
