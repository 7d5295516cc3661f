//! Numbers of twice the precision, as unevaluated sums of two, and signs that are exact: Dekker, "A Floating-Point Technique for Extending the Available
//! Precision", 1971; Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997.

use std::ops::{Add, Mul, Neg, Sub};

/// `high + low`, where `low` is no more than half a unit in the last place of `high`: 106 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twofold {
    pub(super) high: f64,
    pub(super) low: f64,
}

/// The rounded sum of two numbers, and its error.
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// The rounded product of two numbers, and its error.
#[inline(always)]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

impl Twofold {
    /// `a - b`, exactly.
    #[inline(always)]
    pub(super) fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// `a * b`, exactly.
    #[inline(always)]
    pub(super) fn product(a: f64, b: f64) -> Self {
        let (high, low) = two_product(a, b);
        Self { high, low }
    }

    /// The sum of a number and a much smaller one.
    #[inline(always)]
    fn renormalized(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// `self / other`, rounded to one number: off by hardly more than that rounding.
    #[inline(always)]
    pub(super) fn ratio(self, other: Self) -> f64 {
        let estimate = self.high / other.high;
        let rest = self - other * estimate;
        estimate + rest.high / other.high
    }
}

impl Add for Twofold {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, small) = two_sum(self.low, other.low);
        let first = Self::renormalized(high, error + low);
        Self::renormalized(first.high, first.low + small)
    }
}

impl Neg for Twofold {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Twofold {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        Self::renormalized(high, error + (self.high * other.low + self.low * other.high))
    }
}

impl Mul<f64> for Twofold {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        let (high, error) = two_product(self.high, factor);
        Self::renormalized(high, error + self.low * factor)
    }
}

/// `a b - c d`.
#[inline(always)]
pub(super) fn difference_of_products(a: Twofold, b: Twofold, c: Twofold, d: Twofold) -> Twofold {
    a * b - c * d
}

/// The vector product.
#[inline(always)]
pub(super) fn cross(a: [Twofold; 3], b: [Twofold; 3]) -> [Twofold; 3] {
    [
        difference_of_products(a[1], b[2], a[2], b[1]),
        difference_of_products(a[2], b[0], a[0], b[2]),
        difference_of_products(a[0], b[1], a[1], b[0]),
    ]
}

/// The scalar product.
#[inline(always)]
pub(super) fn dot(a: [Twofold; 3], b: [Twofold; 3]) -> Twofold {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// What [`difference_of_products`] may be off by, as a share of its larger product; with room to spare.
const DIFFERENCE_ERROR: f64 = 1.0 / (1u128 << 96) as f64;

/// The sign of `a b - c d`, exactly: -1, 0 or 1. That of `c d - a b` is the opposite one.
pub(super) fn sign_of_difference(a: Twofold, b: Twofold, c: Twofold, d: Twofold) -> i32 {
    let (first, second) = (a * b, c * d);
    let difference = first - second;
    let largest = first.high.abs().max(second.high.abs());
    if difference.high.abs() > DIFFERENCE_ERROR * largest {
        return if difference.high > 0.0 { 1 } else { -1 };
    }

    // All parts of both products, added without rounding.
    let mut sum = Expansion::default();
    for (one, other, sign) in [(a, b, 1.0), (c, d, -1.0)] {
        for (x, y) in [
            (one.low, other.low),
            (one.low, other.high),
            (one.high, other.low),
            (one.high, other.high),
        ] {
            let (product, error) = two_product(x, y);
            sum.add(sign * error);
            sum.add(sign * product);
        }
    }
    sum.sign()
}

/// The sign of `a - b`, exactly.
#[inline(always)]
pub(super) fn sign_between(a: Twofold, b: Twofold) -> i32 {
    const ONE: Twofold = Twofold { high: 1.0, low: 0.0 };
    sign_of_difference(a, ONE, b, ONE)
}

/// A sum of up to sixteen numbers as parts that do not overlap, the smallest first.
#[derive(Default)]
struct Expansion {
    parts: [f64; 16],
    count: usize,
}

impl Expansion {
    /// Adds a number.
    fn add(&mut self, number: f64) {
        let mut rest = number;
        for part in &mut self.parts[..self.count] {
            (rest, *part) = two_sum(rest, *part);
        }
        self.parts[self.count] = rest;
        self.count += 1;
    }

    /// The sign of the sum: that of its largest part.
    fn sign(&self) -> i32 {
        let largest = self.parts[..self.count].iter().rev().find(|&&part| part != 0.0);
        largest.map_or(0, |&part| if part > 0.0 { 1 } else { -1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(high: f64, low: f64) -> Twofold {
        Twofold { high, low }
    }

    #[test]
    fn a_third_times_three_is_one_to_a_hundred_bits() {
        let one = number(1.0, 0.0);
        let third = number(1.0 / 3.0, (1.0 / 3.0f64).mul_add(-3.0, 1.0) / 3.0);
        let rest = third * number(3.0, 0.0) - one;
        assert!(rest.high.abs() < 1e-31, "{rest:?}");
        assert_eq!(one.ratio(number(3.0, 0.0)), 1.0 / 3.0);
        let sum = Twofold::difference(1.0, -1e-20) + Twofold::difference(-1.0, 0.0);
        assert_eq!(sum, number(1e-20, 0.0));
    }

    #[test]
    fn signs_are_exact() {
        // (1 + 2^-53)^2 - (1 + 2^-52) (1 + 0) = 2^-106, far below what the products' sum shows.
        let (one, tiny) = (number(1.0, f64::EPSILON / 2.0), f64::EPSILON);
        let sign = |a, b, c, d| {
            let sign = sign_of_difference(a, b, c, d);
            assert_eq!(sign_of_difference(c, d, a, b), -sign);
            assert_eq!(sign_of_difference(b, a, d, c), sign);
            sign
        };
        let whole = number(1.0, 0.0);
        assert_eq!(sign(one, one, number(1.0 + tiny, 0.0), whole), 1);
        let less = number(1.0 + tiny, tiny * tiny / 4.0);
        assert_eq!(sign(one, one, less, whole), 0);
        let more = number(1.0 + tiny, tiny * tiny / 4.0 + tiny * tiny * tiny);
        assert_eq!(sign(one, one, more, whole), -1);
        assert_eq!(sign(whole, number(2.0, 0.0), number(3.0, 0.0), whole), -1);
        assert_eq!(sign(number(0.0, 0.0), one, number(0.0, 0.0), whole), 0);
    }
}
