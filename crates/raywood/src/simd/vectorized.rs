//! Plain loops compiled for every level: the compiler makes vectors of them.

use super::{Kernel, Simd, SimdLevel, dispatch_on};

/// Work without vectors of its own that gains from being compiled for wide ones: see [`SimdLevel::run`].
pub trait Vectorized {
    /// What the work gives.
    type Output;

    /// Does the work. Must be `#[inline(always)]`, and so must be all functions below it that matter: others are compiled for every processor.
    fn run(self) -> Self::Output;
}

struct Plain<W>(W);

impl<W: Vectorized> Kernel for Plain<W> {
    type Output = W::Output;

    #[inline(always)]
    fn run<S: Simd>(self, _simd: S) -> W::Output {
        self.0.run()
    }
}

impl SimdLevel {
    /// Does work as it was compiled for this level, or for the portable one where the processor lacks it. The numbers are the same with all: nothing
    /// is fused.
    #[inline]
    pub fn run<W: Vectorized>(self, work: W) -> W::Output {
        dispatch_on(self, Plain(work))
    }
}
