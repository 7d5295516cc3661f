//! What is drawn: the scene's light or a heat map of its structure, with or without the structure's bounds.

use std::io::{self, Seek, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use raywood_render::{
    Aov, BoundsOverlay, Contents, Ended, Features, Film, Goal, HeatMap, HeatQuantity, Image,
    ImageFormat, Keeper, Layer, LayerSources, Part, PreparedScene, Progress, RayCounts,
    RenderError, RenderOptions, RenderStats, RgbImage, Shot, ToneMap, View, WriteOptions,
    bounds_overlay, denoise, exposure_for, features, heat_map, key_exposure, noise, primitive_ids,
    render, render_passes,
};

use crate::checkpoint::Checkpoint;
use crate::failure::Failure;
use crate::interrupt::AskOnInterrupt;
use crate::parse::Exposure;
use crate::print;
use crate::progress_bar::{during_passes, during_rendering};

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
    pub(crate) exposure: Option<Exposure>,
    /// How it is shown.
    pub(crate) tone_map: &'static ToneMap,
    /// Whether the light is kept as it is, and not shown.
    pub(crate) keeps_light: bool,
    /// When the picture is good enough.
    pub(crate) goal: Goal,
    /// The layers beside it.
    pub(crate) aovs: &'a [Aov],
    /// Whether noise is removed.
    pub(crate) denoise: bool,
    /// Which pixels are rendered.
    pub(crate) part: Part,
    /// Where what there is is kept.
    pub(crate) checkpoint: Option<&'a Checkpoint>,
}

/// A picture, and what a report says of it.
pub(crate) struct Drawn {
    picture: Picture,
    pub(crate) render: RenderStats,
    pub(crate) heat: Option<Heat>,
    pub(crate) bounds: Option<Bounds>,
    /// How much of the light is shown.
    pub(crate) exposure: f32,
    pub(crate) passes: Option<Passes>,
    /// Whether the film was kept, if that was asked for: there is a picture all the same.
    pub(crate) kept: Result<(), Failure>,
}

/// What a report says of a picture in passes.
pub(crate) struct Passes {
    /// The fewest and the most samples of a pixel, and their mean.
    pub(crate) samples: (u32, u32),
    pub(crate) mean_samples: f64,
    /// The relative error, if it can be estimated.
    pub(crate) noise: Option<f32>,
    /// Whether noise was removed.
    pub(crate) is_denoised: bool,
    pub(crate) ended: Ended,
}

/// Light as it was computed, or what was drawn into.
enum Picture {
    Light(Image, Vec<Layer>),
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

