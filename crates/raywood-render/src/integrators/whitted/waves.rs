//! The order in which the rays of a tile are traced.

use raywood::{Hit, HitColumns, SimdLevel};

use super::direct::DirectLight;
use super::queue::{Followed, Queue, Waiting};
use super::shade::{ShadeWave, Shader};
use crate::integrators::Frame;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePass, TilePixels};
use crate::wave::primary::{PrimaryRays, TracedPrimary};
use crate::wave::surfaces::Surfaces;
use crate::wave::textured_surfaces::TextureMemory;
use crate::wave::{TRACED, WAVE};

/// The memory that a tile needs.
#[derive(Default)]
pub(super) struct Scratch {
    primary: PrimaryRays,
    primary_hits: HitColumns,
    waiting: Waiting,
    wave: Queue,
    hits: Vec<Option<Hit>>,
    surfaces: Box<Surfaces>,
    textures: Box<TextureMemory>,
    direct: DirectLight,
}

/// Follows the rays of a tile, a wave of them at a time, and adds up the light that they bring.
pub(super) struct Waves<'a> {
    frame: &'a Frame<'a>,
    pixels: &'a mut TilePixels,
    counts: RayCounts,
    /// What loops are compiled for.
    level: SimdLevel,
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
        let level = frame.scene.tracer().simd_level().unwrap_or_else(SimdLevel::active);
        Self { frame, pixels, counts: RayCounts::default(), level, scratch }
    }

    /// How many rays were traced.
    pub(super) fn counts(&self) -> RayCounts {
        self.counts
    }

    /// Follows all rays of a pass in the tile, if nobody asks to stop.
    pub(super) fn follow_all(&mut self, tile: &Tile, pass: &TilePass) {
        for (samples, square) in pass.squares(tile) {
            // One ray of each pixel at a time: the more samples, the more waves, but none wider.
            self.scratch.primary.reset(tile, square, self.frame.options);
            for index in samples {
                self.trace_primary(index);
                while let Some(depth) = self.scratch.waiting.take_full(&mut self.scratch.wave) {
                    self.trace_wave(depth);
                }
                if self.frame.progress.is_cancelled() {
                    return;
                }
            }
        }
        while let Some(depth) = self.take_next() {
            self.trace_wave(depth);
            if self.frame.progress.is_cancelled() {
                return;
            }
        }
        self.add_direct_light(1);
    }

    /// Traces ray `index` of every pixel, and shades what they hit.
    fn trace_primary(&mut self, index: u32) {
        let Scratch { primary, primary_hits: hits, waiting, surfaces, textures, direct, .. } =
            &mut *self.scratch;
        self.counts.primary += primary.len() as u64;
        primary.trace(self.frame, index, self.level, hits);
        let eye = self.frame.camera.eye();

        let shader = Shader {
            frame: self.frame,
            pixels: self.pixels,
            counts: &mut self.counts,
            direct,
            followers: waiting.after(0),
            goes_on: 0 < self.frame.options.max_depth,
        };
        shade(shader, TracedPrimary { eye, primary, hits }, (surfaces, textures), self.level);
        self.add_direct_light(FEWEST);
    }

    /// Makes rays that wait the next wave and tells their depth.
    fn take_next(&mut self) -> Option<u32> {
        let Scratch { waiting, wave, .. } = &mut *self.scratch;
        waiting.take_full(wave).or_else(|| waiting.take_first(wave))
    }

    /// Traces the rays of `wave`, which have the same depth, shades what they hit, and has the rays that follow wait for their turn.
    fn trace_wave(&mut self, depth: u32) {
        let Scratch { wave, hits, .. } = &mut *self.scratch;
        wave.trace(self.frame.scene, hits);

        for first in (0..self.scratch.hits.len()).step_by(WAVE) {
            let Scratch { waiting, wave, hits, surfaces, textures, direct, .. } =
                &mut *self.scratch;
            let shader = Shader {
                frame: self.frame,
                pixels: self.pixels,
                counts: &mut self.counts,
                direct,
                followers: waiting.after(depth),
                goes_on: depth < self.frame.options.max_depth,
            };
            let part = first..hits.len().min(first + WAVE);
            shade(shader, wave.traced(hits, part), (surfaces, textures), self.level);
            self.add_direct_light(FEWEST);
        }
    }

    /// Adds the light of those lights that at least `fewest` shadow rays wait for.
    fn add_direct_light(&mut self, fewest: usize) {
        self.scratch.direct.add(self.frame, fewest, self.level, self.pixels, &mut self.counts);
    }
}

/// Fewer shadow rays of a light wait for others, of any part of the tile.
const FEWEST: usize = TRACED;

/// Shades what a wave hit and sends shadow rays from there.
fn shade(
    shader: Shader<'_>,
    wave: impl Followed,
    (surfaces, memory): (&mut Surfaces, &mut TextureMemory),
    level: SimdLevel,
) {
    let Shader { frame, pixels, counts, direct, followers, goes_on } = shader;
    let shader = Shader { frame, pixels, counts, direct: &mut *direct, followers, goes_on };
    level.run(ShadeWave { shader, wave, surfaces: &mut *surfaces, memory, level });
    direct.send_shadow_rays(frame, surfaces, level);
}
