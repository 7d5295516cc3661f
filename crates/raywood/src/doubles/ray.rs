//! The ray in double precision.

use crate::double::{add, largest_magnitude, scale, sub};

/// A ray `origin + t * direction` for `t_min <= t < t_max`, in double precision.
///
/// As a [`Ray`](crate::Ray): distances `t` are in units of the direction's length, which need not be one, and a ray that is not [valid](Ray64::is_valid) hits
/// nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray64 {
    /// Where the ray starts.
    pub origin: [f64; 3],
    /// The smallest distance that counts as a hit.
    pub t_min: f64,
    /// Where it goes; any length but zero.
    pub direction: [f64; 3],
    /// The distance from which on hits no longer count; may be infinite.
    pub t_max: f64,
}

impl Ray64 {
    /// The ray from `origin` along `direction`, `0 <= t < infinity`.
    #[inline]
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f64::INFINITY }
    }

    /// The ray from one point to another: `t` is 0 at `from` and 1 at `to`, which itself no longer counts.
    #[inline]
    pub fn between(from: [f64; 3], to: [f64; 3]) -> Self {
        Self { origin: from, t_min: 0.0, direction: sub(to, from), t_max: 1.0 }
    }

    /// As [`between`](Self::between), but ends a little before `to`, at [`SHORT_END`](Self::SHORT_END), so that a surface that this lies on does not count.
    #[inline]
    pub fn short_of(from: [f64; 3], to: [f64; 3]) -> Self {
        Self::between(from, to).with_interval(0.0, Self::SHORT_END)
    }

    /// Where rays end that stop [a little before](Self::short_of) the point that they go to: a millionth of the way.
    pub const SHORT_END: f64 = 1.0 - 1.0 / (1 << 20) as f64;

    /// The same ray over another interval, `t_min <= t < t_max`.
    #[inline]
    pub fn with_interval(self, t_min: f64, t_max: f64) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f64) -> [f64; 3] {
        add(self.origin, scale(t, self.direction))
    }

    /// Whether the ray can hit anything: no coordinate NaN or beyond [`GREATEST`](Self::GREATEST), the direction's largest no smaller than one over
    /// that, the interval free of NaN and not empty.
    #[inline]
    pub fn is_valid(&self) -> bool {
        // One by one: the largest may hide a NaN.
        let is_usual = |x: &f64| x.abs() <= Self::GREATEST;
        self.origin.iter().all(is_usual)
            && self.direction.iter().all(is_usual)
            && largest_magnitude(self.direction) >= 1.0 / Self::GREATEST
            && self.t_min < self.t_max
    }

    /// No coordinate of a ray or a mesh may be larger: products of six of them have to be numbers, too.
    pub const GREATEST: f64 = 1e45;
}
