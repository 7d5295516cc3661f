//! `raywood render`: a scene in, a picture out.

mod animation_args;
mod layer_args;
mod lens_args;
mod report;
mod sampling_args;
mod work_args;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use raywood::StructureKind;
use raywood_render::{
    Ended, HeatQuantity, INTEGRATORS, Integrator, Part, PreparedScene, RenderOptions, View,
};
use raywood_scene::{Camera, FileStamp, files_read};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::checkpoint::Begun;
use crate::failure::Failure;
use crate::image_args::{ImageArgs, ImageFile, Made};
use crate::parse::{Exposure, Size, above_zero, heat_quantity, integrator, structure_kind};
use crate::picture::{self, Request};
use crate::print;
use crate::progress_bar::during_step;
use crate::scene_source::{self, BUILTIN_PREFIX, Loaded};
use crate::settings::Settings;
use crate::simd_args::SimdArgs;
use crate::surroundings::Surroundings;
use crate::view_args::ViewArgs;
use crate::watch::wait_for_change;
use animation_args::{AnimationArgs, frame_path};
use layer_args::LayerArgs;
use lens_args::LensArgs;
use report::Report;
use sampling_args::SamplingArgs;
use work_args::WorkArgs;

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

    /// Print the statistics as JSON, an object for each picture
    #[arg(long, hide_short_help = true)]
    json: bool,

    #[command(flatten)]
    image: ImageArgs,

    #[command(flatten)]
    layers: LayerArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    #[command(flatten)]
    work: WorkArgs,

    /// Render again whenever the scene's files change
    ///
    /// The scene file or model, and all files that it names, be they there or not. What is wrong with them is said, and watching goes on. What changes while a picture is rendered is seen when that is done. Ctrl-C ends it.
    #[arg(
        help_heading = "Long work",
        long,
        conflicts_with_all = ["checkpoint", "frames"],
        hide_short_help = true
    )]
    watch: bool,

    #[command(flatten)]
    animation: AnimationArgs,

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
    args.simd.activate()?;
    let pool = thread_pool(args.threads.map(usize::from))?;
    if args.watch { watch(args, &pool) } else { render(args, &pool) }
}

/// Renders again and again, whenever a file of the scene changes.
fn watch(args: &Args, pool: &ThreadPool) -> Result<(), Failure> {
    if args.scene.starts_with(BUILTIN_PREFIX) {
        return Err(Failure::BadInput(format!(
            "--watch: {} does not change, expected a file",
            args.scene
        )));
    }
    // What is wrong with the request will not get better.
    args.options()?;
    args.image_file()?;
    if !Path::new(&args.scene).exists() {
        return render(args, pool);
    }
    let mut files: Vec<(PathBuf, FileStamp)> = Vec::new();
    loop {
        let (result, mut read) = files_read(|| render(args, pool));
        read.push((args.scene.clone().into(), FileStamp::of(Path::new(&args.scene))));
        match result {
            Ok(()) => files.clear(),
            Err(failure @ Failure::Interrupted(_)) => return Err(failure),
            Err(failure) => print::failure(&failure),
        }
        // A scene that could not be loaded did not come to all of its files: those of before count, as they are now.
        for (path, _) in std::mem::take(&mut files) {
            let stamp = FileStamp::of(&path);
            read.push((path, stamp));
        }
        for (path, stamp) in read {
            if !files.iter().any(|(other, _)| *other == path) {
                files.push((path, stamp));
            }
        }
        let count = if files.len() == 1 { "file" } else { "files" };
        print::note(format_args!("watching {} {count}, Ctrl-C ends", files.len()));
        wait_for_change(&files);
    }
}

/// Loads the scene and renders all that is asked for.
fn render(args: &Args, pool: &ThreadPool) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    let options = args.options()?;
    let image = args.image_file()?;
    let begun = args.work.begin()?;

    let surroundings = args.environment.as_ref();
    let environment = pool.install(|| surroundings.map(Surroundings::panorama).transpose())?;
    let Loaded { mut scene, tree, time: load } = args.load(pool, &options)?;
    args.view.orient(&mut scene);
    let kind = args.structure.unwrap_or_default();
    let started = Instant::now();
    let mut prepared = args.build.prepare(&scene, tree.as_ref(), kind, pool)?;
    let sky_lights = surroundings
        .zip(environment.as_ref())
        .and_then(|(all, panorama)| all.lights(panorama, prepared.axes()));
    prepared.set_environment(environment);
    let build = started.elapsed();

    let started = Instant::now();
    let aspect = args.size.width as f32 / args.size.height as f32;
    let choose = || args.view.view(&prepared, aspect, args.animation.first_key(), sky_lights);
    let view = during_step("choosing a view", || pool.install(choose))?;
    let chosen = started.elapsed();

    let is_saved = args.build.wanted(tree.as_ref(), kind).is_some();
    let times = Times { load, build, view: chosen };
    let (prepared, options) = (&prepared, &options);
    let mut stage = Stage { args, options, prepared, kind, is_saved, times, pool, exposure: None };
    let up = prepared.axes().up;
    match args.animation.cameras(&scene, &view.camera, up)? {
        None => stage.shoot(&view, begun, image),
        Some(cameras) => {
            if args.image.exposure.is_none() {
                let exposure = picture::find_exposure(prepared, &view, options, pool)?;
                stage.exposure = Some(Exposure::Factor(exposure));
            }
            stage.shoot_frames(cameras, &view)
        }
    }
}

