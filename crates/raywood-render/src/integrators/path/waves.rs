//! The order in which the rays of a tile are traced.

use raywood::{Hit, HitColumns, SimdLevel};

use super::dice::{Dice, Pairs};
use super::direct::{AskLights, Asked};
use super::picture::Picture;
use super::scatter::{Arrive, GoOn, GoOnMemory, Outlets};
use super::shadow_rays::ShadowRays;
use super::vertices::Vertices;
use super::walks::{Primary, Walked, Walks};
use crate::integrators::Frame;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePass, TilePixels};
use crate::wave::find::FindSurfaces;
use crate::wave::primary::{PrimaryRays, TracedPrimary};
use crate::wave::surfaces::Surfaces;
use crate::wave::textured_surfaces::TextureMemory;
use crate::wave::{TRACED, WAVE};

/// The memory that a tile needs.
#[derive(Default)]
pub(super) struct Scratch {
    primary: PrimaryRays,
    primary_hits: HitColumns,
    waiting: Walks,
    wave: Walks,
    hits: Vec<Option<Hit>>,
    scattering: ScatterMemory,
    shadows: ShadowRays,
}

/// The memory that it takes to have paths scatter.
struct ScatterMemory {
    surfaces: Box<Surfaces>,
    textures: Box<TextureMemory>,
    vertices: Box<Vertices>,
    dice: Box<Dice>,
    straight: Box<Pairs>,
    asked: Box<Asked>,
    go_on: Box<GoOnMemory>,
}

impl Default for ScatterMemory {
    fn default() -> Self {
        Self {
            surfaces: Box::default(),
            textures: Box::default(),
            vertices: Box::default(),
            dice: Box::default(),
            straight: Box::new([[0.0; WAVE]; 2]),
            asked: Box::default(),
            go_on: Box::default(),
        }
    }
}

/// Follows the paths of a tile, a wave of rays at a time, and adds up the light that they bring.
pub(super) struct Waves<'a> {
    picture: &'a Picture<'a>,
    tile: &'a Tile,
    pixels: &'a mut TilePixels,
    counts: RayCounts,
    /// What loops are compiled for.
    level: SimdLevel,
    scratch: &'a mut Scratch,
}

impl<'a> Waves<'a> {
    pub(super) fn new(
        picture: &'a Picture<'a>,
        tile: &'a Tile,
        pixels: &'a mut TilePixels,
        scratch: &'a mut Scratch,
    ) -> Self {
        // A picture that was stopped may have left some.
        scratch.waiting.clear();
        scratch.shadows.clear();
        scratch.scattering.surfaces.keep_what_all_is_made_of();
        scratch.scattering.dice.set_seed(picture.frame.options.seed);
        let tracer = picture.frame.scene.tracer();
        let level = tracer.simd_level().unwrap_or_else(SimdLevel::active);
        Self { picture, tile, pixels, counts: RayCounts::default(), level, scratch }
    }

    /// How many rays were traced.
    pub(super) fn counts(&self) -> RayCounts {
        self.counts
    }

    /// Follows all paths of a pass in the tile, if nobody asks to stop.
    pub(super) fn follow_all(&mut self, pass: &TilePass) {
        let Frame { options, progress, .. } = self.picture.frame;
        for (samples, square) in pass.squares(self.tile) {
            self.scratch.primary.reset(self.tile, square, options);
            for sample in samples {
                self.trace_primary(sample);
                while self.scratch.waiting.len() >= TRACED {
                    self.trace_wave();
                }
                if progress.is_cancelled() {
                    return;
                }
            }
        }
        while self.scratch.waiting.len() > 0 {
            self.trace_wave();
            if progress.is_cancelled() {
                return;
            }
        }
        let Scratch { shadows, .. } = &mut *self.scratch;
        shadows.trace(self.picture, 1, self.pixels, &mut self.counts);
    }

    /// Traces ray `sample` of every pixel of the square, and has the paths scatter.
    fn trace_primary(&mut self, sample: u32) {
        let Scratch { primary, primary_hits: hits, .. } = &mut *self.scratch;
        self.counts.primary += primary.len() as u64;
        primary.trace(self.picture.frame, sample, self.level, hits);
        let eye = self.picture.frame.camera.eye();

        let Scratch { primary, primary_hits: hits, waiting, scattering, shadows, .. } =
            &mut *self.scratch;
        let traced = TracedPrimary { eye, primary, hits };
        let (picture, pixels, counts) = (self.picture, &mut *self.pixels, &mut self.counts);
        let outlets = Outlets { picture, pixels, counts, waiting };
        let wave = Primary { traced, sample };
        scatter(outlets, self.tile, &wave, scattering, shadows, self.level);
    }

    /// Traces rays that wait, and has their paths scatter.
    fn trace_wave(&mut self) {
        let Scratch { waiting, wave, hits, .. } = &mut *self.scratch;
        waiting.move_wave(wave);
        wave.trace(self.picture.frame.scene, hits);

        for first in (0..self.scratch.hits.len()).step_by(WAVE) {
            let Scratch { waiting, wave, hits, scattering, shadows, .. } = &mut *self.scratch;
            let part = first..hits.len().min(first + WAVE);
            let (picture, pixels, counts) = (self.picture, &mut *self.pixels, &mut self.counts);
            let outlets = Outlets { picture, pixels, counts, waiting };
            let wave = wave.traced(hits, part);
            scatter(outlets, self.tile, &wave, scattering, shadows, self.level);
        }
    }
}

/// Has the paths of a wave scatter, and traces shadow rays if enough wait.
fn scatter(
    mut outlets: Outlets<'_>,
    tile: &Tile,
    wave: &impl Walked,
    memory: &mut ScatterMemory,
    shadows: &mut ShadowRays,
    level: SimdLevel,
) {
    let ScatterMemory { surfaces, textures, vertices, dice, straight, asked, go_on } = memory;
    let picture = outlets.picture;
    let Frame { scene, .. } = picture.frame;
    let spread = picture.frame.spread();
    let (found, miss) = (&mut **surfaces, |ray| outlets.miss(wave, ray));
    level.run(FindSurfaces { scene, wave, surfaces: found, textures, spread, level, miss });

    let (surfaces, vertices) = (&**surfaces, &mut **vertices);
    let (outlets, straight) = (&mut outlets, &mut **straight);
    level.run(Arrive { outlets, tile, wave, surfaces, vertices, dice, pairs: straight });
    level.run(AskLights { picture, surfaces, vertices, dice, asked, shadows });
    level.run(GoOn { outlets, surfaces, vertices, dice, straight, memory: go_on });
    shadows.trace(picture, TRACED, outlets.pixels, outlets.counts);
}
