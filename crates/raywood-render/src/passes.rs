//! Pictures in passes, each of a few samples a pixel, until they are good enough or time is up. After every pass there is a whole picture.
//!
//! Where the noise decides, squares of 16x16 pixels go on or are done on their own (after Dammertz, Hanika, Keller and Lensch, "A Hierarchical
//! Automatic Stopping Condition for Monte Carlo Global Illumination", 2010): what is learnt from hundreds of pixels together hardly depends on
//! any of them, so that stopping does not favour pixels whose samples happen to agree.

use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use raywood_scene::{Camera, Light, Rgb, luminance};

use crate::PreparedScene;
use crate::exposure::preview;
use crate::film::{Film, FilmPixel};
use crate::integrators::{Frame, TileRenderer};
use crate::lights::Lights;
use crate::options::{RenderError, RenderOptions};
use crate::part::Part;
use crate::progress::{Progress, Standing};
use crate::stats::{RayCounts, RenderStats};
use crate::tiles::{SQUARE_SIZE, Tile, TilePass, TilePixels};

/// What is rendered.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// The scene.
    pub scene: &'a PreparedScene<'a>,
    /// From where it is seen.
    pub camera: &'a Camera,
    /// What lights it; usually its own lights, or those of its [default view](crate::default_view).
    pub lights: &'a [Light],
    /// How it is rendered.
    pub options: &'a RenderOptions,
    /// Which pixels.
    pub part: Part,
}

/// When a picture is done, beside having all samples that its options ask for: what comes first counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// The relative error at which a square of pixels is done: the root mean square of its standard errors over its mean brightness and a tenth of that of a small picture of all.
    pub noise: Option<f32>,
    /// How long passes may take.
    pub time: Option<Duration>,
    /// Whether pixels get all samples in one pass, as [`render`](crate::render) gives them, so that the picture is the same, bit for bit; nothing is known of its noise then. Without effect if
    /// the goal [is open](Self::is_open).
    pub in_one_pass: bool,
}

impl Goal {
    /// Whether nobody knows beforehand how many samples there will be.
    pub fn is_open(&self) -> bool {
        self.noise.is_some() || self.time.is_some()
    }

    /// How many samples the next pass adds to pixels that have so many: few at first, so that there is soon a picture and a variance, then so many that no tile waits for long.
    fn pass_samples(&self, samples: u32) -> u32 {
        match self.in_one_pass && !self.is_open() {
            true => u32::MAX,
            false => samples.clamp(4, 16).next_power_of_two(),
        }
    }
}

/// Who keeps what there is of a picture while it is rendered, in case that it is broken off.
pub struct Keeper<'a> {
    /// Between how much work it is called at most; it tells after how much next.
    pub every: Duration,
    /// Is shown the film between tiles, while nothing is rendered.
    pub keep: &'a mut (dyn FnMut(&Film) -> Duration + Send),
}

/// Why there are no more passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All samples are there.
    Samples,
    /// The noise is as low as it was to be.
    Noise,
    /// Another pass would take too long.
    Time,
    /// Somebody asked to stop.
    Cancelled,
}

/// Samples a pixel has at least before its square may be done.
const FEWEST_SAMPLES: u32 = 16;

/// Between two pauses something is rendered, whatever a keeper says.
const SHORTEST_WORK: Duration = Duration::from_millis(10);

/// Of pictures whose number of samples is open textures are looked at as if there were so many.
const OPEN_SAMPLES: u32 = 16;

