//! How light is followed: each method a file, and a line in [`INTEGRATORS`].

mod whitted;

use std::fmt;

use raywood::Ray;
use raywood_scene::Rgb;

use crate::PreparedScene;
use crate::camera_rays::CameraRays;
use crate::lights::Lights;
use crate::options::RenderOptions;
use crate::progress::Progress;
use crate::stats::RayCounts;
use crate::tiles::{TILE_SIZE, Tile, TilePixels};

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

/// Averages `radiance` over the primary rays of each pixel, for methods that follow rays one by one. Stops early,
/// leaving pixels black, when the rendering is cancelled.
fn sample_pixels(
    frame: &Frame<'_>,
    tile: &Tile,
    pixels: &mut TilePixels,
    mut radiance: impl FnMut(&Ray) -> Rgb,
) {
    let samples = frame.options.samples;
    let weight = 1.0 / samples as f32;
    for (row, y) in (tile.y..tile.y + tile.height).enumerate() {
        for (column, x) in (tile.x..tile.x + tile.width).enumerate() {
            let mut sum = Rgb::ZERO;
            for ray in frame.camera.pixel_rays(x, y, samples) {
                if frame.progress.is_cancelled() {
                    return;
                }
                sum += radiance(&ray);
            }
            pixels[row * TILE_SIZE as usize + column] = weight * sum;
        }
    }
}
