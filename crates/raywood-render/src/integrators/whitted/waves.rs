//! The order in which the rays of a tile are traced.

use raywood::Hit;
use raywood_scene::Rgb;

use super::direct::DirectLight;
use super::queue::{Path, Queue, WAVE, Waiting};
use super::shade::Shader;
use crate::integrators::Frame;
use crate::sampling::PixelSamples;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePixels};

/// The memory that a tile needs.
#[derive(Default)]
pub(super) struct Scratch {
    /// The pixels of the tile, those of a block together.
    pixels: Vec<Pixel>,
    waiting: Waiting,
    wave: Queue,
    hits: Vec<Option<Hit>>,
    direct: DirectLight,
}

/// A pixel and where its primary rays pass.
struct Pixel {
    /// Its number in the tile.
    number: u32,
    /// Its column and row in the image.
    place: [u32; 2],
    samples: PixelSamples,
}

/// Follows the rays of a tile, a wave of them at a time, and adds up the light that they bring.
pub(super) struct Waves<'a> {
    frame: &'a Frame<'a>,
    pixels: &'a mut TilePixels,
    counts: RayCounts,
    scratch: &'a mut Scratch,
}

impl<'a> Waves<'a> {
    pub(super) fn new(
        frame: &'a Frame<'a>,
        pixels: &'a mut TilePixels,
        scratch: &'a mut Scratch,
    ) -> Self {
        scratch.waiting.reset(frame.options.max_depth);
        scratch.direct.reset(frame.lights.directed.len());
        Self { frame, pixels, counts: RayCounts::default(), scratch }
    }

    /// How many rays were traced.
    pub(super) fn counts(&self) -> RayCounts {
        self.counts
    }

    /// Follows all rays of the tile, if nobody asks to stop.
    pub(super) fn follow_all(&mut self, tile: &Tile) {
        let samples = self.frame.options.samples;
        self.scratch.pixels.clear();
        self.scratch.pixels.extend(tile.pixels_in_blocks().map(|(number, [x, y])| Pixel {
            number,
            place: [x, y],
            samples: PixelSamples::new(x, y, samples),
        }));

        // One ray of each pixel at a time: the more samples, the more waves, but none wider.
        for index in 0..samples {
            self.send_primary(index);
            self.trace_wave(0);
            while let Some(depth) = self.scratch.waiting.take_full(&mut self.scratch.wave) {
                self.trace_wave(depth);
            }
            if self.frame.progress.is_cancelled() {
                return;
            }
        }
        while let Some(depth) = self.take_next() {
            self.trace_wave(depth);
            if self.frame.progress.is_cancelled() {
                return;
            }
        }
        self.add_direct_light(1);
        self.pixels.iter_mut().for_each(|pixel| *pixel = (1.0 / samples as f32) * *pixel);
    }

    /// Makes ray `index` of every pixel the next wave.
    fn send_primary(&mut self, index: u32) {
        let Scratch { pixels, wave, .. } = &mut *self.scratch;
        wave.clear();
        for Pixel { number, place: [x, y], samples } in &*pixels {
            // In air. (An eye inside glass is noticed when the ray leaves it.)
            let path = Path { pixel: *number, weight: Rgb::ONE, absorption: Rgb::ZERO };
            wave.push(self.frame.camera.sample_ray(*x, *y, samples, index), path);
        }
        self.counts.primary += pixels.len() as u64;
    }

    /// Makes rays that wait the next wave and tells their depth.
    fn take_next(&mut self) -> Option<u32> {
        let Scratch { waiting, wave, .. } = &mut *self.scratch;
        waiting.take_full(wave).or_else(|| waiting.take_first(wave))
    }

    /// Traces the wave, whose rays have the same depth, shades what they hit, and has the rays that follow wait for their turn.
    fn trace_wave(&mut self, depth: u32) {
        let Scratch { waiting, wave, hits, direct, .. } = &mut *self.scratch;
        hits.resize(wave.rays.len(), None);
        self.frame.scene.structure().intersect_batch_serial(&wave.rays, hits);

        let mut shader = Shader {
            frame: self.frame,
            pixels: self.pixels,
            counts: &mut self.counts,
            direct,
            followers: waiting.at(depth + 1),
            goes_on: depth < self.frame.options.max_depth,
        };
        for ((ray, path), hit) in wave.rays.iter().zip(&wave.paths).zip(hits) {
            shader.shade(ray, path, hit.as_ref());
        }
        direct.send_shadow_rays(self.frame.lights);
        self.add_direct_light(FEWEST);
    }

    /// Adds the light of those lights that at least `fewest` shadow rays wait for.
    fn add_direct_light(&mut self, fewest: usize) {
        self.scratch.direct.add(self.frame, fewest, self.pixels, &mut self.counts);
    }
}

/// Fewer shadow rays of a light wait for others.
const FEWEST: usize = WAVE / 4;
