//! Pictures that show something of what each pixel sees first, whatever lights it. What has holes is seen by its share, and what is behind it by the rest.

use std::cell::RefCell;

use raywood::{Hit, HitColumns, SimdLevel};
use raywood_scene::Rgb;

use super::{Frame, TileRenderer};
use crate::path_samples::PathSamples;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePass, TilePixels};
use crate::wave::Traced;
use crate::wave::columns::get;
use crate::wave::find::FindSurfaces;
use crate::wave::primary::{PrimaryRays, TracedPrimary};
use crate::wave::ray_queue::{RayQueue, Travelled};
use crate::wave::surfaces::Surfaces;
use crate::wave::textured_surfaces::TextureMemory;

/// What a picture shows, numbers from 0 to 1.
pub(super) trait Shown: Sync {
    /// Where nothing is hit.
    const NOTHING: Rgb;

    /// What it shows of each surface of a wave, of which `colors` has as many places; counts the rays that this takes.
    fn show(
        &self,
        frame: &Frame<'_>,
        surfaces: &Surfaces,
        samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts;
}

/// What is shown of each surface by itself, without rays, and black where there is none: a function of the surfaces of a wave and a number among them.
pub(super) struct OfEach<F>(pub(super) F);

impl<F: Fn(&Frame<'_>, &Surfaces, usize) -> Rgb + Sync> Shown for OfEach<F> {
    const NOTHING: Rgb = Rgb::ZERO;

    fn show(
        &self,
        frame: &Frame<'_>,
        surfaces: &Surfaces,
        _samples: &dyn Fn(usize) -> PathSamples,
        colors: &mut [Rgb],
    ) -> RayCounts {
        for (number, color) in colors.iter_mut().enumerate() {
            *color = (self.0)(frame, surfaces, number);
        }
        RayCounts::default()
    }
}

/// A picture of what is seen first.
pub(super) struct FirstHits<'a, S> {
    pub(super) frame: &'a Frame<'a>,
    pub(super) shown: S,
}

/// The memory that a tile needs.
#[derive(Default)]
struct Scratch {
    primary: PrimaryRays,
    primary_hits: HitColumns,
    surfaces: Box<Surfaces>,
    textures: Box<TextureMemory>,
    colors: Vec<Rgb>,
    behind: Behind,
    wave: Behind,
    hits: Vec<Option<Hit>>,
}

/// Rays that go on through holes.
type Behind = RayQueue<Seen>;

/// In which pixel of the tile a ray is seen, by which share, how long its way was before, and when.
#[derive(Clone, Copy)]
struct Seen {
    pixel: u16,
    share: f32,
    travelled: f32,
    time: f32,
}

impl Travelled for Seen {
    #[inline(always)]
    fn travelled(&self) -> f32 {
        self.travelled
    }

    #[inline(always)]
    fn time(&self) -> f32 {
        self.time
    }
}

/// Behind so many holes one after the other everything counts as whole.
pub(super) const MOST_HOLES: u32 = 256;

thread_local! {
    /// Kept from tile to tile, so that none asks for memory.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

impl<S: Shown> TileRenderer for FirstHits<'_, S> {
    fn render_tile(&self, tile: &Tile, pass: &TilePass, pixels: &mut TilePixels) -> RayCounts {
        SCRATCH.with_borrow_mut(|scratch| self.fill(tile, pass, pixels, scratch))
    }
}

