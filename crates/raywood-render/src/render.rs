//! A picture of a scene.

use std::time::Instant;

use raywood_scene::{Camera, Light, Rgb};

use crate::PreparedScene;
use crate::image::Image;
use crate::integrators::Frame;
use crate::lights::Lights;
use crate::options::{RenderError, RenderOptions};
use crate::progress::Progress;
use crate::stats::RenderStats;
use crate::tiles::{TilePass, fill_tiles};

/// Renders the scene as the camera sees it, on the threads of the current rayon pool.
///
/// The image is the same, bit for bit, for any number of threads. `lights` are usually the scene's own, or those of its
/// [default view](crate::default_view).
///
/// # Errors
///
/// Options or a camera that make no sense, too little memory, or [`RenderError::Cancelled`] after
/// [`Progress::cancel`].
pub fn render(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    lights: &[Light],
    options: &RenderOptions,
    progress: &Progress,
) -> Result<(Image, RenderStats), RenderError> {
    options.validate()?;
    let (width, height) = (options.width, options.height);
    let lights = Lights::new(lights);
    let frame = Frame::new(scene, &lights, camera, options, progress)?;
    let started = Instant::now();
    let renderer = options.integrator.start(&frame);
    let (pass, share) = (TilePass::all(options.samples), 1.0 / options.samples as f32);

    let (pixels, rays) = fill_tiles(
        (width, height),
        Rgb::ZERO,
        options.memory_bytes(),
        progress,
        |tile, pixels| {
            let rays = renderer.render_tile(tile, &pass, pixels);
            pixels.iter_mut().for_each(|pixel| *pixel = share * *pixel);
            rays
        },
    )?;
    let image = match options.integrator.shows_light {
        true => Image::from_pixels(width, height, pixels),
        false => Image::from_numbers(width, height, pixels),
    };
    let threads = rayon::current_num_threads();
    Ok((image, RenderStats { rays, elapsed: started.elapsed(), threads }))
}
