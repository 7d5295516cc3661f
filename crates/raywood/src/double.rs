//! Vectors in double precision, where differences and products of single-precision coordinates lose next to nothing.

use crate::Vec3;

/// A point or vector.
pub(crate) type Double3 = [f64; 3];

/// The same in double precision.
#[inline(always)]
pub(crate) fn double(v: Vec3) -> Double3 {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

/// The nearest in single precision.
#[inline(always)]
pub(crate) fn single(v: Double3) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

#[inline(always)]
pub(crate) fn add(a: Double3, b: Double3) -> Double3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn sub(a: Double3, b: Double3) -> Double3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn scale(factor: f64, v: Double3) -> Double3 {
    [factor * v[0], factor * v[1], factor * v[2]]
}

/// The smaller of each two coordinates.
#[inline(always)]
pub(crate) fn min(a: Double3, b: Double3) -> Double3 {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].min(b[2])]
}

/// The larger of each two coordinates.
#[inline(always)]
pub(crate) fn max(a: Double3, b: Double3) -> Double3 {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])]
}

/// The point of a box that is closest to `v`.
#[inline(always)]
pub(crate) fn clamp(v: Double3, least: Double3, greatest: Double3) -> Double3 {
    min(max(v, least), greatest)
}

#[inline(always)]
pub(crate) fn dot(a: Double3, b: Double3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: Double3, b: Double3) -> Double3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A distance along a ray in single precision. One that is not zero keeps its side of the origin: that decides between in and out.
#[inline(always)]
pub(crate) fn single_distance(t: f64) -> f32 {
    let rounded = t as f32;
    if t == 0.0 || rounded != 0.0 { rounded } else { f32::from_bits(1).copysign(rounded) }
}

/// The point of the segment from `start` that goes on by `axis`, that is closest to `point`, as a share of the way; zero if it has no length.
#[inline]
pub(crate) fn share_along(point: Double3, start: Double3, axis: Double3) -> f64 {
    let (along, length) = (dot(sub(point, start), axis), dot(axis, axis));
    if along <= 0.0 || length == 0.0 { 0.0 } else { (along / length).min(1.0) }
}

/// A vector of unit length, or the other one, which is, if it has no length.
#[inline]
pub(crate) fn unit_or(v: Double3, other: Double3) -> Double3 {
    let length = dot(v, v).sqrt();
    if length > 0.0 { scale(1.0 / length, v) } else { other }
}

/// Some unit vector across an axis, which need not be of unit length; one along x if it has none.
pub(crate) fn some_unit_across(axis: Double3) -> Double3 {
    // Across it and the coordinate axis that it is farthest from.
    let smallest = (0..3).min_by(|&i, &j| axis[i].abs().total_cmp(&axis[j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[smallest] = 1.0;
    unit_or(cross(axis, other), [1.0, 0.0, 0.0])
}

/// The largest coordinate without its sign. Not for NaN, which may be taken for nothing.
#[inline(always)]
pub(crate) fn largest_magnitude(v: Double3) -> f64 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}
