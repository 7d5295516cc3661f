//! `raywood compare`: all structures on one scene, with the same rays.

use std::path::PathBuf;

use raywood::{BuildError, StructureKind};
use raywood_lab::{CompareError, CompareOptions, Comparison, RayKind, SceneStructure, compare};
use raywood_render::{HeatMap, HeatQuantity, PreparedScene, Progress, RenderOptions, heat_map};
use raywood_scene::{Camera, Scene};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::exporters::Format;
use crate::exporters::comparison::Compared;
use crate::exporters::comparison::html::{self, HeatMaps, Map};
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::parse::{structure_kind, whole_number};
use crate::print;
use crate::progress_bar::{during_step, during_steps};
use crate::scene_source::{self, Loaded};
use crate::simd_args::SimdArgs;
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
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = |text: &str| whole_number(text, 1, 1 << 24))]
    rays: u32,

    /// Rounds of timing
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = |text: &str| whole_number(text, 1, 10_000))]
    rounds: u32,

    /// table, markdown, csv or json
    ///
    /// `table` is for reading in a terminal, `markdown` for pasting into a page, `csv` has one line per structure and kind of rays, `json` everything.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = Format::Table, hide_possible_values = true)]
    format: Format,

    /// Also write a page with charts
    ///
    /// One self-contained page with the tables, bar charts, and heat maps of all structures side by side.
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,

    /// Threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

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
    let mut options = CompareOptions {
        rays: args.rays as usize,
        rounds: args.rounds as usize,
        build: args.build.options(),
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

    let page = args.html.as_deref().map(OutputFile::new).transpose()?;

    let pool = thread_pool(args.threads.map(usize::from))?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let loaded = loaded.without_instances("a comparison of structures")?;
    let Loaded { mut scene, tree, .. } = loaded;
    args.view.orient(&mut scene);

    let prepared = args.build.prepare(&scene, tree.as_ref(), StructureKind::default(), &pool)?;
    let choose = || args.view.view(&prepared, options.aspect, None, None);
    let view = during_step("choosing a view", || pool.install(choose))?;
    let comparison =
        during_steps(|step| pool.install(|| compare(&prepared, &view, &options, step)));
    let (comparison, structures) = comparison.map_err(|error| match error {
        CompareError::Mismatch(_) => Failure::while_running(error),
        CompareError::Build(kind, error @ BuildError::MemoryLimit { .. }) => {
            args.build.failure(&error, kind, &scene)
        }
        error => Failure::bad_input(error),
    })?;
    let compared = Compared { scene: &scene.name, comparison: &comparison };
    if let Some(page) = page {
        let maps = during_steps(|step| {
            pool.install(|| heat_maps(&scene, structures, &view.camera, &comparison, step))
        })?;
        let text = html::write(&compared, &maps)?;
        page.write(|writer| writer.write_all(text.as_bytes()))?;
    }
    print::result(&args.format.write(&compared))
}

/// The size of the heat maps on the page.
const MAP_SIZE: [u32; 2] = [480, 300];

/// A heat map that would take longer than this many seconds is left out.
const MAP_SECONDS: f64 = 10.0;

/// Heat maps of all structures that are fast enough, all of one quantity on one scale.
fn heat_maps<'a>(
    scene: &'a Scene,
    structures: Vec<SceneStructure<'a>>,
    camera: &Camera,
    comparison: &Comparison,
    step: &mut (dyn FnMut(&str) + Send),
) -> Result<Vec<HeatMaps>, Failure> {
    let [width, height] = MAP_SIZE;
    let options = RenderOptions { width, height, samples: 1, ..RenderOptions::default() };
    let mut left_out = Vec::new();
    let mut prepared = Vec::new();
    for (structure, report) in structures.into_iter().zip(&comparison.structures) {
        let primary = report.traces.iter().find(|traces| traces.kind == RayKind::Primary);
        let speed = primary.map_or(0.0, |traces| 1e6 * traces.million_rays_per_second());
        if f64::from(width * height) / speed > MAP_SECONDS {
            left_out.push(structure.kind().name());
        } else {
            let kind = structure.kind();
            prepared.push((kind, PreparedScene::from_structure(scene, structure)));
        }
    }

    let mut all = Vec::new();
    for quantity in [HeatQuantity::Nodes, HeatQuantity::Primitives] {
        let mut maps = Vec::new();
        for (kind, prepared) in &prepared {
            step(&format!("heat map of {}", kind.name()));
            let map = heat_map(prepared, camera, &options, quantity, &Progress::new());
            maps.push(map.map_err(Failure::bad_input)?);
        }
        // The structure in the middle sets the scale: the worst would leave nothing to see of the others, and its legend says how much it
        // exceeds.
        let mut maxima: Vec<_> = maps.iter().map(HeatMap::default_maximum).collect();
        maxima.sort_unstable_by(f32::total_cmp);
        let maximum = maxima.get(maxima.len() / 2).copied().unwrap_or(1.0);
        let mut pictures = Vec::new();
        for map in &maps {
            let picture = map.with_legend(&map.picture(maximum), maximum);
            let png = picture.to_png().map_err(Failure::while_running)?;
            pictures.push(Map { name: map.structure.name(), png });
        }
        let title = format!("Heat maps: {}", quantity.label());
        all.push(HeatMaps { title, maps: pictures, left_out: left_out.clone() });
    }
    Ok(all)
}
