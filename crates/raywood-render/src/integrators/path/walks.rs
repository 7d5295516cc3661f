//! Paths on their way, and the rays that they take next.

use raywood::{Hit, Ray, Vec3};
use raywood_scene::Rgb;

use crate::wave::primary::TracedPrimary;
use crate::wave::{TRACED, Traced};

/// How a path came here.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    /// The pixel of the tile that the light ends up in, and which of its samples this is.
    pub(super) pixel: u16,
    pub(super) sample: u32,
    /// How often it was scattered.
    pub(super) depth: u16,
    /// How much it went straight through since then: how often, and how far it is by now.
    pub(super) holes: u16,
    pub(super) since: f32,
    /// How likely its direction was when it was scattered, by solid angle; infinite where there was no other.
    pub(super) density: f32,
    /// What light along the ray counts in the pixel.
    pub(super) weight: Rgb,
    /// Absorption of what the ray runs through, per unit of length.
    pub(super) absorption: Rgb,
    /// How long the way from the eye to where the ray starts was.
    pub(super) length: f32,
}

/// Rays that were traced, of which it is known on which paths.
pub(super) trait Walked: Traced {
    /// How a ray came here.
    fn walk(&self, ray: usize) -> Walk;
}

/// Primary rays that were traced, sample `sample` of their pixels.
pub(super) struct Primary<'a> {
    pub(super) traced: TracedPrimary<'a>,
    pub(super) sample: u32,
}

impl Traced for Primary<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.traced.len()
    }

    #[inline(always)]
    fn origin(&self, ray: usize) -> Vec3 {
        self.traced.origin(ray)
    }

    #[inline(always)]
    fn direction(&self, ray: usize) -> Vec3 {
        self.traced.direction(ray)
    }

    #[inline(always)]
    fn travelled(&self, _ray: usize) -> f32 {
        0.0
    }

    #[inline(always)]
    fn hit(&self, ray: usize) -> Option<Hit> {
        self.traced.hit(ray)
    }
}

impl Walked for Primary<'_> {
    #[inline(always)]
    fn walk(&self, ray: usize) -> Walk {
        Walk {
            pixel: self.traced.primary.pixel(ray),
            sample: self.sample,
            depth: 0,
            holes: 0,
            since: 0.0,
            // Nobody asks for light from the eye.
            density: f32::INFINITY,
            weight: Rgb::ONE,
            // In air. (An eye inside glass is noticed when the ray leaves it.)
            absorption: Rgb::ZERO,
            length: 0.0,
        }
    }
}

/// Rays and the paths that they belong to, number by number.
#[derive(Default)]
pub(super) struct Walks {
    pub(super) rays: Vec<Ray>,
    pub(super) walks: Vec<Walk>,
}

impl Walks {
    #[inline]
    pub(super) fn push(&mut self, ray: Ray, walk: Walk) {
        self.rays.push(ray);
        self.walks.push(walk);
    }

    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.walks.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.rays.len()
    }

    /// Moves the last rays, as many as are traced together at most, to others, which are forgotten. As each ray is followed by one at most, no more than twice
    /// as many ever wait.
    pub(super) fn move_wave(&mut self, wave: &mut Self) {
        let start = self.len().saturating_sub(TRACED);
        wave.clear();
        wave.rays.extend(self.rays.drain(start..));
        wave.walks.extend(self.walks.drain(start..));
    }
}

/// Rays of paths that were traced.
pub(super) struct TracedWalks<'a> {
    pub(super) rays: &'a [Ray],
    pub(super) walks: &'a [Walk],
    pub(super) hits: &'a [Option<Hit>],
}

impl Traced for TracedWalks<'_> {
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
        self.walks[ray].length
    }

    #[inline(always)]
    fn hit(&self, ray: usize) -> Option<Hit> {
        self.hits[ray]
    }
}

impl Walked for TracedWalks<'_> {
    #[inline(always)]
    fn walk(&self, ray: usize) -> Walk {
        self.walks[ray]
    }
}
