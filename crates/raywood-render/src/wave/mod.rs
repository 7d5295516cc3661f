//! Waves of rays that were traced together, and what they hit, in columns: the ground that all integrators stand on.

mod bent_normals;
pub(crate) mod columns;
pub(crate) mod find;
mod footprints;
pub(crate) mod primary;
pub(crate) mod ray_queue;
pub(crate) mod surfaces;
mod texture_reads;
pub(crate) mod textured_surfaces;

use raywood::{Hit, Vec3};

/// How many rays are shaded together: as many as structures take in one packet.
pub(crate) const WAVE: usize = 256;

/// How many rays of a queue are traced together: several packets, so that the rays that are left over from each, and are traced one by one, are many at a time.
pub(crate) const TRACED: usize = 4 * WAVE;

/// Rays that were traced, and what they hit.
pub(crate) trait Traced {
    /// How many rays.
    fn len(&self) -> usize;
    /// Where a ray started.
    fn origin(&self, ray: usize) -> Vec3;
    /// Where it went, unit length.
    fn direction(&self, ray: usize) -> Vec3;
    /// How long the way from the eye to where it started was.
    fn travelled(&self, ray: usize) -> f32;
    /// When it did so, in scenes in which something moves.
    fn time(&self, ray: usize) -> f32;
    /// What it hit.
    fn hit(&self, ray: usize) -> Option<Hit>;
}
