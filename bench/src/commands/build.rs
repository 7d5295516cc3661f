//! `raywood-bench build`: all ways to build trees over the same scenes.

use std::path::PathBuf;

use rayon::ThreadPool;
use serde_json::{Value, json};

use super::scene_args::{SceneArgs, few_scenes};
use super::{names, output, pools};
use crate::build::ratios::ratios;
use crate::build::report::{self, Place};
use crate::build::turns::{Questions, Row, take_turns};
use crate::embree::Library;
use crate::failure::Failure;
use crate::machine::{machine, now};
use crate::peers::builds::{BuildEntry, builds};
use crate::pixel_order::PictureSize;
use crate::ray_sets::{RaySet, SetKind, ray_sets};
use crate::reference::Reference;
use crate::scenes::BenchScene;

/// What every tree is asked where its rays are not timed.
const CHECKED_SETS: &[SetKind] = &[SetKind::Primary, SetKind::Diffuse];
const CHECKED_RAYS: u32 = 16_384;

/// Let all libraries build their trees in all ways, and compare times, memory, and what the trees are worth.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    scenes: SceneArgs,

    /// Which libraries, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::peer)]
    peers: Vec<&'static str>,

    /// Which presets, by the libraries' own names for them, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = preset)]
    presets: Vec<&'static str>,

    /// On how many threads, one number or several
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', default_value = "1")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,

    /// The shared library of Embree 4
    #[arg(long, value_name = "LIB")]
    embree: Option<PathBuf>,

    /// How Embree is configured beside its threads, as in isa=avx2
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    #[arg(requires = "embree")]
    embree_config: String,

    /// How often each builds, twice in a row; slow ones build less often
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=10_000))]
    rounds: u16,

    /// Also time the tracing of rays through each tree
    #[arg(long)]
    trace: bool,

    /// Which sets of rays to trace, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::set)]
    #[arg(requires = "trace")]
    sets: Vec<SetKind>,

    /// About how many rays of each kind to trace, at most 1024000
    #[arg(long, value_name = "N", default_value_t = 256_000, requires = "trace")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_024_000))]
    rays: u32,

    /// Also write everything to a file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let started = now();
    let pools = pools(&args.threads)?;
    let version = load_embree(args, 1)?.map(|library| library.version().to_owned());
    let chosen: Vec<_> = builds().filter(|entry| is_chosen(args, entry)).collect();
    if chosen.is_empty() {
        return Err(Failure::BadInput("no library has a preset of that name".to_owned()));
    }
    if let Some(file) = &args.json {
        output::try_to_write(file)?;
    }

    let (mut scenes, mut rows, mut compared) = (Vec::new(), Vec::new(), Vec::new());
    for load in args.scenes.loaders(&few_scenes()) {
        let Some(scene) = load()? else { continue };
        let triangles = scene.mesh.triangles().len();
        let questions = questions(args, &scene)?;
        scenes.push(described(&scene, &questions));
        for pool in &pools {
            let threads = pool.current_num_threads();
            let place = Place { scene: &scene.name, triangles, threads };
            let measured = run_scene(args, &chosen, &scene, &questions, pool)?;
            print!("{}", report::text(&place, &measured));
            rows.extend(measured.iter().map(|row| report::json(&place, row)));
            compared.extend(ratios(&measured).iter().map(|r| r.json(&scene.name, threads)));
        }
        // Written anew after each scene, so that a run that is stopped leaves what it has.
        if let Some(file) = &args.json {
            let everything = json!({
                "command": "build",
                "date": started,
                "machine": machine(),
                "raywood": env!("CARGO_PKG_VERSION"),
                "embree": version.as_ref().map(|version| json!({
                    "version": version, "config": args.embree_config,
                })),
                "settings": { "rounds": args.rounds, "rays": args.trace.then_some(args.rays) },
                "presets": chosen.iter().map(|entry| json!({
                    "peer": entry.peer, "preset": entry.preset, "settings": entry.settings,
                })).collect::<Vec<_>>(),
                "scenes": scenes,
                "builds": rows,
                "ratios": compared,
            });
            output::write(file, &everything)?;
        }
    }
    if scenes.is_empty() {
        return Err(Failure::BadInput("there is no scene to build trees over".to_owned()));
    }
    Ok(())
}

