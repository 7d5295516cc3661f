//! Rays that wait to be traced, and what is known of each.

use std::ops::Range;

use raywood::{Hit, Ray, Vec3};

use super::{TRACED, Traced};
use crate::PreparedScene;

/// What is known of a ray that waits.
pub(crate) trait Travelled {
    /// How long the way from the eye to where the ray starts was.
    fn travelled(&self) -> f32;
    /// When the ray looks at the scene, if anything moves there.
    fn time(&self) -> f32;
}

/// Rays, and what is known of them, number by number.
pub(crate) struct RayQueue<T> {
    rays: Vec<Ray>,
    known: Vec<T>,
    /// Memory for times.
    times: Vec<f32>,
}

impl<T> Default for RayQueue<T> {
    fn default() -> Self {
        Self { rays: Vec::new(), known: Vec::new(), times: Vec::new() }
    }
}

impl<T> RayQueue<T> {
    #[inline]
    pub(crate) fn push(&mut self, ray: Ray, known: T) {
        self.rays.push(ray);
        self.known.push(known);
    }

    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.known.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.rays.len()
    }

    /// Moves the last rays, as many as are traced together at most, to another queue, whose own are forgotten.
    pub(crate) fn move_wave(&mut self, wave: &mut Self) {
        let start = self.len().saturating_sub(TRACED);
        wave.clear();
        wave.rays.extend(self.rays.drain(start..));
        wave.known.extend(self.known.drain(start..));
    }

    /// Finds what all rays hit, which takes the place of what is in `hits`.
    pub(crate) fn trace(&mut self, scene: &PreparedScene<'_>, hits: &mut Vec<Option<Hit>>)
    where
        T: Travelled,
    {
        let Self { rays, known, times } = self;
        times.clear();
        if scene.moves() {
            times.extend(known.iter().map(T::time));
        }
        hits.resize(rays.len(), None);
        scene.tracer().intersect_batch(rays, times, hits);
    }

    /// Some of the rays, when they were traced; `hits` are those of all.
    pub(crate) fn traced<'a>(
        &'a self,
        hits: &'a [Option<Hit>],
        part: Range<usize>,
    ) -> TracedRays<'a, T> {
        let (rays, known) = (&self.rays[part.clone()], &self.known[part.clone()]);
        TracedRays { rays, known, hits: &hits[part] }
    }
}

/// Rays of a queue that were traced.
pub(crate) struct TracedRays<'a, T> {
    rays: &'a [Ray],
    known: &'a [T],
    hits: &'a [Option<Hit>],
}

impl<T: Copy> TracedRays<'_, T> {
    /// What is known of a ray.
    #[inline(always)]
    pub(crate) fn known(&self, ray: usize) -> T {
        self.known[ray]
    }
}

impl<T: Travelled> Traced for TracedRays<'_, T> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.hits.len()
    }

    #[inline(always)]
    fn origin(&self, ray: usize) -> Vec3 {
        self.rays[ray].origin
    }

    #[inline(always)]
    fn direction(&self, ray: usize) -> Vec3 {
        self.rays[ray].direction
    }

    #[inline(always)]
    fn travelled(&self, ray: usize) -> f32 {
        self.known[ray].travelled()
    }

    #[inline(always)]
    fn time(&self, ray: usize) -> f32 {
        self.known[ray].time()
    }

    #[inline(always)]
    fn hit(&self, ray: usize) -> Option<Hit> {
        self.hits[ray]
    }
}
