//! How light is followed: each method a file, and a line in [`INTEGRATORS`].

mod whitted;

use std::fmt;

use crate::PreparedScene;
use crate::camera_rays::CameraRays;
use crate::lights::Lights;
use crate::options::RenderOptions;
use crate::progress::Progress;
use crate::stats::RayCounts;
use crate::tiles::{Tile, TilePixels};

/// A method of following light.
#[derive(Clone, Copy)]
pub struct Integrator {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub help: &'static str,
    /// Computes the pixels of a tile. Called once per tile, so that a method may trace its rays one by one, as packets
    /// or as streams.
    render_tile: TileRenderer,
}

/// Computes the pixels of a tile and counts the rays.
type TileRenderer = fn(&Frame<'_>, &Tile, &mut TilePixels) -> RayCounts;

/// All methods; the first is the default.
pub static INTEGRATORS: [Integrator; 1] = [whitted::INTEGRATOR];

impl Integrator {
    /// The method of this name.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        INTEGRATORS.iter().find(|integrator| integrator.name == name)
    }

    pub(crate) fn render_tile(
        &self,
        frame: &Frame<'_>,
        tile: &Tile,
        pixels: &mut TilePixels,
    ) -> RayCounts {
        (self.render_tile)(frame, tile, pixels)
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
}
