//! `raywood render`: a scene in, a picture out.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use raywood::{StructureKind, StructureStats, Vec3};
use raywood_render::{
    PreparedScene, Progress, RenderError, RenderOptions, RenderStats, View, choose_camera,
    choose_lights, render, write_png,
};
use raywood_scene::{Camera, Light, LightKind, Rgb, Scene, ambient};
use serde_json::{Value, json};

use super::{info, thread_pool};
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::parse::{Point, PointLight, Size, field_of_view, structure_kind};
use crate::print::{self, thousands};
use crate::progress_bar::{during_rendering, during_step};
use crate::scene_source::{self, Loaded};

/// Render a model file or a built-in scene to a PNG picture.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:whitted
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL; `raywood scenes` lists the built-in scenes.
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

    /// Where the eye is
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Option<Point>,

    /// The point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    target: Option<Point>,

    /// The direction that is up
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    up: Option<Point>,

    /// Field of view from bottom to top
    #[arg(long, value_name = "DEGREES", value_parser = field_of_view)]
    fov: Option<f32>,

    /// The scene's camera to use
    ///
    /// By its number, from 1, or its name; `raywood info` lists them. Else it is the first.
    #[arg(long, value_name = "N|NAME")]
    camera: Option<String>,

    /// Point light; may be repeated
    ///
    /// Takes the place of the scene's lights, with a little ambient light. The strength S is relative: 1, the default, fully lights a surface as far away as the middle of the picture.
    #[arg(long, value_name = "X,Y,Z[,S]", allow_hyphen_values = true)]
    light: Vec<PointLight>,

    /// Transparent things cast black shadows
    ///
    /// Otherwise light passes straight through them to what lies behind, weakened and coloured by what they absorb.
    #[arg(long)]
    opaque_shadows: bool,

    /// Acceleration structure to trace with
    ///
    /// The picture is the same with each; times and memory differ. A wrong name is answered with those that exist.
    #[arg(long, value_name = "NAME", value_parser = structure_kind)]
    structure: Option<StructureKind>,

    /// Refuse what is otherwise mended
    ///
    /// Such as vertices that are not a number, which are otherwise dropped with the triangles that use them.
    #[arg(long)]
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
    structure: StructureStats,
    load: Duration,
    build: Duration,
    view: Duration,
    render: RenderStats,
    write: Duration,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
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
    let Loaded { mut scene, time: load } = loaded;
    scene.up = args.up.map(|point| point.0).or(scene.up);
    let kind = args.structure.unwrap_or_default();
    let started = Instant::now();
    let prepare = || PreparedScene::with_structure(&scene, kind);
    let prepared = during_step("building the structure", || pool.install(prepare))
        .map_err(Failure::bad_input)?;
    let build = started.elapsed();

    let started = Instant::now();
    let choose = || view(args, &scene, &prepared);
    let View { camera, lights } = during_step("choosing a view", || pool.install(choose))?;
    let chosen = started.elapsed();
    let progress = Progress::new();
    let (image, stats) = during_rendering(&progress, || {
        pool.install(|| render(&prepared, &camera, &lights, &options, &progress))
    })
    .map_err(|error| match error {
        RenderError::OutOfMemory { .. } => Failure::while_running(error),
        error => Failure::bad_input(error),
    })?;

    let started = Instant::now();
    output.write(|writer| write_png(&image, writer))?;
    let write = started.elapsed();

    let structure = prepared.structure().stats();
    let report = Report {
        args,
        scene: &scene,
        kind,
        structure,
        load,
        build,
        view: chosen,
        render: stats,
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

/// The camera and lights: those that the command line gives, else the scene's, else chosen ones; lights for the camera that is used.
fn view(args: &Args, scene: &Scene, prepared: &PreparedScene<'_>) -> Result<View, Failure> {
    let mut camera = match (&args.camera, scene.cameras.first()) {
        (Some(wanted), _) => camera_called(wanted, scene)?,
        (None, Some(first)) => first.clone(),
        (None, None) => {
            let aspect = args.size.width as f32 / args.size.height as f32;
            choose_camera(prepared, aspect)
        }
    };
    let or_given = |value: Vec3, given: Option<Point>| given.map_or(value, |point| point.0);
    camera.eye = or_given(camera.eye, args.eye);
    camera.target = or_given(camera.target, args.target);
    camera.up = or_given(camera.up, args.up);
    camera.fov_y = args.fov.unwrap_or(camera.fov_y);

    let point_light = |light: &PointLight| {
        let to_target = camera.target - light.position;
        Light {
            name: String::new(),
            kind: LightKind::Point { position: light.position },
            intensity: Rgb::splat(light.strength * to_target.dot(to_target)),
        }
    };
    let lights = if !args.light.is_empty() {
        args.light.iter().map(point_light).chain([ambient(0.15)]).collect()
    } else if !scene.lights.is_empty() {
        scene.lights.clone()
    } else {
        choose_lights(prepared, &camera)
    };
    Ok(View { camera, lights })
}

/// The scene's camera of a number, from 1, or a name.
fn camera_called(wanted: &str, scene: &Scene) -> Result<Camera, Failure> {
    let number = wanted.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let by_number = number.and_then(|index| scene.cameras.get(index));
    let camera = by_number.or_else(|| scene.cameras.iter().find(|camera| camera.name == wanted));
    camera.cloned().ok_or_else(|| no_such_camera(wanted, scene))
}

fn no_such_camera(wanted: &str, scene: &Scene) -> Failure {
    let known: Vec<_> = (1..)
        .zip(&scene.cameras)
        .map(|(number, camera)| format!("{number} {}", camera.name))
        .collect();
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    Failure::BadInput(format!("{}: has no camera `{wanted}`; its cameras: {known}", scene.name))
}

impl Report<'_> {
    fn as_text(&self) -> String {
        let Self { args, scene, kind, structure, load, build, view, render, write } = self;
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
        line("build", format!("{}   {}, {size}", seconds(build), kind.name()));
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
        line("write", seconds(write));
        line(
            "rays",
            format!(
                "{primary} primary, {shadow} shadow, {reflection} reflection, {refraction} refraction"
            ),
        );
        text
    }

    /// The picture in a few words.
    fn what(&self) -> String {
        let Args { scene, size: Size { width, height }, samples, .. } = self.args;
        format!("{scene} at {width}x{height}, {samples} samples per pixel")
    }

    fn as_json(&self) -> Value {
        let Self { args, scene, kind, structure, load, build, view, render, write } = self;
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
            "structure": info::structure(*kind, structure),
        })
    }
}
