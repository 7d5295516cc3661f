//! How fast rays were traced, or pictures rendered.

use crate::Timing;
use crate::frame_budget::RAYS_PER_FRAME;

/// So many rays, again and again in so much time.
#[derive(Clone, Debug, PartialEq)]
pub struct Speed {
    /// On how many threads.
    pub threads: usize,
    /// How many rays.
    pub rays: u64,
    /// How long these took together.
    pub timing: Timing,
}

impl Speed {
    /// The median time for a ray, on all threads together; 0 if there were none.
    pub fn seconds_per_ray(&self) -> f64 {
        self.timing.median() / self.rays.max(1) as f64
    }

    /// Rays a second; 0 if there were none.
    pub fn rays_per_second(&self) -> f64 {
        let seconds = self.timing.median();
        if seconds > 0.0 { self.rays as f64 / seconds } else { 0.0 }
    }

    /// How many of the lecture's [frames](crate::frame_budget) a second take as many rays.
    pub fn frames_per_second(&self) -> f64 {
        self.rays_per_second() / RAYS_PER_FRAME
    }
}
