//! `raywood bench`: how fast this machine traces rays on a scene.

use std::time::Instant;

use raywood::StructureKind;
use raywood_lab::{BenchmarkError, BenchmarkOptions, benchmark};
use raywood_render::RenderOptions;

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::exporters::Format;
use crate::exporters::benchmark::Benched;
use crate::failure::Failure;
use crate::parse::{Size, structure_kind, whole_number};
use crate::print;
use crate::progress_bar::{during_step, during_steps};
use crate::scene_source::{self, Loaded};
use crate::simd_args::SimdArgs;
use crate::view_args::ViewArgs;

/// Measure how fast this machine traces rays on a scene.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:hall
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, a scene file (TOML) that puts several together, or a scene saved by `raywood build`; `raywood scenes` lists the built-in scenes. Else it is builtin:terrain.
    #[arg(default_value = "builtin:terrain", hide_default_value = true)]
    scene: String,

    /// Acceleration structure to trace
    ///
    /// A wrong name is answered with those that exist.
    #[arg(long, value_name = "NAME", value_parser = structure_kind)]
    structure: Option<StructureKind>,

    /// Most rays of each kind
    ///
    /// Primary, shadow, reflection and diffuse rays, those that the scene's view has. Slow structures trace a sample, and several threads as many copies of the rays.
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = |text: &str| whole_number(text, 1, 1 << 24))]
    rays: u32,

    /// Rounds of timing
    ///
    /// Pictures that take long are rendered less often.
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = |text: &str| whole_number(text, 1, 10_000))]
    rounds: u32,

    /// Numbers of threads beside 1, else all cores
    ///
    /// Separated by commas.
    #[arg(short, long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,

    /// Width and height of the picture
    #[arg(short, long, value_name = "WxH", default_value = "1280x800")]
    size: Size,

    /// table, markdown, csv or json
    ///
    /// `table` is for reading in a terminal, `markdown` for pasting into a page, `csv` has one line per kind of rays, level of instructions and number of threads, `json` everything.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = Format::Table, hide_possible_values = true)]
    format: Format,

    #[command(flatten)]
    build: BuildArgs,

    #[command(flatten)]
    simd: SimdArgs,

    #[command(flatten)]
    view: ViewArgs,

    /// Refuse what is otherwise mended
    #[arg(long, hide_short_help = true)]
    strict: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.simd.activate()?;
    let Size { width, height } = args.size;
    let picture = RenderOptions { width, height, ..RenderOptions::default() };
    picture.validate().map_err(Failure::bad_input)?;
    let mut options = BenchmarkOptions {
        rays: args.rays as usize,
        rounds: args.rounds as usize,
        picture,
        ..BenchmarkOptions::default()
    };
    if !args.threads.is_empty() {
        options.threads = args.threads.iter().copied().map(usize::from).collect();
    }

    // Build with as many threads as are measured at most.
    let pool = thread_pool(options.threads.iter().copied().max())?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let loaded = loaded.without_instances("a benchmark of structures")?;
    let Loaded { mut scene, tree, .. } = loaded;
    args.view.orient(&mut scene);
    let kind = args.structure.unwrap_or_default();
    let started = Instant::now();
    let mut prepared = args.build.prepare(&scene, tree.as_ref(), kind, &pool)?;
    let build = (started.elapsed().as_secs_f64(), pool.current_num_threads());

    let choose = || args.view.view(&prepared, width as f32 / height as f32, None, None);
    let view = during_step("choosing a view", || pool.install(choose))?;
    // The benchmark has threads of its own.
    drop(pool);
    let benchmark = during_steps(|step| benchmark(&mut prepared, &view, &options, step));
    let benchmark = benchmark.map_err(|error| match error {
        BenchmarkError::Camera(_) | BenchmarkError::Render(_) => Failure::bad_input(error),
        error => Failure::while_running(error),
    })?;
    let benched = Benched { scene: &scene.name, build, benchmark: &benchmark };
    print::result(&args.format.write(&benched))
}
