//! What a rendering did: rays by kind, and how long they took.

use std::iter::Sum;
use std::ops::{Add, AddAssign};
use std::time::Duration;

/// How many rays were traced, by the kinds of Whitted 1980.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// From a surface towards a light. One that passes through glass counts once more for each surface it crosses.
    pub shadow: u64,
    /// Mirrored.
    pub reflection: u64,
    /// Let through, bent or not.
    pub refraction: u64,
}

impl RayCounts {
    /// Rays of all kinds.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflection + self.refraction
    }
}

impl Add for RayCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            primary: self.primary + other.primary,
            shadow: self.shadow + other.shadow,
            reflection: self.reflection + other.reflection,
            refraction: self.refraction + other.refraction,
        }
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for RayCounts {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), Self::add)
    }
}

/// What a rendering did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Rays by kind; the same for any number of threads.
    pub rays: RayCounts,
    /// From the first ray to the finished image.
    pub elapsed: Duration,
    /// How many threads the pool has that rendered.
    pub threads: usize,
}

impl RenderStats {
    /// Million rays of all kinds a second.
    pub fn million_rays_per_second(&self) -> f64 {
        self.millions_per_second(self.rays.total())
    }

    /// Million paths a second: each primary ray begins one.
    pub fn million_paths_per_second(&self) -> f64 {
        self.millions_per_second(self.rays.primary)
    }

    fn millions_per_second(&self, count: u64) -> f64 {
        let seconds = self.elapsed.as_secs_f64();
        if seconds > 0.0 { count as f64 / seconds * 1e-6 } else { 0.0 }
    }
}
