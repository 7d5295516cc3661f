//! The frame of a surface, and directions distributed in it.

use std::f32::consts::FRAC_PI_4;

use raywood::Vec3;

/// An orthonormal basis whose z is a normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingFrame {
    s: Vec3,
    t: Vec3,
    n: Vec3,
}

impl ShadingFrame {
    /// The frame around a normal of unit length.
    #[inline]
    pub(crate) fn around(normal: Vec3) -> Self {
        let (s, t) = normal.orthonormal_basis();
        Self { s, t, n: normal }
    }

    /// A direction of the world in this frame.
    #[inline]
    pub(crate) fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// A direction of this frame in the world.
    #[inline]
    pub(crate) fn to_world(self, v: Vec3) -> Vec3 {
        v.x * self.s + v.y * self.t + v.z * self.n
    }
}

/// A direction around z distributed like the cosine, whose density is `z / pi`: a point of the disk, lifted (Malley's method).
#[inline]
pub(crate) fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let [x, y] = disk(u);
    Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// A point of the unit disk, evenly distributed and without tearing neighbours apart: Shirley and Chiu, "A Low Distortion Map Between Disk and
/// Square", 1997.
#[inline]
pub(crate) fn disk(u: [f32; 2]) -> [f32; 2] {
    let [x, y] = u.map(|u| 2.0 * u - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0; 2];
    }
    let (radius, angle) = if x.abs() > y.abs() {
        (x, FRAC_PI_4 * (y / x))
    } else {
        (y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (x / y))
    };
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}