impl Args {
    /// How the picture is rendered, as far as that is known before the scene is.
    ///
    /// # Errors
    ///
    /// Options that make no sense, or not together.
    fn options(&self) -> Result<RenderOptions, Failure> {
        let Size { width, height } = self.size;
        let mut options = RenderOptions {
            width,
            height,
            max_depth: self.depth,
            opaque_shadows: self.opaque_shadows,
            integrator: self.integrator,
            ..RenderOptions::default()
        };
        self.sampling.apply(&mut options);
        options.validate().map_err(Failure::bad_input)?;
        let part = self.work.part();
        part.validate(width, height).map_err(Failure::bad_input)?;
        if self.is_drawn() && (part != Part::Whole || self.work.checkpoint.is_some()) {
            return Err(Failure::BadInput(
                "--checkpoint, --region and --tile: heat maps and bounds are drawn at once, expected neither --heatmap nor --show-bounds".to_owned(),
            ));
        }
        if self.animation.frames.is_some() && self.image.exposure == Some(Exposure::Auto) {
            return Err(Failure::BadInput(
                "--exposure auto would flicker from frame to frame: expected stops with --frames"
                    .to_owned(),
            ));
        }
        if self.layers.denoise {
            if part != Part::Whole {
                return Err(Failure::BadInput(
                    "--denoise: needs the whole picture: expected neither --region nor --tile. Of shares, merge the films first, then --checkpoint MERGED.film --resume --denoise".to_owned(),
                ));
            }
            let is_in_passes = self.integrator.name == "path"
                || (self.sampling.goal().is_open() && self.integrator.shows_light);
            if !is_in_passes || self.is_drawn() || options.samples < LEAST_TO_DENOISE {
                return Err(Failure::BadInput(format!(
                    "--denoise: expected integrator path, or light with --noise or --time, {LEAST_TO_DENOISE} samples per pixel or more, and no drawing"
                )));
            }
        }
        Ok(options)
    }

    /// Whether the picture is drawn, not light.
    fn is_drawn(&self) -> bool {
        self.heatmap.is_some() || self.show_bounds.is_some()
    }

    /// The picture's file, if one is written: a share is not unless it is named.
    fn image_file(&self) -> Result<Option<ImageFile>, Failure> {
        if matches!(self.work.part(), Part::Share { .. }) && !self.image.is_named() {
            return match self.layers.aovs() {
                [] => Ok(None),
                _ => Err(Failure::BadInput(
                    "--aovs: of a share no picture is written, expected -o FILE.exr".to_owned(),
                )),
            };
        }
        let file = match self.animation.frames {
            // The first frame stands for all.
            Some(_) => self.image.file_at(&frame_path(self.image.path(), 1)?, self.is_drawn())?,
            None => self.image.file(self.is_drawn())?,
        };
        self.layers.check(&file)?;
        if self.work.checkpoint.as_deref() == Some(&file.path) {
            let name = file.path.display();
            return Err(Failure::BadInput(format!(
                "{name}: cannot be both picture and checkpoint"
            )));
        }
        Ok(Some(file))
    }

    /// The scene, with what is to be said about it said.
    fn load(&self, pool: &ThreadPool, options: &RenderOptions) -> Result<Loaded, Failure> {
        let load = || pool.install(|| scene_source::load(&self.scene, self.strict));
        let loaded = during_step("loading", load)?;
        loaded.print_warnings();
        let left_out = options.integrator.left_out(&loaded.scene);
        if !left_out.is_empty() {
            let (name, left_out) = (options.integrator.name, left_out.join(" and "));
            print::warning(format_args!(
                "integrator `{name}` leaves out {left_out}, which `--integrator path` shows"
            ));
        }
        let other_structure = self.structure.is_some_and(|kind| kind != StructureKind::default());
        match self {
            Self { heatmap: Some(_), .. } => loaded.without_instances("a heat map"),
            Self { show_bounds: Some(_), .. } => loaded.without_instances("a picture of bounds"),
            _ if other_structure => {
                let what = "another structure";
                loaded.standing_still(what)?.without_instances(what)
            }
            _ => Ok(loaded),
        }
    }
}

/// How long it took to get so far.
#[derive(Clone, Copy)]
struct Times {
    load: Duration,
    build: Duration,
    view: Duration,
}

