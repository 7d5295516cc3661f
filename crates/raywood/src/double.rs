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

#[inline(always)]
pub(crate) fn dot(a: Double3, b: Double3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross(a: Double3, b: Double3) -> Double3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
