//! `raywood render`: a scene in, a picture out.

mod image_args;
mod lens_args;
mod report;
mod sampling_args;

use std::time::Instant;

use raywood::StructureKind;
use raywood_render::{Ended, HeatQuantity, INTEGRATORS, Integrator, RenderOptions};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::failure::Failure;
use crate::parse::{Size, above_zero, heat_quantity, integrator, structure_kind};
use crate::picture::{self, Request};
use crate::print;
use crate::progress_bar::during_step;
use crate::scene_source::{self, Loaded};
use crate::simd_args::SimdArgs;
use crate::surroundings::Surroundings;
use crate::view_args::ViewArgs;
use image_args::{ImageArgs, ImageFile, Made};
use lens_args::LensArgs;
use report::Report;
use sampling_args::SamplingArgs;

/// Render a model file or a built-in scene to a picture.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:whitted
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, a scene file (TOML) that puts several together, or a scene saved by `raywood build`; `raywood scenes` lists the built-in scenes.
    #[arg(default_value = "builtin:hall", hide_default_value = true)]
    scene: String,

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

    /// Most reflections and refractions
    ///
    /// How often light may be mirrored or refracted on its way to the eye.
    #[arg(long, value_name = "N", default_value_t = RenderOptions::default().max_depth, hide_short_help = true)]
    depth: u32,

    /// Threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Transparent things cast black shadows
    ///
    /// Otherwise light passes straight through them to what lies behind, weakened and coloured by what they absorb.
    #[arg(long, hide_short_help = true)]
    opaque_shadows: bool,

    /// Refuse what is otherwise mended
    ///
    /// Such as vertices that are not a number, which are otherwise dropped with the triangles that use them.
    #[arg(long, hide_short_help = true)]
    strict: bool,

    /// Print the statistics as JSON
    #[arg(long, hide_short_help = true)]
    json: bool,

    #[command(flatten)]
    image: ImageArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    #[command(flatten)]
    view: ViewArgs,

    /// Panorama around the scene (.hdr or .exr), a sky, or none
    ///
    /// A Radiance or OpenEXR picture of the surroundings, by longitude and latitude, in place of the scene's background; `none` leaves black. Integrator `path` lights the scene by it. `sky` is a clear sky by formula, whose sun takes the place of
    /// the scene's lights: `sky:elevation=35,azimuth=130,turbidity=2.2`, degrees above the horizon and clockwise from the default view's direction, and how hazy the air is, from 1 to 10.
    #[arg(
        help_heading = "View and light",
        long,
        value_name = "FILE|sky|none",
        hide_short_help = true
    )]
    environment: Option<Surroundings>,

    #[command(flatten)]
    lens: LensArgs,

    /// Acceleration structure to trace with
    ///
    /// The picture is the same with each but for last digits, which show in single pixels; times and memory differ. A wrong name is answered with those that exist.
    #[arg(help_heading = "Acceleration structure", long, value_name = "NAME", value_parser = structure_kind)]
    structure: Option<StructureKind>,

    #[command(flatten)]
    build: BuildArgs,

    #[command(flatten)]
    simd: SimdArgs,

    /// Show the structure's work for each pixel
    ///
    /// Instead of the scene: `nodes` (nodes or cells entered), `boxes` (box tests), `primitives` (primitive tests) or `tests` (both), the mean over the pixel's rays from the eye. A strip with a legend is added below the picture.
    #[arg(help_heading = "Acceleration structure", long, value_name = "QUANTITY", value_parser = heat_quantity)]
    heatmap: Option<HeatQuantity>,

    /// Where the scale of the heat map ends
    ///
    /// To compare several maps. Else it ends where 99.5% of the pixels lie below, rounded up; the legend then has `>=` before its last number if some lie above.
    #[arg(help_heading = "Acceleration structure", long, value_name = "N", value_parser = above_zero, requires = "heatmap", hide_short_help = true)]
    heatmap_max: Option<f32>,

    /// Draw the structure's boxes of a level
    ///
    /// The root's level is 0; `raywood info --json` lists the levels. Drawn are the boxes or cells of the level and the leaves above it, over the picture or the heat map, but no leaves without primitives. Lines behind surfaces are fainter.
    #[arg(
        help_heading = "Acceleration structure",
        long,
        value_name = "LEVEL",
        hide_short_help = true
    )]
    show_bounds: Option<usize>,
}

