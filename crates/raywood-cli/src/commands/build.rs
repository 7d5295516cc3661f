//! `raywood build`: a scene in, the scene with the tree over it out, for other commands to start from.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use raywood::{AccelerationStructure, StructureKind, StructureStats};
use raywood_scene::{Scene, save_scene};
use serde_json::{Value, json};

use super::thread_pool;
use crate::build_args::BuildArgs;
use crate::exporters;
use crate::failure::Failure;
use crate::output_file::OutputFile;
use crate::print::{self, thousands};
use crate::progress_bar::during_step;
use crate::scene_source::{self, Loaded};

/// Build the tree of a scene and save both for later.
///
/// Every command that takes a model file takes the saved scene too, and does not build its tree again. The file is mapped into memory, so nobody should write into it while it is in use; replacing it does no harm.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Model file, or built-in scene such as builtin:whitted
    ///
    /// Files may be OBJ, glTF, GLB, PLY or STL, a scene file (TOML) that puts several together, or a scene saved before; `raywood scenes` lists the built-in scenes.
    scene: String,

    /// The saved scene
    #[arg(short, long, value_name = "FILE.rwood")]
    output: PathBuf,

    /// Threads to use, else all cores
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    #[command(flatten)]
    build: BuildArgs,

    /// Refuse what is otherwise mended
    ///
    /// Such as vertices that are not a number, which are otherwise dropped with the triangles that use them.
    #[arg(long, hide_short_help = true)]
    strict: bool,

    /// Print the statistics as JSON
    #[arg(long)]
    json: bool,
}

/// What was done and how long it took, in seconds.
struct Report<'a> {
    args: &'a Args,
    scene: &'a Scene,
    structure: StructureStats,
    bytes: u64,
    load: f64,
    build: f64,
    write: f64,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    // Say what is wrong with the request before any work is done for it.
    let output = output_file(&args.output)?;
    let pool = thread_pool(args.threads.map(usize::from))?;
    let loaded =
        during_step("loading", || pool.install(|| scene_source::load(&args.scene, args.strict)))?;
    loaded.print_warnings();
    let loaded = loaded.standing_still("a saved scene")?.without_instances("a saved scene")?;
    let Loaded { scene, tree: saved, time: load } = loaded;
    let started = Instant::now();
    let tree = args.build.tree(&scene, saved.as_ref(), &pool)?;
    let build = started.elapsed().as_secs_f64();

    let started = Instant::now();
    during_step("writing", || {
        pool.install(|| output.write(|writer| save_scene(&scene, &tree, writer)))
    })?;
    let write = started.elapsed().as_secs_f64();

    let bytes = fs::metadata(&args.output).map_or(0, |metadata| metadata.len());
    let (structure, load) = (tree.tree().stats(), load.as_secs_f64());
    let report = Report { args, scene: &scene, structure, bytes, load, build, write };
    if args.json { print::json(&report.as_json()) } else { print::result(&report.as_text()) }
}

/// The place of the saved scene, known to be writable.
fn output_file(path: &Path) -> Result<OutputFile, Failure> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("rwood")) {
        let name = path.display();
        let message = format!("{name}: the name of a saved scene must end in .rwood");
        return Err(Failure::BadInput(message));
    }
    OutputFile::new(path)
}

impl Report<'_> {
    fn as_text(&self) -> String {
        let Self { args, scene, structure, bytes, load, build, write } = self;
        let megabytes = |bytes: f64| format!("{:.1} MB", bytes / 1e6);
        let mut text = format!("wrote {}: {}\n", args.output.display(), args.scene);
        let mut line = |name: &str, seconds: &f64, what: String| {
            text += &format!("  {name:<8}{seconds:8.3} s   {what}\n");
        };
        let spheres = match scene.spheres.as_slice().len() {
            0 => String::new(),
            n => format!(", {} spheres", thousands(n as u64)),
        };
        let triangles = thousands(scene.mesh.triangles.triangles().len() as u64);
        line("load", load, format!("{triangles} triangles{spheres}"));
        let (nodes, depth) = (thousands(structure.nodes as u64), structure.depth);
        let size = megabytes(structure.bytes as f64);
        line("build", build, format!("{nodes} nodes, depth {depth}, {size}"));
        line("write", write, megabytes(*bytes as f64));
        text
    }

    fn as_json(&self) -> Value {
        let Self { args, scene, structure, bytes, load, build, write } = self;
        json!({
            "scene": args.scene,
            "output": args.output.display().to_string(),
            "bytes": bytes,
            "triangles": scene.mesh.triangles.triangles().len(),
            "spheres": scene.spheres.as_slice().len(),
            "warnings": scene.warnings,
            "seconds": { "load": load, "build": build, "write": write },
            "structure": exporters::structure(StructureKind::BvhWide, structure),
        })
    }
}
