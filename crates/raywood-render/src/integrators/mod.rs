//! How light is followed, or what else a picture shows: each method a file, and a line in [`INTEGRATORS`].

mod albedo;
mod ambient_occlusion;
mod depth;
mod features;
mod first_hits;
mod ids;
mod normals;
mod path;
mod view_depths;
mod whitted;
mod wireframe;

use std::fmt;

use raywood_scene::{Camera, Material, Scene};

use crate::PreparedScene;
use crate::camera_rays::{CameraError, CameraRays};
use crate::lights::Lights;
use crate::options::RenderOptions;
use crate::path_samples::PathSamples;
use crate::progress::Progress;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePass, TilePixels};

pub use features::{Features, NO_ID, features, ids as primitive_ids};

/// A method of following light, or of showing something else.
#[derive(Clone, Copy)]
pub struct Integrator {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub help: &'static str,
    /// Whether pictures show light, of which there may be more than white. Else they show numbers from 0 to 1, which are written as they are.
    pub shows_light: bool,
    /// Whether light is shown as all parts of materials scatter it, sheen and the colours of glass that parts them too.
    pub shows_all_materials: bool,
    /// Begins a picture.
    start: Start,
}

/// Makes ready what is the same for all tiles of a picture.
type Start = for<'a> fn(&'a Frame<'a>) -> Box<dyn TileRenderer + 'a>;

/// A picture that is begun.
pub(crate) trait TileRenderer: Sync {
    /// Adds the samples of a pass to the pixels of a tile, and counts the rays. Called once per tile and pass, so that a method may trace its rays one by one,
    /// as packets or as streams.
    fn render_tile(&self, tile: &Tile, pass: &TilePass, pixels: &mut TilePixels) -> RayCounts;
}

/// All methods; the first is the default.
pub static INTEGRATORS: [Integrator; 8] = [
    whitted::INTEGRATOR,
    path::INTEGRATOR,
    ambient_occlusion::INTEGRATOR,
    normals::INTEGRATOR,
    depth::INTEGRATOR,
    albedo::INTEGRATOR,
    ids::INTEGRATOR,
    wireframe::INTEGRATOR,
];

impl Integrator {
    /// The method of this name.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        INTEGRATORS.iter().find(|integrator| integrator.name == name)
    }

    /// What of a scene its pictures of light leave out, in words.
    pub fn left_out(&self, scene: &Scene) -> Vec<&'static str> {
        let has = |of: fn(&Material) -> bool| scene.materials.iter().any(of);
        let mut left_out = Vec::new();
        if self.shows_light && !self.shows_all_materials {
            if has(|material| material.sheen.is_some()) {
                left_out.push("sheen");
            }
            if has(|material| material.dispersion > 0.0) {
                left_out.push("dispersion");
            }
        }
        left_out
    }

    /// Begins a picture.
    pub(crate) fn start<'a>(&self, frame: &'a Frame<'a>) -> Box<dyn TileRenderer + 'a> {
        (self.start)(frame)
    }
}

impl fmt::Debug for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Integrator").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Everything that is the same for all pixels of a picture.
pub(crate) struct Frame<'a> {
    pub(crate) scene: &'a PreparedScene<'a>,
    pub(crate) lights: &'a Lights,
    pub(crate) camera: CameraRays,
    pub(crate) options: &'a RenderOptions,
    pub(crate) progress: &'a Progress,
    /// Of how many rays of a pixel each stands for its part, where textures are looked at.
    pub(crate) footprint_samples: u32,
}

impl<'a> Frame<'a> {
    /// The frame of a picture with all the samples of its options.
    pub(crate) fn new(
        scene: &'a PreparedScene<'a>,
        lights: &'a Lights,
        camera: &Camera,
        options: &'a RenderOptions,
        progress: &'a Progress,
    ) -> Result<Self, CameraError> {
        let camera =
            CameraRays::new(camera, options.width, options.height)?.with_lens(options.lens);
        let footprint_samples = options.samples;
        Ok(Self { scene, lights, camera, options, progress, footprint_samples })
    }

    /// When ray `index` of a pixel looks at the scene, if anything moves there.
    #[inline]
    pub(crate) fn time(&self, place: [u32; 2], index: u32) -> f32 {
        match self.scene.moves() {
            true => self.options.shutter.time(PathSamples::seeded(place, index, self.options.seed)),
            false => 0.0,
        }
    }

    /// By how much the cone that a primary ray stands for widens on a way of length 1: one of several rays of a pixel stands for a part of it.
    #[inline(always)]
    pub(crate) fn spread(&self) -> f32 {
        self.camera.pixel_width() / (self.footprint_samples as f32).sqrt()
    }
}
