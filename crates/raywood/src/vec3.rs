//! A point or vector of three `f32`, with the few operations that ray tracing needs.

use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Neg, Sub, SubAssign};

/// A point, vector or direction in three dimensions.
///
/// Laid out as three consecutive `f32`, 12 bytes. Where the library takes points it takes `impl Into<[f32; 3]>`, so no maths crate is forced on the caller: arrays
/// do, this type does, and so do the points and vectors of `glam`, `nalgebra` and `mint`. What it gives turns into `[f32; 3]` again, and from there into theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vec3 {
    /// First coordinate.
    pub x: f32,
    /// Second coordinate.
    pub y: f32,
    /// Third coordinate.
    pub z: f32,
}

impl Vec3 {
    /// The origin.
    pub const ZERO: Self = Self::splat(0.0);
    /// One in every coordinate.
    pub const ONE: Self = Self::splat(1.0);
    /// The unit vector along x.
    pub const X: Self = Self::new(1.0, 0.0, 0.0);
    /// The unit vector along y.
    pub const Y: Self = Self::new(0.0, 1.0, 0.0);
    /// The unit vector along z.
    pub const Z: Self = Self::new(0.0, 0.0, 1.0);

    /// The vector `(x, y, z)`.
    #[inline]
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self { x, y, z }
    }

    /// The vector with the same value in every coordinate.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Self::new(value, value, value)
    }

    /// The coordinates as an array.
    #[inline]
    pub const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }

    /// The scalar product.
    #[inline]
    pub fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The vector product.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// The Euclidean length.
    #[inline]
    pub fn length(self) -> f32 {
        self.dot(self).sqrt()
    }

    /// The vector scaled to unit length, whatever its scale; the zero vector when there is no direction to keep
    /// (a zero, infinite or NaN vector).
    #[inline]
    pub fn normalize_or_zero(self) -> Self {
        // The largest coordinate goes to about one first, so that squares neither overflow nor vanish.
        let largest = self.abs().max_element();
        if !(largest > 0.0 && largest.is_finite()) {
            return Self::ZERO;
        }
        let scaled = Self::new(self.x / largest, self.y / largest, self.z / largest);
        scaled / scaled.length()
    }

    /// The smaller of each pair of coordinates; that of `other` where one is NaN.
    #[inline]
    pub fn min(self, other: Self) -> Self {
        // Not `f32::min`, whose care for NaN takes three instructions instead of one.
        let min = |a: f32, b: f32| if a < b { a } else { b };
        Self::new(min(self.x, other.x), min(self.y, other.y), min(self.z, other.z))
    }

    /// The larger of each pair of coordinates; that of `other` where one is NaN.
    #[inline]
    pub fn max(self, other: Self) -> Self {
        let max = |a: f32, b: f32| if a > b { a } else { b };
        Self::new(max(self.x, other.x), max(self.y, other.y), max(self.z, other.z))
    }

    /// The absolute value of each coordinate.
    #[inline]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// The largest coordinate.
    #[inline]
    pub fn max_element(self) -> f32 {
        self.x.max(self.y).max(self.z)
    }

    /// The axis (0, 1 or 2) of the largest coordinate; the first of equals.
    #[inline]
    pub fn max_axis(self) -> usize {
        if self.x >= self.y && self.x >= self.z {
            0
        } else if self.y >= self.z {
            1
        } else {
            2
        }
    }

    /// Whether every coordinate is neither NaN nor infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// Some unit vectors `(s, t)` that make `(s, t, self)` an orthonormal, right-handed basis; `self` is of unit length.
    ///
    /// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
    #[inline]
    pub fn orthonormal_basis(self) -> (Self, Self) {
        let sign = 1f32.copysign(self.z);
        let a = -1.0 / (sign + self.z);
        let b = self.x * self.y * a;
        let s = Self::new(1.0 + sign * self.x * self.x * a, sign * b, -sign * self.x);
        let t = Self::new(b, sign + self.y * self.y * a, -self.y);
        (s, t)
    }
}

impl From<[f32; 3]> for Vec3 {
    #[inline]
    fn from([x, y, z]: [f32; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl From<Vec3> for [f32; 3] {
    #[inline]
    fn from(v: Vec3) -> Self {
        v.to_array()
    }
}

impl Index<usize> for Vec3 {
    type Output = f32;

    #[inline]
    fn index(&self, axis: usize) -> &f32 {
        match axis {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("axis {axis} of a Vec3, which has axes 0, 1 and 2"),
        }
    }
}

impl Add for Vec3 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

/// Product coordinate by coordinate.
impl Mul for Vec3 {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Mul<Vec3> for f32 {
    type Output = Vec3;

    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        v * self
    }
}

impl Div<f32> for Vec3 {
    type Output = Self;

    #[inline]
    fn div(self, divisor: f32) -> Self {
        self * (1.0 / divisor)
    }
}

impl Neg for Vec3 {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl AddAssign for Vec3 {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Vec3 {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign<f32> for Vec3 {
    #[inline]
    fn mul_assign(&mut self, factor: f32) {
        *self = *self * factor;
    }
}
