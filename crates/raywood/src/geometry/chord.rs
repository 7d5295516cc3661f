//! From where to where a line is inside a convex body, in double precision: balls, infinite cylinders and the space between planes, of which others are put
//! together.

use super::{PreparedRay, PrimitiveHit};
use crate::double::{Double3, cross, dot, double, scale, single_distance, sub};
use crate::{Ray, Vec3};

/// A line: where `t` is zero, and how far it goes per unit of `t`.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) origin: Double3,
    pub(super) direction: Double3,
}

impl Line {
    #[inline(always)]
    pub(super) fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin: double(origin), direction: double(direction) }
    }
}

impl From<&PreparedRay> for Line {
    #[inline(always)]
    fn from(ray: &PreparedRay) -> Self {
        Self::new(ray.origin, ray.direction)
    }
}

impl From<&Ray> for Line {
    #[inline(always)]
    fn from(ray: &Ray) -> Self {
        Self::new(ray.origin, ray.direction)
    }
}

/// The part of a line inside a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    /// Where the line comes in.
    pub(super) enter: f64,
    /// Where it goes out, no less.
    pub(super) leave: f64,
}

impl Chord {
    /// All of a line.
    const WHOLE: Self = Self { enter: f64::NEG_INFINITY, leave: f64::INFINITY };

    /// The part inside a ball. A line that only touches it is outside.
    #[inline]
    pub(super) fn of_ball(line: &Line, center: Double3, radius: f64) -> Option<Self> {
        let d = line.direction;
        // Start from the point of the line nearest the centre: the discriminant is then a difference of small numbers
        // however far away the ball is (Haines et al., Ray Tracing Gems, chapter 7).
        let to_center = sub(center, line.origin);
        let dd = dot(d, d);
        let nearest = dot(to_center, d) / dd;
        let offset = sub(to_center, scale(nearest, d));
        Self::around(nearest, radius * radius - dot(offset, offset), dd)
    }

    /// The part inside a cylinder without ends, around the line through `start` along `axis`, whose length is not zero.
    #[inline]
    pub(super) fn of_tube(line: &Line, start: Double3, axis: Double3, radius: f64) -> Option<Self> {
        // Vector products with the axis leave a ball seen in a plane, as many times larger as the axis is long. Of single-precision directions and axes they are
        // right to one rounding even where both are nearly parallel.
        let aside = cross(line.direction, axis);
        let to_start = cross(sub(start, line.origin), axis);
        let square = radius * radius * dot(axis, axis);
        let aa = dot(aside, aside);
        if aa == 0.0 {
            return (dot(to_start, to_start) < square).then_some(Self::WHOLE);
        }
        let nearest = dot(to_start, aside) / aa;
        let offset = sub(to_start, scale(nearest, aside));
        Self::around(nearest, square - dot(offset, offset), aa)
    }

    /// The part between two parallel planes: where the projection onto `axis` lies between those of `start` and `end`, both included.
    #[inline]
    pub(super) fn between_planes(
        line: &Line,
        axis: Double3,
        start: Double3,
        end: Double3,
    ) -> Option<Self> {
        let speed = dot(line.direction, axis);
        let to_start = dot(sub(start, line.origin), axis);
        let to_end = dot(sub(end, line.origin), axis);
        Self::between(speed, to_start, to_end)
    }

    /// Where something that grows by `speed` per unit of `t` from zero is between two numbers, both included.
    #[inline(always)]
    pub(super) fn between(speed: f64, low: f64, high: f64) -> Option<Self> {
        if speed == 0.0 {
            return (low <= 0.0 && 0.0 <= high).then_some(Self::WHOLE);
        }
        let (to_low, to_high) = (low / speed, high / speed);
        let (enter, leave) = if speed > 0.0 { (to_low, to_high) } else { (to_high, to_low) };
        Some(Self { enter, leave })
    }

    /// The root of `remaining / square` to both sides of a middle, if anything remains.
    #[inline(always)]
    fn around(middle: f64, remaining: f64, square: f64) -> Option<Self> {
        if remaining <= 0.0 || remaining.is_nan() {
            return None;
        }
        let half = (remaining / square).sqrt();
        Some(Self { enter: middle - half, leave: middle + half })
    }

    /// The part inside both bodies.
    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Option<Self> {
        let (enter, leave) = (self.enter.max(other.enter), self.leave.min(other.leave));
        (enter <= leave).then_some(Self { enter, leave })
    }

    /// The part inside a convex body that is made of both.
    #[inline(always)]
    pub(super) fn or(self, other: Self) -> Self {
        Self { enter: self.enter.min(other.enter), leave: self.leave.max(other.leave) }
    }

    /// Of both ends the one that lies at a distance that was told of a hit.
    #[inline]
    pub(super) fn end_at(&self, t: f32) -> f64 {
        let t = f64::from(t);
        if (self.enter - t).abs() <= (self.leave - t).abs() { self.enter } else { self.leave }
    }

    /// The first of both ends that counts for a ray: the far one if it starts inside.
    #[inline(always)]
    pub(super) fn first(&self, ray: &PreparedRay) -> Option<f64> {
        [self.enter, self.leave].into_iter().find(|&t| ray.accepts(single_distance(t)))
    }

    /// Tells of both ends that count for a ray, even where rounding makes them one, so that in and out keep their turns.
    #[inline(always)]
    pub(super) fn all(
        &self,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
        hit: impl Fn(f64) -> PrimitiveHit,
    ) {
        let ends = [self.enter, self.leave].into_iter();
        ends.filter(|&t| ray.accepts(single_distance(t))).for_each(|t| found(hit(t)));
    }
}
