//! Rays that wait for their turn, sorted by what they are: rays that belong together are fastest traced together.

use raywood_scene::Rgb;

use crate::wave::primary::TracedPrimary;
use crate::wave::ray_queue::{RayQueue, TracedRays, Travelled};
use crate::wave::{TRACED, Traced};

/// How a ray came here.
#[derive(Clone, Copy)]
pub(super) struct Path {
    /// The pixel of the tile that the light ends up in.
    pub(super) pixel: u16,
    /// How many holes it went through since it was last mirrored or bent.
    pub(super) holes: u16,
    /// What light along the ray counts in the pixel.
    pub(super) weight: Rgb,
    /// Absorption of what the ray runs through, per unit of length.
    pub(super) absorption: Rgb,
    /// How long the way from the eye to where the ray starts was.
    pub(super) length: f32,
    /// When the ray looks at the scene, if anything moves there.
    pub(super) time: f32,
}

impl Travelled for Path {
    #[inline(always)]
    fn travelled(&self) -> f32 {
        self.length
    }

    #[inline(always)]
    fn time(&self) -> f32 {
        self.time
    }
}

/// Rays that were traced, of which it is known how they came here.
pub(super) trait Followed: Traced {
    /// How a ray came here.
    fn path(&self, ray: usize) -> Path;
}

impl Followed for TracedPrimary<'_> {
    #[inline(always)]
    fn path(&self, ray: usize) -> Path {
        // In air. (An eye inside glass is noticed when the ray leaves it.)
        let (pixel, time) = (self.primary.pixel(ray), self.time(ray));
        Path { pixel, holes: 0, weight: Rgb::ONE, absorption: Rgb::ZERO, length: 0.0, time }
    }
}

impl Followed for TracedRays<'_, Path> {
    #[inline(always)]
    fn path(&self, ray: usize) -> Path {
        self.known(ray)
    }
}

/// Rays and the paths that they go on.
pub(super) type Queue = RayQueue<Path>;

/// Where rays wait that follow from those of a wave.
pub(super) struct Followers<'a> {
    /// Those that go on through holes.
    pub(super) straight: &'a mut Queue,
    /// Those that are mirrored.
    pub(super) mirrored: &'a mut Queue,
    /// Those that are let through.
    pub(super) refracted: &'a mut Queue,
}

/// The rays that follow from others, by their depth and by what they are. Mirrored rays that come from one plane run as if from one point,
/// the mirror image of the eye; among others they would not.
#[derive(Default)]
pub(super) struct Waiting {
    /// Of each depth those that were mirrored and those that were let through.
    depths: Vec<[Queue; 2]>,
}

impl Waiting {
    /// Forgets all rays and makes room for those of the given depths.
    pub(super) fn reset(&mut self, max_depth: u32) {
        self.depths.resize_with(max_depth as usize + 2, Default::default);
        self.depths.as_flattened_mut().iter_mut().for_each(Queue::clear);
    }

    /// Where the rays that follow from those of a depth wait: those that go through holes, which counts as no step, and those of the next depth, mirrored
    /// and let through.
    pub(super) fn after(&mut self, depth: u32) -> Followers<'_> {
        let (these, next) = self.depths.split_at_mut(depth as usize + 1);
        let [_, straight] = &mut these[depth as usize];
        let [mirrored, refracted] = &mut next[0];
        Followers { straight, mirrored, refracted }
    }

    /// Moves as many rays as are traced together to `wave` and tells their depth, if so many wait. The deepest come first, so that no queue ever holds
    /// twice as many, however often light is split.
    pub(super) fn take_full(&mut self, wave: &mut Queue) -> Option<u32> {
        let number = self.depths.as_flattened().iter().rposition(|queue| queue.len() >= TRACED)?;
        Some(self.take(number, wave))
    }

    /// Moves the rays that others may follow from soonest to `wave` and tells their depth: as many as possible are then together when their
    /// own followers have their turn.
    pub(super) fn take_first(&mut self, wave: &mut Queue) -> Option<u32> {
        let number = self.depths.as_flattened().iter().position(|queue| queue.len() > 0)?;
        Some(self.take(number, wave))
    }

    fn take(&mut self, number: usize, wave: &mut Queue) -> u32 {
        self.depths.as_flattened_mut()[number].move_wave(wave);
        (number / 2) as u32
    }
}