impl<S: Shown> FirstHits<'_, S> {
    fn fill(
        &self,
        tile: &Tile,
        pass: &TilePass,
        pixels: &mut TilePixels,
        scratch: &mut Scratch,
    ) -> RayCounts {
        let Frame { scene, camera, options, progress, .. } = self.frame;
        let level = scene.simd_level().unwrap_or_else(SimdLevel::active);
        let mut counts = RayCounts::default();
        for (indices, square) in pass.squares(tile) {
            scratch.primary.reset(tile, square, options);
            for index in indices {
                let Scratch { primary, primary_hits: hits, .. } = &mut *scratch;
                primary.trace(self.frame, index, level, hits);
                let eye = camera.eye();
                counts.primary += primary.len() as u64;

                let (primary, hits) = (&scratch.primary, &scratch.primary_hits);
                let samples = |pixel| samples_of(tile, pixel, index, options.seed);
                let memory = Memory {
                    surfaces: &mut scratch.surfaces,
                    textures: &mut scratch.textures,
                    colors: &mut scratch.colors,
                    behind: &mut scratch.behind,
                };
                let wave = TracedPrimary { eye, primary, hits };
                let seen = |ray| {
                    let (pixel, time) = (primary.pixel(ray), wave.time(ray));
                    Seen { pixel, share: 1.0, travelled: 0.0, time }
                };
                counts += self.show(&wave, level, (seen, samples), memory, pixels);
                counts += self.look_through_holes(tile, index, level, scratch, pixels);
                if progress.is_cancelled() {
                    return counts;
                }
            }
        }
        counts
    }

    /// Follows the rays that go on through holes, until none is left.
    fn look_through_holes(
        &self,
        tile: &Tile,
        index: u32,
        level: SimdLevel,
        scratch: &mut Scratch,
        pixels: &mut TilePixels,
    ) -> RayCounts {
        let mut counts = RayCounts::default();
        for _ in 0..MOST_HOLES {
            std::mem::swap(&mut scratch.behind, &mut scratch.wave);
            scratch.behind.clear();
            let Scratch { wave, hits, surfaces, textures, colors, behind, .. } = &mut *scratch;
            if wave.len() == 0 {
                break;
            }
            wave.trace(self.frame.scene, hits);
            counts.refraction += wave.len() as u64;
            let wave = wave.traced(hits, 0..wave.len());
            let memory = Memory { surfaces, textures, colors, behind };
            let seen = |ray: usize| wave.known(ray);
            let samples = |pixel| samples_of(tile, pixel, index, self.frame.options.seed);
            counts += self.show(&wave, level, (seen, samples), memory, pixels);
        }
        scratch.behind.clear();
        counts
    }

    /// Adds what is shown of the hits of a wave to their pixels, and has rays wait that go on through holes.
    fn show(
        &self,
        wave: &impl Traced,
        level: SimdLevel,
        (seen, samples): (impl Fn(usize) -> Seen, impl Fn(u16) -> PathSamples),
        memory: Memory<'_>,
        pixels: &mut TilePixels,
    ) -> RayCounts {
        let Memory { surfaces, textures, colors, behind } = memory;
        let scene = self.frame.scene;
        let spread = self.frame.spread();
        let miss = |ray| {
            let Seen { pixel, share, .. } = seen(ray);
            pixels[usize::from(pixel)] += share * S::NOTHING;
        };
        let surfaces_found = &mut *surfaces;
        level.run(FindSurfaces {
            scene,
            wave,
            surfaces: surfaces_found,
            textures,
            spread,
            level,
            miss,
        });

        colors.clear();
        colors.resize(surfaces.count(), Rgb::ZERO);
        let samples_of_surface = |number| samples(seen(surfaces.ray(number)).pixel);
        let counts = self.shown.show(self.frame, surfaces, &samples_of_surface, colors);
        for (number, color) in colors.iter().enumerate() {
            let seen = seen(surfaces.ray(number));
            let surface = surfaces.get(scene, number);
            let opacity = surface.material.opacity;
            pixels[usize::from(seen.pixel)] += (seen.share * opacity) * *color;
            if opacity < 1.0 {
                let travelled = seen.travelled + surfaces.distance(number);
                let ray = surface.point.spawn(get(&surfaces.directions, number));
                let share = (1.0 - opacity) * seen.share;
                behind.push(ray, Seen { share, travelled, ..seen });
            }
        }
        counts
    }
}

/// The random numbers of sample `index` of a pixel of a tile.
fn samples_of(tile: &Tile, pixel: u16, index: u32, seed: u32) -> PathSamples {
    PathSamples::seeded(tile.place(u32::from(pixel)), index, seed)
}

/// Memory for the hits of a wave.
struct Memory<'a> {
    surfaces: &'a mut Surfaces,
    textures: &'a mut TextureMemory,
    colors: &'a mut Vec<Rgb>,
    behind: &'a mut Behind,
}
