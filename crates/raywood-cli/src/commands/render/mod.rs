//! `raywood render`: a scene in, a picture out.

mod report;

use std::path::{Path, PathBuf};
use std::time::Instant;

use raywood::StructureKind;
use raywood_render::{HeatQuantity, INTEGRATORS, Integrator, RenderOptions};
use raywood_scene::{Environment, load_environment};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::parse::{Size, above_zero, exposure, heat_quantity, integrator, structure_kind};
use crate::picture::{self, Request};
use crate::print;
use crate::progress_bar::during_step;
use crate::scene_source::{self, Loaded};
use crate::simd_args::SimdArgs;
use crate::view_args::ViewArgs;
use report::Report;

/// Render a model file or a built-in scene to a PNG picture.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:whitted
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, or a scene saved by `raywood build`; `raywood scenes` lists the built-in scenes.
    #[arg(default_value = "builtin:hall", hide_default_value = true)]
    scene: String,

    /// The picture [default: render.png]
    #[arg(
        short,
        long,
        value_name = "FILE.png",
        default_value = "render.png",
        hide_default_value = true
    )]
    output: PathBuf,

    /// Width and height in pixels
    #[arg(short, long, value_name = "WxH", default_value = "1280x800")]
    size: Size,

    /// How to render, or what to show
    #[arg(
        short,
        long,
        value_name = "NAME",
        value_parser = integrator,
        default_value = INTEGRATORS[0].name,
        long_help = integrators_help()
    )]
    integrator: &'static Integrator,

    /// Rays per pixel, for smooth edges
    #[arg(short = 'n', long, value_name = "N", default_value_t = 4)]
    samples: u32,

    /// Most reflections and refractions
    ///
    /// How often light may be mirrored or refracted on its way to the eye.
    #[arg(long, value_name = "N", default_value_t = RenderOptions::default().max_depth)]
    depth: u32,

    /// Threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    #[command(flatten)]
    build: BuildArgs,

    #[command(flatten)]
    simd: SimdArgs,

    #[command(flatten)]
    view: ViewArgs,

    /// Panorama around the scene (.hdr), or none
    ///
    /// A Radiance picture of the surroundings, by longitude and latitude, in place of the scene's background; `none` leaves black. Integrator `path` lights the scene by it.
    #[arg(long, value_name = "FILE.hdr|none", hide_short_help = true)]
    environment: Option<PathBuf>,

    /// How bright, in stops; each doubles the light
    ///
    /// Else 0, but for integrator `path`, where the picture is darkened until nine tenths of it are not too bright.
    #[arg(long, value_name = "STOPS", value_parser = exposure, allow_hyphen_values = true, hide_short_help = true)]
    exposure: Option<f32>,

    /// Transparent things cast black shadows
    ///
    /// Otherwise light passes straight through them to what lies behind, weakened and coloured by what they absorb.
    #[arg(long, hide_short_help = true)]
    opaque_shadows: bool,

    /// Acceleration structure to trace with
    ///
    /// The picture is the same with each but for last digits, which show in single pixels; times and memory differ. A wrong name is answered with those that exist.
    #[arg(long, value_name = "NAME", value_parser = structure_kind)]
    structure: Option<StructureKind>,

    /// Show the structure's work for each pixel
    ///
    /// Instead of the scene: `nodes` (nodes or cells entered), `boxes` (box tests), `primitives` (primitive tests) or `tests` (both), the mean over the pixel's rays from the eye. A strip with a legend is added below the picture.
    #[arg(long, value_name = "QUANTITY", value_parser = heat_quantity)]
    heatmap: Option<HeatQuantity>,

    /// Where the scale of the heat map ends
    ///
    /// To compare several maps. Else it ends where 99.5% of the pixels lie below, rounded up; the legend then has `>=` before its last number if some lie above.
    #[arg(long, value_name = "N", value_parser = above_zero, requires = "heatmap", hide_short_help = true)]
    heatmap_max: Option<f32>,

    /// Draw the structure's boxes of a level
    ///
    /// The root's level is 0; `raywood info --json` lists the levels. Drawn are the boxes or cells of the level and the leaves above it, over the picture or the heat map, but no leaves without primitives. Lines behind surfaces are fainter.
    #[arg(long, value_name = "LEVEL", hide_short_help = true)]
    show_bounds: Option<usize>,

    /// Refuse what is otherwise mended
    ///
    /// Such as vertices that are not a number, which are otherwise dropped with the triangles that use them.
    #[arg(long, hide_short_help = true)]
    strict: bool,

    /// Print the statistics as JSON
    #[arg(long)]
    json: bool,
}

