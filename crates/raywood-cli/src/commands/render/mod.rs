//! `raywood render`: a scene in, a picture out.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use raywood::{StructureKind, StructureStats};
use raywood_render::{HeatQuantity, RenderOptions, RenderStats};
use raywood_scene::Scene;
use serde_json::{Value, json};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::exporters;
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::parse::{Size, above_zero, heat_quantity, structure_kind};
use crate::picture::{self, Bounds, Heat, Request};
use crate::print::{self, thousands};
use crate::progress_bar::during_step;
use crate::scene_source::{self, Loaded};
use crate::simd_args::SimdArgs;
use crate::view_args::ViewArgs;

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

    /// Transparent things cast black shadows
    ///
    /// Otherwise light passes straight through them to what lies behind, weakened and coloured by what they absorb.
    #[arg(long, hide_short_help = true)]
    opaque_shadows: bool,

    /// Acceleration structure to trace with
    ///
    /// The picture is the same with each; times and memory differ. A wrong name is answered with those that exist.
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
    #[arg(long, value_name = "LEVEL")]
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

/// What was done and how long it took.
struct Report<'a> {
    args: &'a Args,
    scene: &'a Scene,
    kind: StructureKind,
    /// Whether the structure was saved with the scene.
    is_saved: bool,
    structure: StructureStats,
    load: Duration,
    build: Duration,
    view: Duration,
    render: RenderStats,
    heat: Option<Heat>,
    bounds: Option<Bounds>,
    write: Duration,
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
        ..RenderOptions::default()
    };
    options.validate().map_err(Failure::bad_input)?;
    let output = output_file(args)?;

    let pool = thread_pool(args.threads.map(usize::from))?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let Loaded { mut scene, tree, time: load } = loaded;
    args.view.orient(&mut scene);
    let kind = args.structure.unwrap_or_default();
    let started = Instant::now();
    let prepared = args.build.prepare(&scene, tree.as_ref(), kind, &pool)?;
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
    };
    let drawn = picture::draw(&request, &pool)?;

    let started = Instant::now();
    output.write(|writer| drawn.write(writer))?;
    let write = started.elapsed();

    let structure = prepared.structure().stats();
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
        write,
    };
    if args.json { print::json(&report.as_json()) } else { print::result(&report.as_text()) }
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

impl Report<'_> {
    fn as_text(&self) -> String {
        let Self { args, scene, kind, is_saved, structure, .. } = self;
        let Self { load, build, view, render, heat, bounds, write, .. } = self;
        let rays = render.rays;
        let seconds = |d: &Duration| format!("{:8.3} s", d.as_secs_f64());
        let mut text = format!("wrote {}: {}\n", args.output.display(), self.what());
        let mut line = |name: &str, value: String| text += &format!("  {name:<8}{value}\n");

        let spheres = match scene.spheres.as_slice().len() {
            0 => String::new(),
            n => format!(", {} spheres", thousands(n as u64)),
        };
        let triangles = thousands(scene.mesh.triangles.triangles().len() as u64);
        line("load", format!("{}   {triangles} triangles{spheres}", seconds(load)));
        let megabytes = structure.bytes as f64 / 1e6;
        let (nodes, depth) = (thousands(structure.nodes as u64), structure.depth);
        let size = format!("{nodes} nodes, depth {depth}, {megabytes:.1} MB");
        let saved = if *is_saved { " as saved" } else { "" };
        line("build", format!("{}   {}{saved}, {size}", seconds(build), kind.name()));
        line("view", seconds(view));
        let [primary, shadow, reflection, refraction] =
            [rays.primary, rays.shadow, rays.reflection, rays.refraction].map(thousands);
        line(
            "render",
            format!(
                "{}   {:.1} million rays/s on {} threads",
                seconds(&render.elapsed),
                render.million_rays_per_second(),
                render.threads
            ),
        );
        if let Some(Bounds { level, boxes, time }) = bounds {
            let boxes = thousands(*boxes as u64);
            line("bounds", format!("{}   {boxes} boxes of level {level}", seconds(time)));
        }
        line("write", seconds(write));
        line(
            "rays",
            format!(
                "{primary} primary, {shadow} shadow, {reflection} reflection, {refraction} refraction"
            ),
        );
        if let Some(Heat { quantity, mean, max, scale, pixels_above }) = heat {
            let above = match pixels_above {
                0 => String::new(),
                above => format!(", {} pixels above", thousands(*above as u64)),
            };
            let label = quantity.label();
            let values = format!("mean {mean:.1}, maximum {max}, scale 0 to {scale}{above}");
            line("heat", format!("{label}: {values}"));
        }
        text
    }

    /// The picture in a few words.
    fn what(&self) -> String {
        let Args { scene, size: Size { width, height }, samples, .. } = self.args;
        format!("{scene} at {width}x{height}, {samples} samples per pixel")
    }

    fn as_json(&self) -> Value {
        let Self { args, scene, kind, is_saved, structure, .. } = self;
        let Self { load, build, view, render, heat, bounds, write, .. } = self;
        let rays = render.rays;
        json!({
            "scene": args.scene,
            "output": args.output.display().to_string(),
            "width": args.size.width,
            "height": args.size.height,
            "samples": args.samples,
            "depth": args.depth,
            "threads": render.threads,
            "triangles": scene.mesh.triangles.triangles().len(),
            "spheres": scene.spheres.as_slice().len(),
            "warnings": scene.warnings,
            "saved_tree": is_saved,
            "seconds": {
                "load": load.as_secs_f64(),
                "build": build.as_secs_f64(),
                "view": view.as_secs_f64(),
                "render": render.elapsed.as_secs_f64(),
                "write": write.as_secs_f64(),
            },
            "rays": {
                "primary": rays.primary,
                "shadow": rays.shadow,
                "reflection": rays.reflection,
                "refraction": rays.refraction,
                "total": rays.total(),
            },
            "million_rays_per_second": render.million_rays_per_second(),
            "heatmap": heat.as_ref().map(|heat| json!({
                "quantity": heat.quantity.name(),
                "mean": heat.mean,
                "max": heat.max,
                "scale": heat.scale,
                "pixels_above_scale": heat.pixels_above,
            })),
            "bounds": bounds.as_ref().map(|bounds| json!({
                "level": bounds.level, "boxes": bounds.boxes, "seconds": bounds.time.as_secs_f64(),
            })),
            "structure": exporters::structure(*kind, structure),
        })
    }
}
