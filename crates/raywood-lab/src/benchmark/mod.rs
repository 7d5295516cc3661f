//! How fast a machine traces rays through a structure: by kind of ray, level of instructions and number of threads, in core cycles too,
//! and pictures as a whole.

mod clock;
mod error;
mod pictures;
mod rays;
mod speed;
mod team;

use raywood::{Geometry, SimdLevel, StructureKind};
use raywood_render::{PreparedScene, RenderOptions, View};

use crate::flat::structure_of;
use crate::{RayKind, RaySetSummary};
pub use clock::Clock;
pub use error::BenchmarkError;
pub use pictures::Pictures;
pub use rays::RaySpeed;
pub use speed::Speed;
use team::Team;

/// What is measured, and how thoroughly.
#[derive(Clone, Debug)]
pub struct BenchmarkOptions {
    /// The most rays of each kind.
    pub rays: usize,
    /// How often everything is timed, at least once.
    pub rounds: usize,
    /// On how many threads, beside one, on which everything is measured.
    pub threads: Vec<usize>,
    /// The picture that is rendered; primary rays have its shape.
    pub picture: RenderOptions,
}

impl Default for BenchmarkOptions {
    /// 65,536 rays of each kind, seven rounds, one thread and as many as there are cores, pictures of 1280 x 800 pixels.
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let picture = RenderOptions::default();
        Self { rays: 1 << 16, rounds: 7, threads: vec![cores], picture }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Benchmark {
    /// Primitives of the scene.
    pub primitives: usize,
    /// The structure that was traced.
    pub structure: StructureKind,
    /// The level of instructions in use; `None` if the structure uses no vector instructions.
    pub level: Option<SimdLevel>,
    /// The levels that were measured, the fastest last; none if the structure uses no vector instructions.
    pub levels: Vec<SimdLevel>,
    /// The clock of the cores while so many threads worked, fewest threads first.
    pub clocks: Vec<Clock>,
    /// The sets of rays.
    pub ray_sets: Vec<RaySetSummary>,
    /// How fast the rays of each set were traced: by the level in use on every number of threads, by the others on one.
    pub rays: Vec<RaySpeed>,
    /// How fast pictures were rendered.
    pub pictures: Pictures,
}

/// Measures how fast the scene's structure traces the rays that the view has, and how fast pictures are rendered with it.
///
/// Times are medians of rounds in which all levels, numbers of threads and kinds of rays take turns; pictures, which take longer, do so
/// among themselves. Before, all their answers are held against each other and against the default structure's, those of the default structure
/// for a sample against brute force's: they agree, or the benchmark is an error. Of the levels of instructions only those are measured that are not above the one that the
/// structure uses, which it uses again in the end. Works in rayon pools of its own. `step` is told what is being done.
///
/// # Errors
///
/// A camera through which nothing can be seen, a picture that cannot be rendered, threads that cannot be started, or answers that differ.
pub fn benchmark(
    scene: &mut PreparedScene<'_>,
    view: &View,
    options: &BenchmarkOptions,
    mut step: impl FnMut(&str),
) -> Result<Benchmark, BenchmarkError> {
    let mut numbers = options.threads.clone();
    numbers.push(1);
    numbers.sort_unstable();
    numbers.dedup();
    let mut teams = numbers.into_iter().map(Team::new).collect::<Result<Vec<_>, _>>()?;

    let level = structure_of(scene).simd_level();
    let levels = SimdLevel::available().filter(|other| level.is_some_and(|most| *other <= most));
    let levels: Vec<_> = levels.collect();
    let measured = rays::measure(scene, view, options, &levels, &mut teams, &mut step);
    if let Some(level) = level {
        scene.set_simd_level(level);
    }
    let (ray_sets, rays) = measured?;
    let pictures = pictures::measure(scene, view, options, &rays, &mut teams, &mut step)?;
    Ok(Benchmark {
        primitives: structure_of(scene).geometry().len(),
        structure: structure_of(scene).kind(),
        level,
        levels,
        clocks: teams.iter().map(Team::clock).collect(),
        ray_sets,
        rays,
        pictures,
    })
}

impl Benchmark {
    /// Core cycles for a ray, those of all cores together, by the estimated clock; 0 if there were no rays.
    pub fn cycles_per_ray(&self, speed: &Speed) -> f64 {
        let clock = self.clocks.iter().find(|clock| clock.threads == speed.threads);
        clock.map_or(0.0, |clock| clock.cores as f64 * speed.seconds_per_ray() * clock.hertz())
    }

    /// The rays of a kind on one thread, by each level of instructions.
    pub fn by_level(&self, kind: RayKind) -> impl Iterator<Item = &RaySpeed> {
        self.rays.iter().filter(move |rays| rays.kind == kind && rays.speed.threads == 1)
    }

    /// The rays of a kind by the level in use, on each number of threads, fewest first.
    pub fn by_threads(&self, kind: RayKind) -> impl Iterator<Item = &RaySpeed> {
        self.rays.iter().filter(move |rays| rays.kind == kind && rays.level == self.level)
    }
}
