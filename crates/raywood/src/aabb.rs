//! The axis-aligned bounding box.

use crate::Vec3;
use crate::double::dot;

/// An axis-aligned box, corners included. Empty when `min` exceeds `max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing: joining it with another gives the other.
    pub const EMPTY: Self =
        Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    /// The box with the given corners.
    #[inline]
    pub fn new(min: impl Into<[f32; 3]>, max: impl Into<[f32; 3]>) -> Self {
        Self { min: Vec3::from(min.into()), max: Vec3::from(max.into()) }
    }

    /// The smallest box around some points.
    #[inline]
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// The smallest box around this one and a point.
    #[inline]
    pub fn including(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around this one and another.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The part that both boxes share; empty if there is none.
    #[inline]
    pub fn intersection(self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether the box holds no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether all corners are finite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Whether the other box lies inside this one, touching allowed. The empty box lies in every box.
    #[inline]
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty()
            || (self.min.x <= other.min.x
                && self.min.y <= other.min.y
                && self.min.z <= other.min.z
                && other.max.x <= self.max.x
                && other.max.y <= self.max.y
                && other.max.z <= self.max.z)
    }

    /// The lengths of the edges; negative on an axis where the box is empty.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// The centre. Does not overflow.
    #[inline]
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The length of the diagonal, zero when empty.
    #[inline]
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.extent().length() }
    }

    /// How far a point is from the box, zero inside; computed in double precision and rounded once. Not of an empty box.
    #[inline]
    pub(crate) fn distance(&self, point: Vec3) -> f32 {
        let beside = |axis: usize| {
            let [min, max, p] = [self.min[axis], self.max[axis], point[axis]].map(f64::from);
            (min - p).max(p - max).max(0.0)
        };
        let gaps = [beside(0), beside(1), beside(2)];
        dot(gaps, gaps).sqrt() as f32
    }

    /// The same box with what lies at infinity brought back to the largest numbers, so that differences of its coordinates are numbers; `None` if it is empty or has NaN.
    pub(crate) fn as_region(&self) -> Option<Self> {
        let finite = |v: Vec3| v.max(Vec3::splat(f32::MIN)).min(Vec3::splat(f32::MAX));
        (!self.is_empty()).then(|| Self { min: finite(self.min), max: finite(self.max) })
    }

    /// Half the surface area, zero when empty, in double precision, where no finite box overflows or vanishes. Ratios of areas are all
    /// that cost estimates need.
    #[inline]
    pub fn half_area(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        // Not `map`, which the compiler does not always inline.
        let edge = |axis: usize| f64::from(self.max[axis]) - f64::from(self.min[axis]);
        let (x, y, z) = (edge(0), edge(1), edge(2));
        x * y + y * z + z * x
    }
}