    let &Request { prepared, view: View { camera, .. }, options, .. } = request;
    let Some(quantity) = request.heatmap else {
        let Light { image, layers, stats, passes, usual_exposure, kept } = light(request, pool)?;
        let exposure = match request.exposure {
            _ if request.keeps_light => 1.0,
            exposure => exposure_of(&image, exposure, || match usual_exposure {
                Some(exposure) => Ok(exposure),
                None => find_exposure(prepared, request.view, options, pool),
            })?,
        };
        let image = image.exposed(exposure).with_tone_map(request.tone_map);
        let picture = match &overlay {
            None => Picture::Light(image, layers),
            Some(_) => Picture::Drawn(draw_over(image.to_rgb_image())),
        };
        return Ok(Drawn { picture, render: stats, heat: None, bounds, exposure, passes, kept });
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
    Ok(Drawn {
        picture,
        render: stats,
        heat: Some(heat),
        bounds,
        exposure: 1.0,
        passes: None,
        kept: Ok(()),
    })
}

/// How much of the light of an image is shown; `usual` is that if nobody says.
pub(crate) fn exposure_of(
    image: &Image,
    asked: Option<Exposure>,
    usual: impl FnOnce() -> Result<f32, Failure>,
) -> Result<f32, Failure> {
    match asked {
        _ if image.are_numbers() => Ok(1.0),
        Some(Exposure::Factor(factor)) => Ok(factor),
        Some(Exposure::Auto) => Ok(key_exposure(image)),
        None => usual(),
    }
}

/// How much of the light is shown if nobody says: of a path tracer's picture as much as it has room for.
pub(crate) fn find_exposure(
    prepared: &PreparedScene<'_>,
    View { camera, lights }: &View,
    options: &RenderOptions,
    pool: &ThreadPool,
) -> Result<f32, Failure> {
    if options.integrator.name != "path" {
        return Ok(1.0);
    }
    traced(pool, |progress| exposure_for(prepared, camera, lights, options, progress))
}

/// Whether a picture's samples come a few at a time: where they are slow, or nobody knows how many there will be or how noisy they are.
pub(crate) fn is_in_passes(options: &RenderOptions, goal: &Goal, aovs: &[Aov]) -> bool {
    let is_open = goal.is_open() || aovs.iter().any(|aov| aov.is_of_film());
    is_open || options.integrator.name == "path"
}

/// The light of a picture: on a film where it comes in passes or parts or is kept, and Ctrl-C leaves what there is; else at once, which gives the same as a film of one pass.
fn light(request: &Request<'_>, pool: &ThreadPool) -> Result<Light, Failure> {
    let &Request { prepared, view: View { camera, lights }, options, goal, aovs, .. } = request;
    let &Request { part, checkpoint, .. } = request;
    let in_one_pass = !is_in_passes(options, &goal, aovs);
    if in_one_pass && part == Part::Whole && checkpoint.is_none() {
        let draw = |progress: &_| render(prepared, camera, lights, options, progress);
        let (image, stats) = traced(pool, draw)?;
        let layers = beside(request, None, pool)?.1;
        return Ok(Light {
            image,
            layers,
            stats,
            passes: None,
            usual_exposure: None,
            kept: Ok(()),
        });
    }

    // Who has the film alone later should know how it is shown.
    let usual_exposure =
        checkpoint.map(|_| find_exposure(prepared, request.view, options, pool)).transpose()?;
    let progress = Arc::new(Progress::new());
    let asked = Arc::clone(&progress);
    let guard = AskOnInterrupt::new(move || asked.cancel());
    let mut film = match checkpoint.and_then(Checkpoint::take_film) {
        Some(film) => film,
        None => Film::new(options.width, options.height).map_err(failure)?,
    };
    let shot = Shot { scene: prepared, camera, lights, options, part };
    let goal = Goal { in_one_pass, ..goal };
    let result = {
        let exposure = usual_exposure.unwrap_or(1.0);
        let mut keep =
            |film: &Film| checkpoint.map_or(Duration::MAX, |file| file.keep(film, exposure));
        let keeper = checkpoint.map(|file| Keeper { every: file.every, keep: &mut keep });
        let (film, progress) = (&mut film, &*progress);
        let passes = || pool.install(|| render_passes(&shot, &goal, film, progress, keeper));
        match in_one_pass {
            true => during_rendering(progress, passes),
            false => during_passes(progress, passes),
        }
    };
    drop(guard);
    let mut kept = Ok(());
    if let (Some(file), Some(exposure)) = (checkpoint, usual_exposure) {
        if matches!(result, Ok(_) | Err(RenderError::Cancelled)) {
            let is_finished = result.as_ref().is_ok_and(|(_, ended)| *ended != Ended::Cancelled);
            kept = file.save(&film, exposure, is_finished);
        }
        if let Err(RenderError::Cancelled) = result {
            kept?;
            let name = file.path().display();
            return Err(Failure::Interrupted(format!(
                "before there was a picture; {name} has what was done, --resume goes on"
            )));
        }
    }
    let (stats, ended) = result.map_err(failure)?;

    let noise = noise(&film, &part);
    let (features, mut layers) = beside(request, Some(&film), pool)?;
    let denoised = features
        .filter(|_| request.denoise)
        .and_then(|features| pool.install(|| denoise(&film, &features)));
    if request.denoise && denoised.is_none() {
        print::warning("too few passes to know the noise, none is removed");
    }
    let passes = Passes {
        samples: film.samples_in(&part),
        mean_samples: film.mean_samples_in(&part),
        noise: noise.is_finite().then_some(noise),
        is_denoised: denoised.is_some(),
        ended,
    };
    if let Part::Region(region) = part {
        layers = layers.iter().map(|layer| layer.cropped(film.width(), region)).collect();
        film = film.cropped(region);
    }
    let image = denoised.unwrap_or_else(|| film.image(options.integrator.shows_light));
    Ok(Light { image, layers, stats, passes: Some(passes), usual_exposure, kept })
}

/// What was computed.
struct Light {
    image: Image,
    layers: Vec<Layer>,
    stats: RenderStats,
    passes: Option<Passes>,
    /// How much of it is shown if nobody says, where that was found already.
    usual_exposure: Option<f32>,
    /// Whether the film was kept, if that was asked for.
    kept: Result<(), Failure>,
}

/// What is wanted beside the light: features if noise is to be removed, and layers. From the rays that all pixels of the picture have.
fn beside(
    request: &Request<'_>,
    film: Option<&Film>,
    pool: &ThreadPool,
) -> Result<(Option<Features>, Vec<Layer>), Failure> {
    let &Request { prepared, view: View { camera, .. }, options, aovs, .. } = request;
    let samples = film.map_or(options.samples, |film| film.samples_in(&request.part).0);
    let needs_features = request.denoise || aovs.iter().any(|aov| aov.is_feature());
    let find = |progress: &_| features(prepared, camera, options, samples, progress);
    let found = needs_features.then(|| traced(pool, find)).transpose()?;
    let number = |progress: &_| primitive_ids(prepared, camera, options, progress);
    let needs_ids = aovs.contains(&Aov::Ids);
    let ids = needs_ids.then(|| traced(pool, number)).transpose()?;
    let sources = LayerSources { features: found.as_ref(), ids: ids.as_deref(), film };
    let layers = aovs.iter().flat_map(|aov| aov.layers(&sources)).collect();
    Ok((found, layers))
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
    during_rendering(&progress, || pool.install(|| work(&progress))).map_err(failure)
}

/// Why there is no picture.
fn failure(error: RenderError) -> Failure {
    match error {
        RenderError::OutOfMemory { .. } => Failure::while_running(error),
        RenderError::Cancelled => {
            Failure::Interrupted("before there was a picture; nothing is written".to_owned())
        }
        error => Failure::bad_input(error),
    }
}

impl Drawn {
    /// Writes the picture.
    pub(crate) fn write(
        &self,
        format: &ImageFormat,
        options: &WriteOptions,
        writer: impl Write + Seek,
    ) -> io::Result<()> {
        let contents = match &self.picture {
            Picture::Light(image, layers) => Contents::Computed(image, layers),
            Picture::Drawn(image) => Contents::Drawn(image),
        };
        format.write(contents, options, writer)
    }

    /// How many samples a pixel has, in words; `asked` is how many it was to have.
    pub(crate) fn samples(&self, asked: u32) -> String {
        match &self.passes {
            None => asked.to_string(),
            Some(Passes { samples, mean_samples, .. }) => samples_in_words(*samples, *mean_samples),
        }
    }
}

/// The fewest and the most samples of a pixel and their mean, in words.
pub(crate) fn samples_in_words((fewest, most): (u32, u32), mean: f64) -> String {
    match fewest == most {
        true => most.to_string(),
        false => format!("{fewest} to {most} (on average {mean:.1})"),
    }
}

impl Heat {
    fn of(map: &HeatMap, scale: f32) -> Self {
        let (mean, max) = (map.mean(), map.max());
        Self { quantity: map.quantity, mean, max, scale, pixels_above: map.pixels_above(scale) }
    }
}
