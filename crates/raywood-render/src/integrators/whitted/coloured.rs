//! Light on its way through what is transparent: shadow rays that are followed surface by surface, many at a time.

use raywood::{Hit, Ray};
use raywood_scene::Rgb;

use crate::integrators::Frame;
use crate::lights::Lights;
use crate::shadows::{Aim, MOST_CROSSINGS, Passage, passage};
use crate::stats::RayCounts;
use crate::tiles::TilePixels;

/// What a shadow ray brings if it arrives.
#[derive(Clone, Copy)]
struct Bringing {
    /// The pixel of the tile that is lit.
    pixel: u32,
    /// Which light the ray goes to.
    light: u32,
    /// How many surfaces were crossed.
    crossings: u32,
    /// When the ray looks at the scene, if anything moves there.
    time: f32,
    /// The light if nothing were in the way.
    brought: Rgb,
    /// The share that the surfaces crossed let through.
    share: Rgb,
}

/// Shadow rays that something is in the way of, perhaps nothing but what is transparent.
#[derive(Default)]
pub(super) struct ColouredShadows {
    rays: Vec<Ray>,
    /// Memory for times.
    times: Vec<f32>,
    bringing: Vec<Bringing>,
    hits: Vec<Option<Hit>>,
}

impl ColouredShadows {
    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.bringing.clear();
    }

    /// How many rays wait.
    pub(super) fn len(&self) -> usize {
        self.rays.len()
    }

    /// Has a ray to a light wait, at its time, which brings so much to the pixel if nothing is in the way.
    #[inline]
    pub(super) fn push(&mut self, (ray, time): (Ray, f32), light: usize, pixel: u32, brought: Rgb) {
        self.rays.push(ray);
        let light = light as u32;
        self.bringing.push(Bringing { pixel, light, crossings: 0, time, brought, share: Rgb::ONE });
    }

    /// Takes all rays to the next surface, adds the light of those that meet none, and has those wait again that it lets through.
    pub(super) fn advance(
        &mut self,
        frame: &Frame<'_>,
        pixels: &mut TilePixels,
        counts: &mut RayCounts,
    ) {
        let Self { rays, times, bringing, hits } = self;
        hits.resize(rays.len(), None);
        times.clear();
        if frame.scene.moves() {
            times.extend(bringing.iter().map(|bringing| bringing.time));
        }
        frame.scene.tracer().intersect_batch(rays, times, hits);
        counts.shadow += rays.len() as u64;

        let Lights { directed, .. } = frame.lights;
        let mut left = 0;
        for number in 0..rays.len() {
            let Bringing { pixel, light, crossings, time, brought, share } = bringing[number];
            let Some(hit) = &hits[number] else {
                pixels[pixel as usize] += brought * share;
                continue;
            };
            let opaque = frame.options.opaque_shadows;
            let ray = (&rays[number], time);
            let passed = passage(frame.scene, ray, hit, opaque);
            let Some(Passage { share: passed, origin }) = passed else { continue };
            let share = share * passed;
            let crossings = crossings + 1;
            if share.max_element() < frame.options.cutoff || crossings == MOST_CROSSINGS {
                continue;
            }
            rays[left] = Aim::at(&directed[light as usize]).ray_from(origin);
            bringing[left] = Bringing { pixel, light, crossings, time, brought, share };
            left += 1;
        }
        rays.truncate(left);
        bringing.truncate(left);
    }
}
