//! Arrays: what every processor can do. The compiler makes vector instructions of most of it.

use std::ops::{Add, Div, Mul, Sub};

use super::{Float, Kernel, Simd};
use crate::minmax::{larger, smaller};

/// The token of the portable level, which always exists.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// An array of numbers.
#[derive(Clone, Copy)]
pub(crate) struct Array<const N: usize>([f32; N]);

impl<const N: usize> Array<N> {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }

    #[inline(always)]
    fn lanes(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..N).fold(0, |set, lane| set | u32::from(f(self.0[lane], other.0[lane])) << lane)
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt;)*) => {
        $(impl<const N: usize> $trait for Array<N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, |a, b| a $operator b)
            }
        })*
    };
}

operators! { Add add +; Sub sub -; Mul mul *; Div div /; }

impl<const N: usize> Float for Array<N> {
    type Array = [f32; N];

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.with(other, smaller)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.with(other, larger)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // Two roundings: without the instruction a fused one is a call.
        self * factor + addend
    }

    #[inline(always)]
    fn negated_mul_add(self, factor: Self, addend: Self) -> Self {
        addend - self * factor
    }

    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a < b)
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn replaced(self, lanes: u32, chosen: Self) -> Self {
        Self(std::array::from_fn(|lane| match lanes >> lane & 1 {
            1 => chosen.0[lane],
            _ => self.0[lane],
        }))
    }

    #[inline(always)]
    fn least(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, smaller)
    }

    #[inline(always)]
    fn greatest(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, larger)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; N] {
        self.0
    }
}

impl Simd for Portable {
    type F16 = Array<16>;
    type F8 = Array<8>;
    const FUSES: bool = false;

    #[inline(never)]
    fn apart<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }

    #[inline(always)]
    fn splat16(self, number: f32) -> Array<16> {
        Array([number; 16])
    }

    #[inline(always)]
    fn load16(self, numbers: &[f32; 16]) -> Array<16> {
        Array(*numbers)
    }

    #[inline(always)]
    fn splat8(self, number: f32) -> Array<8> {
        Array([number; 8])
    }

    #[inline(always)]
    fn load8(self, numbers: &[f32; 8]) -> Array<8> {
        Array(*numbers)
    }
}