/// Renders passes and adds them to a film, on the threads of the current rayon pool, until the options' samples are there or a goal is reached.
///
/// A film with light goes on as if it had never stopped: which samples of a tile come next follows from those that it has, and a tile is there whole or not at all. Without a limit of time the film is the
/// same, bit for bit, for any number of threads, wherever it was broken off, and whichever [parts](Part) it was put together from. After [`Progress::cancel`] it keeps all tiles that were finished. Of a
/// picture rendered [at once](crate::render) it differs in last digits, as sums are made in another order, unless all is [in one pass](Goal::in_one_pass).
///
/// # Errors
///
/// As [`render`](crate::render); [`RenderError::Cancelled`] if some pixels have no sample yet, though others may have; [`RenderError::NoPart`] for a part without pixels of the picture.
///
/// # Panics
///
/// If the film is of another size than the picture.
pub fn render_passes(
    shot: &Shot<'_>,
    goal: &Goal,
    film: &mut Film,
    progress: &Progress,
    mut keeper: Option<Keeper<'_>>,
) -> Result<(RenderStats, Ended), RenderError> {
    let &Shot { scene, camera, lights, options, part } = shot;
    options.validate()?;
    let bytes = options.memory_bytes().saturating_add(Film::bytes(options.width, options.height));
    let (width, height) = (options.width, options.height);
    if bytes > RenderOptions::MOST_BYTES {
        return Err(RenderError::ImageTooLarge { width, height, bytes });
    }
    assert_eq!((film.width(), film.height()), (width, height), "the size of the film");
    part.validate(width, height)?;
    let tiles = part.tiles(width, height);

    let started = Instant::now();
    // Of the whole picture, whichever part of it is rendered and how far it is: so each tile can be judged on its own.
    let mean = match goal.noise {
        Some(_) => mean_luminance(preview(scene, camera, lights, options, progress)?.pixels()),
        None => 0.0,
    };
    let lights = Lights::new(lights);
    let mut frame = Frame::new(scene, &lights, camera, options, progress)?;
    if goal.is_open() {
        frame.footprint_samples = OPEN_SAMPLES.min(options.samples);
    }
    let renderer = options.integrator.start(&frame);
    let mut work = TileWork::all(&tiles, bytes)?;
    let pixels: u64 = tiles.iter().map(|tile| u64::from(tile.width * tile.height)).sum();

    let mut rays = RayCounts::default();
    let mut rendered = 0u64;
    let mut pause: Option<Instant> =
        keeper.as_ref().and_then(|keeper| started.checked_add(keeper.every.max(SHORTEST_WORK)));
    let ended = loop {
        // Choose what each square is given next.
        let threshold = goal.noise.unwrap_or(0.0);
        let is_done = |square: [u32; 2], samples: u32| {
            goal.noise.is_some()
                && samples >= FEWEST_SAMPLES
                && relative_error(film, square, mean) <= threshold
        };
        let mut most = u32::MAX;
        if let Some(time) = goal.time {
            // One sample first, to see how long it takes.
            most = match rendered {
                0 => 1,
                _ => {
                    let left = time.saturating_sub(started.elapsed()).as_secs_f64();
                    let each = started.elapsed().as_secs_f64() / rendered as f64;
                    (left / (each * pixels as f64)) as u32
                }
            };
        }
        let mut planned = 0;
        let mut are_all_done = true;
        for TileWork { tile, pass, .. } in &mut work {
            *pass = TilePass::default();
            for (place, square) in tile.squares().enumerate() {
                let corner = [tile.x + square[0], tile.y + square[1]];
                let samples = first_samples(film, corner);
                if samples >= options.samples || is_done(corner, samples) {
                    continue;
                }
                are_all_done = false;
                let count = goal.pass_samples(samples).min(most).min(options.samples - samples);
                pass.samples[place] = samples..samples + count;
                planned += u64::from(count) * tile.pixels_in_blocks(square).count() as u64;
            }
        }
        if are_all_done {
            let (fewest, _) = film.samples_in(&part);
            break if fewest >= options.samples { Ended::Samples } else { Ended::Noise };
        }
        if planned == 0 {
            break Ended::Time;
        }

        // Render, and keep what is whole; what was done before a pause is not done again after it.
        progress.start(planned);
        loop {
            let render = |work: &mut TileWork| work.render(&*renderer, progress, pause);
            rays += work.par_iter_mut().with_max_len(1).map(render).sum();
            work.iter_mut().for_each(|work| work.add_to(film));
            progress.set_standing(standing(film, &part, options, goal, started.elapsed()));
            if progress.is_cancelled() {
                break;
            }
            if let (Some(keeper), true) = (&mut keeper, pause.is_some_and(is_past)) {
                let next = (keeper.keep)(film).max(SHORTEST_WORK);
                pause = Instant::now().checked_add(next);
            }
            if work.iter().all(|work| work.pass.is_empty()) {
                break;
            }
        }
        rendered += planned;
        if progress.is_cancelled() {
            let (fewest, _) = film.samples_in(&part);
            if fewest == 0 {
                return Err(RenderError::Cancelled);
            }
            break Ended::Cancelled;
        }
    };
    let threads = rayon::current_num_threads();
    Ok((RenderStats { rays, elapsed: started.elapsed(), threads }, ended))
}

fn is_past(time: Instant) -> bool {
    Instant::now() >= time
}

/// The samples of the pixels of a square: of its first, as all have as many.
fn first_samples(film: &Film, corner: [u32; 2]) -> u32 {
    film.part(corner, [1; 2]).next().map_or(0, |pixel| pixel.samples)
}

/// The mean luminance of some pixels.
fn mean_luminance<'a>(pixels: impl IntoIterator<Item = &'a Rgb>) -> f32 {
    let luminances = pixels.into_iter().map(|&pixel| f64::from(luminance(pixel)));
    let (count, sum) = luminances.fold((0u64, 0.0), |(count, sum), one| (count + 1, sum + one));
    (sum / count.max(1) as f64) as f32
}