/// Everything that pictures of a scene need.
struct Stage<'a> {
    args: &'a Args,
    options: &'a RenderOptions,
    prepared: &'a PreparedScene<'a>,
    kind: StructureKind,
    /// Whether the structure was saved with the scene.
    is_saved: bool,
    times: Times,
    pool: &'a ThreadPool,
    /// How much of the light is shown, if the options do not say but something else does.
    exposure: Option<Exposure>,
}

impl Stage<'_> {
    /// Renders pictures with these cameras and the lights of a view.
    fn shoot_frames(&self, cameras: Vec<Camera>, view: &View) -> Result<(), Failure> {
        let args = self.args;
        let count = cameras.len();
        let mut left_out = 0;
        for (number, camera) in (1..).zip(cameras) {
            let path = frame_path(args.image.path(), number)?;
            if args.animation.skip_existing && path.exists() {
                left_out += 1;
                continue;
            }
            let image = args.image.file_at(&path, args.is_drawn())?;
            let view = View { camera, lights: view.lights.clone() };
            self.shoot(&view, None, Some(image)).map_err(|failure| match failure {
                Failure::Interrupted(_) => Failure::Interrupted(format!(
                    "in frame {number} of {count}, which is not written; --skip-existing goes on with it"
                )),
                failure => failure,
            })?;
        }
        if left_out > 0 {
            print::note(format_args!("{left_out} of {count} frames were there already"));
        }
        Ok(())
    }

    /// Renders a picture, writes it and says so.
    fn shoot(
        &self,
        view: &View,
        begun: Option<Begun>,
        image: Option<ImageFile>,
    ) -> Result<(), Failure> {
        let &Self { args, prepared, pool, kind, .. } = self;
        let mut options = self.options.clone();
        options.lens = args.lens.lens(prepared, &view.camera, args.size)?;
        options.validate().map_err(Failure::bad_input)?;
        let (goal, aovs) = (args.sampling.goal(), args.layers.aovs());
        let in_passes = picture::is_in_passes(&options, &goal, aovs);
        let mut settings = Settings::of_picture(&options, &goal, in_passes);
        let checkpoint = match begun {
            None => None,
            Some(begun) => {
                let build = if self.is_saved { "saved" } else { args.build.preset().name() };
                settings.add_scene(prepared, view, kind, build);
                Some(begun.of_picture(settings.clone(), &options, args.work.every())?)
            }
        };
        let keeps_light = image.as_ref().is_some_and(|image| image.format.holds_light);
        let request = Request {
            prepared,
            view,
            options: &options,
            heatmap: args.heatmap,
            heatmap_max: args.heatmap_max,
            show_bounds: args.show_bounds,
            exposure: args.image.exposure.or(self.exposure),
            tone_map: args.image.tone_map(),
            keeps_light,
            goal,
            aovs,
            denoise: args.layers.denoise,
            part: args.work.part(),
            checkpoint: checkpoint.as_ref(),
        };
        let drawn = picture::draw(&request, pool)?;
        let passes = drawn.passes.as_ref();
        let is_cut_short = passes.is_some_and(|passes| passes.ended == Ended::Cancelled);
        if is_cut_short && args.animation.frames.is_some() {
            // Files of frames are whole, so that those that are there can be left out later.
            return Err(Failure::Interrupted(String::new()));
        }

        let started = Instant::now();
        let samples = drawn.samples(options.samples);
        let is_shown = !keeps_light && !args.is_drawn() && options.integrator.shows_light;
        let path = image.as_ref().map(|image| image.path.clone());
        if let Some(ImageFile { file, format, options: mut write_options, .. }) = image {
            write_options.metadata = args.image.metadata(&Made {
                settings: &settings,
                samples: &samples,
                is_denoised: passes.is_some_and(|passes| passes.is_denoised),
                exposure: is_shown.then_some(drawn.exposure),
                seconds: Some(drawn.render.elapsed.as_secs_f64()),
                threads: drawn.render.threads,
            });
            file.write_with(|writer| {
                let written = drawn.write(format, &write_options, writer);
                written.map_err(|error| file.cannot_write(&error))
            })?;
        }
        let write = started.elapsed();
        let report = Report {
            args,
            output: path.as_deref(),
            checkpoint: args.work.checkpoint.as_deref().filter(|_| drawn.kept.is_ok()),
            options: &options,
            samples: &samples,
            passes: drawn.passes,
            scene: prepared.scene(),
            kind,
            is_saved: self.is_saved,
            structure: prepared.stats(),
            times: self.times,
            render: drawn.render,
            heat: drawn.heat,
            bounds: drawn.bounds,
            exposure: drawn.exposure,
            write,
        };
        if args.json { print::json(&report.as_json()) } else { print::result(&report.as_text()) }?;
        drawn.kept?;
        if is_cut_short {
            let mut message = format!("after {samples} of {} samples per pixel", options.samples);
            if let Some(path) = path {
                message += &format!("; {} is what there was", path.display());
            }
            if let Some(checkpoint) = &args.work.checkpoint {
                message += &format!("; --resume goes on from {}", checkpoint.display());
            }
            return Err(Failure::Interrupted(message));
        }
        Ok(())
    }
}
