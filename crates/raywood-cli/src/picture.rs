//! What is drawn: the scene's light or a heat map of its structure, with or without the structure's bounds.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use raywood_render::{
    BoundsOverlay, HeatMap, HeatQuantity, Image, PreparedScene, Progress, RayCounts, RenderError,
    RenderOptions, RenderStats, RgbImage, View, bounds_overlay, exposure_for, heat_map, render,
    write_png,
};

use crate::failure::Failure;
use crate::progress_bar::during_rendering;

/// What to draw.
pub(crate) struct Request<'a> {
    pub(crate) prepared: &'a PreparedScene<'a>,
    pub(crate) view: &'a View,
    pub(crate) options: &'a RenderOptions,
    /// What a heat map shows instead of light.
    pub(crate) heatmap: Option<HeatQuantity>,
    /// Where the heat map's scale ends, else where it finds right.
    pub(crate) heatmap_max: Option<f32>,
    /// The level of the bounds.
    pub(crate) show_bounds: Option<usize>,
    /// How much of the light is shown; else as much as a path tracer's picture has room for, or all of it.
    pub(crate) exposure: Option<f32>,
}

/// A picture, and what a report says of it.
pub(crate) struct Drawn {
    picture: Picture,
    pub(crate) render: RenderStats,
    pub(crate) heat: Option<Heat>,
    pub(crate) bounds: Option<Bounds>,
    /// How much of the light is shown.
    pub(crate) exposure: f32,
}

/// Light as it was computed, or what was drawn into.
enum Picture {
    Light(Image),
    Drawn(RgbImage),
}

/// What a report says of a heat map.
pub(crate) struct Heat {
    pub(crate) quantity: HeatQuantity,
    pub(crate) mean: f64,
    pub(crate) max: f32,
    /// Where the scale ends.
    pub(crate) scale: f32,
    /// How many pixels lie above that.
    pub(crate) pixels_above: usize,
}

/// What a report says of bounds.
pub(crate) struct Bounds {
    pub(crate) level: usize,
    pub(crate) boxes: usize,
    pub(crate) time: Duration,
}

/// Draws the picture on the threads of a pool, while a bar shows how far it is.
pub(crate) fn draw(request: &Request<'_>, pool: &ThreadPool) -> Result<Drawn, Failure> {
    // The bounds first: that there is no such level should be said before long work.
    let overlay = request.show_bounds.map(|level| draw_bounds(request, level, pool)).transpose()?;
    let (overlay, bounds) = overlay.unzip();
    let draw_over = |mut picture: RgbImage| {
        if let Some(overlay) = &overlay {
            overlay.draw_over(&mut picture);
        }
        picture
    };

    let &Request { prepared, view: View { camera, lights }, options, .. } = request;
    let Some(quantity) = request.heatmap else {
        let (image, stats) =
            traced(pool, |progress| render(prepared, camera, lights, options, progress))?;
        let exposure = match request.exposure {
            Some(exposure) if options.integrator.shows_light => exposure,
            None if options.integrator.name == "path" => {
                let expose =
                    |progress: &_| exposure_for(prepared, camera, lights, options, progress);
                traced(pool, expose)?
            }
            _ => 1.0,
        };
        let image = image.exposed(exposure);
        let picture = match &overlay {
            None => Picture::Light(image),
            Some(_) => Picture::Drawn(draw_over(image.to_rgb_image())),
        };
        return Ok(Drawn { picture, render: stats, heat: None, bounds, exposure });
    };

    let started = Instant::now();
    let map = traced(pool, |progress| heat_map(prepared, camera, options, quantity, progress))?;
    let rays = RayCounts { primary: map.rays, ..RayCounts::default() };
    let threads = pool.current_num_threads();
    let stats = RenderStats { rays, elapsed: started.elapsed(), threads };
    let scale = request.heatmap_max.unwrap_or_else(|| map.default_maximum());
    let picture = map.with_legend(&draw_over(map.picture(scale)), scale);
    let heat = Heat::of(&map, scale);
    let picture = Picture::Drawn(picture);
    Ok(Drawn { picture, render: stats, heat: Some(heat), bounds, exposure: 1.0 })
}

fn draw_bounds(
    request: &Request<'_>,
    level: usize,
    pool: &ThreadPool,
) -> Result<(BoundsOverlay, Bounds), Failure> {
    let started = Instant::now();
    let &Request { prepared, view, options, .. } = request;
    let draw = |progress: &_| bounds_overlay(prepared, &view.camera, options, level, progress);
    let overlay = traced(pool, draw)?;
    let bounds = Bounds { level, boxes: overlay.boxes(), time: started.elapsed() };
    Ok((overlay, bounds))
}

/// Runs something that traces rays in the pool, while a bar shows how far it is.
fn traced<T: Send>(
    pool: &ThreadPool,
    work: impl FnOnce(&Progress) -> Result<T, RenderError> + Send,
) -> Result<T, Failure> {
    let progress = Progress::new();
    during_rendering(&progress, || pool.install(|| work(&progress))).map_err(|error| match error {
        RenderError::OutOfMemory { .. } => Failure::while_running(error),
        error => Failure::bad_input(error),
    })
}

impl Drawn {
    /// Writes the picture as PNG.
    pub(crate) fn write(&self, writer: impl Write) -> io::Result<()> {
        match &self.picture {
            Picture::Light(image) => write_png(image, writer),
            Picture::Drawn(image) => image.write_png(writer),
        }
    }
}

impl Heat {
    fn of(map: &HeatMap, scale: f32) -> Self {
        let (mean, max) = (map.mean(), map.max());
        Self { quantity: map.quantity, mean, max, scale, pixels_above: map.pixels_above(scale) }
    }
}
