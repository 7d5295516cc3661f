//! The ray: an origin, a direction and the interval of distances that count.

use crate::Vec3;

/// A ray `origin + t * direction` for `t_min <= t < t_max`.
///
/// Distances `t` are in units of the direction's length, which need not be one. A ray that is not
/// [valid](Ray::is_valid) hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: Vec3,
    /// The smallest distance that counts as a hit.
    pub t_min: f32,
    /// Where it goes; any length but zero.
    pub direction: Vec3,
    /// The distance from which on hits no longer count; may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// The ray from `origin` along `direction`, `0 <= t < infinity`.
    #[inline]
    pub fn new(origin: impl Into<[f32; 3]>, direction: impl Into<[f32; 3]>) -> Self {
        Self {
            origin: Vec3::from(origin.into()),
            t_min: 0.0,
            direction: Vec3::from(direction.into()),
            t_max: f32::INFINITY,
        }
    }

    /// The ray from one point to another: `t` is 0 at `from` and 1 at `to`, which itself no longer counts.
    #[inline]
    pub fn between(from: impl Into<[f32; 3]>, to: impl Into<[f32; 3]>) -> Self {
        let from = Vec3::from(from.into());
        Self { origin: from, t_min: 0.0, direction: Vec3::from(to.into()) - from, t_max: 1.0 }
    }

    /// As [`between`](Self::between), but ends a 4096th of the way before `to`, so that a surface that this lies on does not count.
    #[inline]
    pub fn short_of(from: impl Into<[f32; 3]>, to: impl Into<[f32; 3]>) -> Self {
        Self::between(from, to).with_interval(0.0, Self::SHORT_END)
    }

    /// Where rays end that stop [a little before](Self::short_of) the point that they go to.
    pub const SHORT_END: f32 = 1.0 - 1.0 / 4096.0;

    /// The same ray over another interval, `t_min <= t < t_max`.
    #[inline]
    pub fn with_interval(self, t_min: f32, t_max: f32) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// Whether the ray can hit anything: origin and direction finite, the direction's largest coordinate at least
    /// [`Ray::SHORTEST_DIRECTION`], the interval free of NaN and not empty.
    #[inline]
    pub fn is_valid(&self) -> bool {
        let largest = self.direction.abs().max_element();
        self.origin.is_finite()
            && self.direction.is_finite()
            && largest >= Self::SHORTEST_DIRECTION
            && self.t_min < self.t_max
    }

    /// No ray: not valid.
    pub(crate) const NONE: Self =
        Self { origin: Vec3::ZERO, t_min: f32::NAN, direction: Vec3::ZERO, t_max: f32::NAN };

    /// Directions whose largest coordinate is less than this count as zero. Coordinates whose reciprocal overflows (below 3e-39) are then
    /// too small beside the largest to matter.
    pub const SHORTEST_DIRECTION: f32 = 1e-30;
}
