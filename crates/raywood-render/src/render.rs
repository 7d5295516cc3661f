//! A picture of a scene: tiles over all threads, and the tiles put together.

use std::time::Instant;

use rayon::prelude::*;
use raywood_scene::{Camera, Light, Rgb};

use crate::PreparedScene;
use crate::camera_rays::CameraRays;
use crate::film::Image;
use crate::integrators::Frame;
use crate::lights::Lights;
use crate::options::{RenderError, RenderOptions};
use crate::progress::Progress;
use crate::stats::{RayCounts, RenderStats};
use crate::tiles::{TILE_SIZE, Tile, TilePixels, tiles_in_morton_order};

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
    let camera = CameraRays::new(camera, width, height)?;
    let frame = Frame { scene, lights: &Lights::new(lights), camera, options, progress };
    let started = Instant::now();

    // Give each tile its own pixels, so that threads share nothing while they work.
    let out_of_memory = |_| RenderError::OutOfMemory { bytes: options.memory_bytes() };
    let tiles = tiles_in_morton_order(width, height);
    let mut work: Vec<(Tile, TilePixels)> = Vec::new();
    work.try_reserve_exact(tiles.len()).map_err(out_of_memory)?;
    let mut pixels = Vec::new();
    pixels.try_reserve_exact(width as usize * height as usize).map_err(out_of_memory)?;
    work.extend(tiles.into_iter().map(|tile| (tile, [Rgb::ZERO; _])));

    // One tile is the unit that idle threads steal.
    progress.start(u64::from(width) * u64::from(height));
    let rays: RayCounts = work
        .par_iter_mut()
        .with_max_len(1)
        .map(|(tile, pixels)| {
            if progress.is_cancelled() {
                return RayCounts::default();
            }
            let counts = options.integrator.render_tile(&frame, tile, pixels);
            progress.add(u64::from(tile.width * tile.height));
            counts
        })
        .sum();
    if progress.is_cancelled() {
        return Err(RenderError::Cancelled);
    }

    // Put the tiles together.
    pixels.resize(width as usize * height as usize, Rgb::ZERO);
    for (tile, colors) in &work {
        for (row, colors) in
            colors.chunks_exact(TILE_SIZE as usize).enumerate().take(tile.height as usize)
        {
            let start = (tile.y as usize + row) * width as usize + tile.x as usize;
            let columns = tile.width as usize;
            pixels[start..start + columns].copy_from_slice(&colors[..columns]);
        }
    }
    let image = Image::from_pixels(width, height, pixels);
    let threads = rayon::current_num_threads();
    Ok((image, RenderStats { rays, elapsed: started.elapsed(), threads }))
}
