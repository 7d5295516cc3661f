//! Pictures as a whole: rays generated, traced, shaded and gathered in an image.

use std::iter;

use raywood_render::{Image, PreparedScene, Progress, RayCounts, View, render};

use super::{BenchmarkError, BenchmarkOptions, RaySpeed, Speed, Team};
use crate::RayKind;
use crate::flat::structure_of;
use crate::timing::{seconds, take_turns};

/// Pictures are rendered no longer than for so many seconds, if not for one of them.
const SECONDS: f64 = 12.0;

/// A picture that would take longer on one thread is not rendered.
const MOST_SECONDS: f64 = 20.0;

/// How many rays a pixel is expected to take before it is known.
const RAYS_PER_PIXEL: f64 = 3.0;

/// How fast pictures were rendered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The rays of a picture.
    pub rays: RayCounts,
    /// How fast, on each number of threads, fewest first; nothing if it would have taken too long.
    pub speeds: Vec<Speed>,
}

/// Renders the picture on every number of threads.
pub(super) fn measure(
    scene: &PreparedScene<'_>,
    view: &View,
    options: &BenchmarkOptions,
    rays: &[RaySpeed],
    teams: &mut [Team],
    step: &mut impl FnMut(&str),
) -> Result<Pictures, BenchmarkError> {
    let (width, height) = (options.picture.width, options.picture.height);
    let mut pictures = Pictures { width, height, ..Pictures::default() };
    let level = structure_of(scene).simd_level();
    let primary = |rays: &&RaySpeed| rays.kind == RayKind::Primary && rays.level == level;
    let speed = rays.iter().find(primary).map(|rays| &rays.speed);
    let per_ray = speed.map_or(0.0, |speed| speed.threads as f64 * speed.seconds_per_ray());
    let samples = f64::from(width) * f64::from(height) * f64::from(options.picture.samples);
    if RAYS_PER_PIXEL * samples * per_ray > MOST_SECONDS {
        return Ok(pictures);
    }

    // Once with all, to see that the pictures are the same and how long they take.
    step("rendering pictures");
    let picture = || render(scene, &view.camera, &view.lights, &options.picture, &Progress::new());
    let mut first: Option<(Image, usize)> = None;
    let mut all_seconds = 0.0;
    for team in &*teams {
        let (seconds, rendered) = seconds(|| team.run(picture));
        let (image, stats) = rendered.map_err(BenchmarkError::Render)?;
        all_seconds += seconds;
        pictures.rays = stats.rays;
        match &first {
            None => first = Some((image, team.threads())),
            Some((expected, threads)) if *expected != image => {
                return Err(BenchmarkError::Picture { threads: [*threads, team.threads()] });
            }
            Some(_) => {}
        }
    }

    // By turns, as often as there is time.
    let rounds = (1..=options.rounds).take_while(|&rounds| rounds as f64 * all_seconds <= SECONDS);
    let timings = take_turns(teams.len(), rounds.count().max(1), |number| {
        Some(teams[number].measure(|| seconds(picture)).0)
    });
    let total = pictures.rays.total();
    let speed = |(team, timing): (&Team, _)| Speed { threads: team.threads(), rays: total, timing };
    pictures.speeds = iter::zip(&*teams, timings.into_iter().flatten()).map(speed).collect();
    Ok(pictures)
}
