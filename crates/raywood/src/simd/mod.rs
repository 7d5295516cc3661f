//! Vectors of several numbers at once, on whatever instructions the processor has: with `storage.rs` the only unsafe code of the library.
//!
//! Kernels are written once, generic over [`Simd`], and compiled for every [`SimdLevel`]; [`dispatch_on`] enters the one to use. Values of a
//! level's vector types come from its token alone, and the token exists only where the processor has the instructions: so what is done with the
//! values is safe.
//!
//! Every operation but [`Float::mul_add`] and its negated form rounds as the scalar one does, and nothing else is fused: all levels give the same numbers to the bit.

#![allow(unsafe_code)]

mod arena;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod bit_places;
mod claims;
pub(crate) mod huge_pages;
mod level;
mod portable;
mod vector;
mod vectorized;

#[cfg(test)]
mod tests;

use crate::Ray;
pub(crate) use arena::{Arena, ArenaInMaking, Lines, Part};
pub(crate) use bit_places::BitPlaces;
pub(crate) use claims::Claims;
pub use level::{SimdLevel, SimdLevelError};
pub(crate) use portable::Portable;
pub(crate) use vector::{Float, PLACES, Simd};
pub use vectorized::Vectorized;

/// Sixteen rays as rows of eight numbers each: origin, start, direction, end.
#[inline(always)]
pub(crate) fn as_rows(rays: &[Ray; 16]) -> &[[f32; 8]; 16] {
    const _: () = assert!(size_of::<Ray>() == size_of::<[f32; 8]>());
    // SAFETY: a ray is made of eight numbers, in the order of their declaration and with nothing between them, for their sizes add up.
    unsafe { &*std::ptr::from_ref(rays).cast() }
}

/// A ray as a row of eight numbers.
#[inline(always)]
pub(crate) fn as_row(ray: &Ray) -> &[f32; 8] {
    // SAFETY: as for sixteen of them.
    unsafe { &*std::ptr::from_ref(ray).cast() }
}

/// Asks for the cache line of an item to be fetched soon; of one that is not there, for nothing.
#[inline(always)]
pub(crate) fn prefetch_item<T>(items: &[T], place: usize) {
    prefetch_address(items.as_ptr().wrapping_add(place).cast());
}

/// Asks for a cache line to be fetched soon; where there is no memory, for nothing.
#[inline(always)]
fn prefetch_address(address: *const u8) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing, whatever the address, and every x86-64 processor has it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

/// Work that is compiled for every level.
pub(crate) trait Kernel {
    /// What the work gives.
    type Output;

    /// Does the work. Must be `#[inline(always)]`, and so must be all functions below it that handle vectors.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Runs a kernel on a level. One that the processor lacks is replaced by the portable one.
#[inline]
pub(crate) fn dispatch_on<K: Kernel>(level: SimdLevel, kernel: K) -> K::Output {
    match level {
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512 if level.is_available() => {
            // SAFETY: the processor has the instructions.
            unsafe { avx512::run(kernel) }
        }
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2 if level.is_available() => {
            // SAFETY: the processor has the instructions.
            unsafe { avx2::run(kernel) }
        }
        _ => kernel.run(Portable),
    }
}