/// All integrators, a line each.
fn integrators_help() -> String {
    let line = |integrator: &Integrator| format!("  {:<10} {}", integrator.name, integrator.help);
    let lines: Vec<_> = INTEGRATORS.iter().map(line).collect();
    format!("How light is followed, or what is shown instead\n\n{}", lines.join("\n"))
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    args.simd.activate()?;
    let options = RenderOptions {
        width: args.size.width,
        height: args.size.height,
        samples: args.samples,
        max_depth: args.depth,
        opaque_shadows: args.opaque_shadows,
        integrator: args.integrator,
        ..RenderOptions::default()
    };
    options.validate().map_err(Failure::bad_input)?;
    let output = output_file(args)?;
    let environment = args.environment.as_deref().map(environment).transpose()?;

    let pool = thread_pool(args.threads.map(usize::from))?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let other_structure = args.structure.is_some_and(|kind| kind != StructureKind::default());
    let loaded = match args {
        _ if other_structure => loaded.without_instances("another structure")?,
        Args { heatmap: Some(_), .. } => loaded.without_instances("a heat map")?,
        Args { show_bounds: Some(_), .. } => loaded.without_instances("a picture of bounds")?,
        _ => loaded,
    };
    let Loaded { mut scene, tree, time: load } = loaded;
    args.view.orient(&mut scene);
    let kind = args.structure.unwrap_or_default();
    let started = Instant::now();
    let mut prepared = args.build.prepare(&scene, tree.as_ref(), kind, &pool)?;
    prepared.set_environment(environment);
    let build = started.elapsed();

    let started = Instant::now();
    let aspect = args.size.width as f32 / args.size.height as f32;
    let choose = || args.view.view(&prepared, aspect);
    let view = &during_step("choosing a view", || pool.install(choose))?;
    let chosen = started.elapsed();
    let request = Request {
        prepared: &prepared,
        view,
        options: &options,
        heatmap: args.heatmap,
        heatmap_max: args.heatmap_max,
        show_bounds: args.show_bounds,
        exposure: args.exposure,
    };
    let drawn = picture::draw(&request, &pool)?;

    let started = Instant::now();
    output.write(|writer| drawn.write(writer))?;
    let write = started.elapsed();

    let structure = prepared.stats();
    let report = Report {
        args,
        scene: &scene,
        kind,
        is_saved: args.build.wanted(tree.as_ref(), kind).is_some(),
        structure,
        load,
        build,
        view: chosen,
        render: drawn.render,
        heat: drawn.heat,
        bounds: drawn.bounds,
        exposure: drawn.exposure,
        write,
    };
    if args.json { print::json(&report.as_json()) } else { print::result(&report.as_text()) }
}

/// The panorama of a file, or a black one.
fn environment(path: &Path) -> Result<Environment, Failure> {
    match path.to_str() {
        Some("none") => Ok(Environment::black()),
        _ => load_environment(path).map_err(Failure::bad_input),
    }
}

/// The picture's file, known to be writable.
fn output_file(args: &Args) -> Result<OutputFile, Failure> {
    let path = &args.output;
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        let message =
            format!("{}: pictures are written as PNG: the name must end in .png", path.display());
        return Err(Failure::BadInput(message));
    }
    OutputFile::new(path)
}