/// So many samples, in two passes, tell how noisy a picture is.
const LEAST_TO_DENOISE: u32 = 8;

/// All integrators, a line each.
fn integrators_help() -> String {
    let line = |integrator: &Integrator| format!("  {:<10} {}", integrator.name, integrator.help);
    let lines: Vec<_> = INTEGRATORS.iter().map(line).collect();
    format!("How light is followed, or what is shown instead\n\n{}", lines.join("\n"))
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    args.simd.activate()?;
    let mut options = RenderOptions {
        width: args.size.width,
        height: args.size.height,
        max_depth: args.depth,
        opaque_shadows: args.opaque_shadows,
        integrator: args.integrator,
        ..RenderOptions::default()
    };
    args.sampling.apply(&mut options);
    options.validate().map_err(Failure::bad_input)?;
    let is_drawn = args.heatmap.is_some() || args.show_bounds.is_some();
    let ImageFile { file, format, options: mut write_options } = args.image.file(is_drawn)?;
    if args.image.denoise {
        let is_in_passes = args.integrator.name == "path"
            || (args.sampling.goal().is_open() && args.integrator.shows_light);
        if !is_in_passes || is_drawn || options.samples < LEAST_TO_DENOISE {
            return Err(Failure::BadInput(format!(
                "--denoise: expected integrator path, or light with --noise or --time, {LEAST_TO_DENOISE} samples per pixel or more, and no drawing"
            )));
        }
    }

    let pool = thread_pool(args.threads.map(usize::from))?;
    let surroundings = args.environment.as_ref();
    let environment = pool.install(|| surroundings.map(Surroundings::panorama).transpose())?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let left_out = options.integrator.left_out(&loaded.scene);
    if !left_out.is_empty() {
        let (name, left_out) = (options.integrator.name, left_out.join(" and "));
        print::warning(format_args!(
            "integrator `{name}` leaves out {left_out}, which `--integrator path` shows"
        ));
    }
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
    let sky_lights = surroundings
        .zip(environment.as_ref())
        .and_then(|(all, panorama)| all.lights(panorama, prepared.axes()));
    prepared.set_environment(environment);
    let build = started.elapsed();

    let started = Instant::now();
    let aspect = args.size.width as f32 / args.size.height as f32;
    let choose = || args.view.view(&prepared, aspect, sky_lights);
    let view = &during_step("choosing a view", || pool.install(choose))?;
    let chosen = started.elapsed();
    options.lens = args.lens.lens(&prepared, &view.camera, args.size)?;
    options.validate().map_err(Failure::bad_input)?;
    let request = Request {
        prepared: &prepared,
        view,
        options: &options,
        heatmap: args.heatmap,
        heatmap_max: args.heatmap_max,
        show_bounds: args.show_bounds,
        exposure: args.image.exposure,
        tone_map: args.image.tone_map(),
        keeps_light: format.holds_light,
        goal: args.sampling.goal(),
        aovs: args.image.aovs(),
        denoise: args.image.denoise,
    };
    let drawn = picture::draw(&request, &pool)?;

    let started = Instant::now();
    let samples = drawn.samples(options.samples);
    let is_shown = !format.holds_light && !is_drawn && options.integrator.shows_light;
    write_options.metadata = args.image.metadata(&Made {
        options: &options,
        samples: &samples,
        is_denoised: drawn.passes.as_ref().is_some_and(|passes| passes.is_denoised),
        exposure: is_shown.then_some(drawn.exposure),
        seconds: drawn.render.elapsed.as_secs_f64(),
        threads: drawn.render.threads,
    });
    file.write_with(|writer| {
        drawn.write(format, &write_options, writer).map_err(|error| file.cannot_write(&error))
    })?;
    let write = started.elapsed();
    let is_cut_short = drawn.passes.as_ref().is_some_and(|passes| passes.ended == Ended::Cancelled);

    let structure = prepared.stats();
    let report = Report {
        args,
        options: &options,
        samples: &samples,
        passes: drawn.passes,
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
    if args.json { print::json(&report.as_json()) } else { print::result(&report.as_text()) }?;
    if is_cut_short {
        return Err(Failure::Interrupted(format!(
            "after {samples} of {} samples per pixel; {} is what there was",
            options.samples,
            args.image.output.display()
        )));
    }
    Ok(())
}
