//! Minimum and maximum as one instruction finds them: `f32::min` and `f32::max` take three, for their care of NaN.

/// The smaller number; the second where one is NaN.
#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger number; the second where one is NaN.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
