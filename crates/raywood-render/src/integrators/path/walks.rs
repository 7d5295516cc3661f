//! Paths on their way, and the rays that they take next.

use raywood::{Hit, Vec3};
use raywood_scene::Rgb;

use crate::wave::Traced;
use crate::wave::primary::TracedPrimary;
use crate::wave::ray_queue::{RayQueue, TracedRays, Travelled};

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
    /// The only colour that its light has since glass parted it from the others: 0 for red, 1 for green, 2 for blue.
    pub(super) channel: Option<u8>,
    /// How likely its direction was when it was scattered, by solid angle; infinite where there was no other.
    pub(super) density: f32,
    /// What light along the ray counts in the pixel.
    pub(super) weight: Rgb,
    /// Absorption of what the ray runs through, per unit of length.
    pub(super) absorption: Rgb,
    /// How long the way from the eye to where the ray starts was.
    pub(super) length: f32,
    /// When its rays look at the scene, if anything moves there.
    pub(super) time: f32,
}

impl Walk {
    /// The colour that is followed from where glass parts them: if it is not known yet, each as likely, and its light counts for all three.
    #[inline]
    pub(super) fn only_color(&mut self, choice: f32) -> u8 {
        *self.channel.get_or_insert_with(|| {
            let channel = ((3.0 * choice) as u8).min(2);
            let axis = [Rgb::X, Rgb::Y, Rgb::Z][usize::from(channel)];
            self.weight = 3.0 * (self.weight * axis);
            channel
        })
    }
}

impl Travelled for Walk {
    #[inline(always)]
    fn travelled(&self) -> f32 {
        self.length
    }

    #[inline(always)]
    fn time(&self) -> f32 {
        self.time
    }
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
    fn time(&self, ray: usize) -> f32 {
        self.traced.time(ray)
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
            channel: None,
            // Nobody asks for light from the eye.
            density: f32::INFINITY,
            weight: Rgb::ONE,
            // In air. (An eye inside glass is noticed when the ray leaves it.)
            absorption: Rgb::ZERO,
            length: 0.0,
            time: self.time(ray),
        }
    }
}

/// Rays and the paths that they belong to. As each ray is followed by one at most, no more than twice as many ever wait as are traced together.
pub(super) type Walks = RayQueue<Walk>;

impl Walked for TracedRays<'_, Walk> {
    #[inline(always)]
    fn walk(&self, ray: usize) -> Walk {
        self.known(ray)
    }
}