/// The relative error of a square of 16x16 pixels of a film, given by its upper left corner: the root of the mean variance of its pixels' means, divided by
/// their mean luminance and a tenth of that of the picture, `mean`, so that what is almost black need not be exact.
///
/// The variance is [estimated](FilmPixel::variance) from how much passes differ; infinite before the second pass.
fn relative_error(film: &Film, corner: [u32; 2], mean: f32) -> f32 {
    const OF_THE_PICTURE: f32 = 0.1;
    let (mut count, mut variance, mut light) = (0.0, 0.0, 0.0);
    for pixel in film.part(corner, [SQUARE_SIZE; 2]) {
        count += 1.0;
        variance += pixel.variance();
        light += luminance(pixel.mean());
    }
    if variance == 0.0 {
        return 0.0;
    }
    (variance / count).sqrt() / (light / count + OF_THE_PICTURE * mean)
}

/// The noise of a part of a film: the root mean square of the relative errors of all its squares. Infinite before there are two passes everywhere; 0 without pixels.
pub fn noise(film: &Film, part: &Part) -> f32 {
    let means: Vec<_> = part.pixels(film).map(FilmPixel::mean).collect();
    let mean = mean_luminance(&means);
    let (mut sum, mut count) = (0.0, 0u32);
    for tile in part.tiles(film.width(), film.height()) {
        for [x, y] in tile.squares() {
            sum += relative_error(film, [tile.x + x, tile.y + y], mean).powi(2);
            count += 1;
        }
    }
    (sum / count.max(1) as f32).sqrt()
}

/// How far a picture is.
fn standing(
    film: &Film,
    part: &Part,
    options: &RenderOptions,
    goal: &Goal,
    elapsed: Duration,
) -> Standing {
    let noise = noise(film, part);
    let (_, samples) = film.samples_in(part);
    // Of a single pass nobody has to guess.
    let by_samples = match goal.in_one_pass {
        true => film.mean_samples_in(part) / f64::from(options.samples),
        false => f64::from(samples) / f64::from(options.samples),
    };
    // The error falls with the root of the number of samples.
    let by_noise = goal.noise.map_or(0.0, |goal| f64::from(goal / noise).powi(2));
    let by_time = goal.time.map_or(0.0, |time| elapsed.as_secs_f64() / time.as_secs_f64());
    let fraction = by_samples.max(by_noise).max(by_time).clamp(0.0, 1.0);
    Standing { samples, noise: noise.is_finite().then_some(noise), fraction }
}

/// A tile, what of it is rendered next, and what came out.
struct TileWork {
    tile: Tile,
    pass: TilePass,
    is_whole: bool,
    sums: TilePixels,
}

impl TileWork {
    /// Room for all tiles.
    fn all(tiles: &[Tile], bytes: u64) -> Result<Vec<Self>, RenderError> {
        let mut work = Vec::new();
        work.try_reserve_exact(tiles.len()).map_err(|_| RenderError::OutOfMemory { bytes })?;
        work.extend(tiles.iter().map(|&tile| Self {
            tile,
            pass: TilePass::default(),
            is_whole: false,
            sums: [Rgb::ZERO; _],
        }));
        Ok(work)
    }

    /// Renders what is next, if nobody asks to stop and it is no time for a pause.
    fn render(
        &mut self,
        renderer: &dyn TileRenderer,
        progress: &Progress,
        pause: Option<Instant>,
    ) -> RayCounts {
        self.is_whole = false;
        if self.pass.is_empty() || progress.is_cancelled() || pause.is_some_and(is_past) {
            return RayCounts::default();
        }
        self.sums = [Rgb::ZERO; _];
        let rays = renderer.render_tile(&self.tile, &self.pass, &mut self.sums);
        self.is_whole = !progress.is_cancelled();
        progress.add(self.pass.pixel_samples(&self.tile));
        rays
    }

    /// Adds what was rendered to a film, if it is whole, and then has nothing to do.
    fn add_to(&mut self, film: &mut Film) {
        if !self.is_whole {
            return;
        }
        self.is_whole = false;
        for (samples, square) in std::mem::take(&mut self.pass).squares(&self.tile) {
            let Range { start, end } = samples;
            for (number, place) in self.tile.pixels_in_blocks(square) {
                let pass = FilmPixel {
                    sum: self.sums[number as usize],
                    samples: end - start,
                    passes: 1,
                    deviation: 0.0,
                };
                film.pixel_mut(place).merge(&pass);
            }
        }
    }
}
