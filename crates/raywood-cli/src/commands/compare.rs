//! `raywood compare`: all structures on one scene, with the same rays.

use raywood::StructureKind;
use raywood_lab::{CompareError, CompareOptions, compare};
use raywood_render::PreparedScene;

use super::thread_pool;
use crate::exporters::{Compared, Format};
use crate::failure::Failure;
use crate::parse::structure_kind;
use crate::print;
use crate::progress_bar::{during_step, during_steps};
use crate::scene_source::{self, Loaded};
use crate::view_args::ViewArgs;

/// Compare the acceleration structures on a scene.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:terrain
    #[arg(default_value = "builtin:hall", hide_default_value = true)]
    scene: String,

    /// Which, separated by commas [default: all]
    ///
    /// A wrong name is answered with those that exist.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = structure_kind)]
    structures: Vec<StructureKind>,

    /// Most rays of each kind
    ///
    /// Primary, shadow, reflection and diffuse rays, those that the scene's view has. Structures that would take too long trace a sample.
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,

    /// Rounds of timing
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    rounds: u32,

    /// table, markdown, csv or json
    ///
    /// `table` is for reading in a terminal, `markdown` for pasting into a page, `csv` has one line per structure and kind of rays, `json` everything.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = Format::Table, hide_possible_values = true)]
    format: Format,

    /// Threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    #[command(flatten)]
    view: ViewArgs,

    /// Refuse what is otherwise mended
    #[arg(long)]
    strict: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let mut options = CompareOptions {
        rays: args.rays as usize,
        rounds: args.rounds as usize,
        ..CompareOptions::default()
    };
    if !args.structures.is_empty() {
        options.kinds.clear();
        for &kind in &args.structures {
            if !options.kinds.contains(&kind) {
                options.kinds.push(kind);
            }
        }
    }

    let pool = thread_pool(args.threads.map(usize::from))?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let Loaded { mut scene, .. } = loaded;
    args.view.orient(&mut scene);

    let prepared = during_step("preparing", || pool.install(|| PreparedScene::new(&scene)))
        .map_err(Failure::bad_input)?;
    let choose = || args.view.view(&prepared, options.aspect);
    let view = during_step("choosing a view", || pool.install(choose))?;
    let comparison =
        during_steps(|step| pool.install(|| compare(&prepared, &view, &options, step)));
    let comparison = comparison.map_err(|error| match error {
        CompareError::Mismatch(_) => Failure::while_running(error),
        error => Failure::bad_input(error),
    })?;
    print::result(&args.format.write(&Compared { scene: &scene.name, comparison: &comparison }))
}