fn is_chosen(args: &Args, entry: &BuildEntry) -> bool {
    let named = |names: &[&str], name| names.is_empty() || names.contains(&name);
    named(&args.peers, entry.peer) && named(&args.presets, entry.preset)
}

/// Embree on so many threads, which it starts once for all its devices: there must be no other at the time.
fn load_embree(args: &Args, threads: usize) -> Result<Option<Library>, Failure> {
    let Some(path) = &args.embree else { return Ok(None) };
    let config = match &*args.embree_config {
        "" => format!("threads={threads}"),
        more => format!("threads={threads},{more}"),
    };
    Library::load(path, &config).map(Some).map_err(Failure::BadInput)
}

/// The rays that trees over the scene are asked, and what they should answer.
fn questions(args: &Args, scene: &BenchScene) -> Result<Questions, Failure> {
    let BenchScene { name, mesh, view, .. } = scene;
    let bad = |why: String| Failure::BadInput(format!("{name}: {why}"));
    let (kinds, rays) = match (args.trace, &*args.sets) {
        (false, _) => (CHECKED_SETS, CHECKED_RAYS),
        (true, []) => (SetKind::ALL, args.rays),
        (true, sets) => (sets, args.rays),
    };
    let reference = Reference::build(mesh).map_err(|error| bad(error.to_string()))?;
    let viewpoint = view.viewpoint(mesh).map_err(bad)?;
    let ask = |set: RaySet| {
        let answers = reference.answers(&set).map_err(|why| {
            Failure::WhileRunning(format!("{name}: the reference is wrong: {why}"))
        })?;
        Ok((set, answers))
    };
    let sets = ray_sets(kinds, &reference, &viewpoint, PictureSize::with_about(rays));
    let sets: Vec<_> = sets.into_iter().filter(|set| !set.rays.is_empty()).collect();
    if sets.is_empty() {
        return Err(bad("the eye sees nothing, so that no tree can be checked".to_owned()));
    }
    Ok(Questions {
        sets: sets.into_iter().map(ask).collect::<Result<_, Failure>>()?,
        timed: args.trace,
    })
}

/// Builds over one scene on so many threads.
fn run_scene(
    args: &Args,
    chosen: &[&'static BuildEntry],
    scene: &BenchScene,
    questions: &Questions,
    pool: &ThreadPool,
) -> Result<Vec<Row>, Failure> {
    let library = load_embree(args, pool.current_num_threads())?;
    let rounds = usize::from(args.rounds);
    Ok(pool.install(|| {
        let prepare =
            |&entry: &&'static BuildEntry| (entry, (entry.prepare)(&scene.mesh, library.as_ref()));
        take_turns(chosen.iter().map(prepare).collect(), questions, rounds)
    }))
}

/// A scene as JSON.
fn described(scene: &BenchScene, questions: &Questions) -> Value {
    let sets = questions.sets.iter();
    json!({
        "name": scene.name,
        "source": scene.source,
        "triangles": scene.mesh.triangles().len(),
        "vertices": scene.mesh.positions().len(),
        "rays": sets
            .map(|(set, answers)| json!({
                "set": set.kind.name(), "rays": set.rays.len(), "hits": answers.hits(),
            }))
            .collect::<Vec<_>>(),
    })
}

fn preset(text: &str) -> Result<&'static str, String> {
    builds().map(|entry| entry.preset).find(|preset| *preset == text).ok_or_else(|| {
        let names: Vec<_> = builds().map(|entry| entry.preset).collect();
        format!("expected one of {}", names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_known_by_name_and_are_one_of_a_kind() {
        assert_eq!(preset("LOW"), Ok("LOW"));
        assert!(preset("low").is_err_and(|said| said.contains("fastest, fast, balanced")));
        let mut names: Vec<_> = builds().map(|entry| (entry.peer, entry.preset)).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
