//! `raywood-bench trace`: all kernels trace the same sets of rays.

use std::path::PathBuf;

use rayon::ThreadPool;
use raywood_lab::timing::seconds;
use serde_json::{Value, json};

use super::scene_args::SceneArgs;
use super::{names, output, pools};
use crate::embree::Library;
use crate::failure::Failure;
use crate::machine::{machine, now};
use crate::measure::{Contestant, Measurement, Row, measure};
use crate::outcome::Outcome;
use crate::peers::{Built, PEERS, PeerEntry};
use crate::pixel_order::PictureSize;
use crate::ratios::ratios;
use crate::ray_sets::{SetKind, ray_sets};
use crate::reference::Reference;
use crate::report;
use crate::scenes::{BenchScene, SCENES};

/// Let all kernels trace the same rays, and compare their times.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    scenes: SceneArgs,

    /// Which sets of rays, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::set)]
    sets: Vec<SetKind>,

    /// Which kernels, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::peer)]
    peers: Vec<&'static str>,

    /// Which of the kernels' modes, by the names in the table, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    modes: Vec<String>,

    /// On how many threads, one number or several
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', default_value = "1")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,

    /// The shared library of Embree 4
    #[arg(long, value_name = "LIB")]
    embree: Option<PathBuf>,

    /// How Embree is configured, as in isa=avx2
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    #[arg(requires = "embree")]
    embree_config: String,

    /// How often each kernel traces each set
    #[arg(long, value_name = "N", default_value_t = 7)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=10_000))]
    rounds: u16,

    /// About how many rays of each kind, at most 1024000
    #[arg(long, value_name = "N", default_value_t = PictureSize::FULL.width * PictureSize::FULL.height)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_024_000))]
    rays: u32,

    /// Also write everything to a file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let started = now();
    let pools = pools(&args.threads)?;
    let library = match &args.embree {
        Some(path) => Some(Library::load(path, &args.embree_config).map_err(Failure::BadInput)?),
        None => None,
    };
    let chosen = |entry: &&PeerEntry| args.peers.is_empty() || args.peers.contains(&entry.name);
    let peers: Vec<_> = PEERS.iter().filter(chosen).collect();
    if let Some(file) = &args.json {
        output::try_to_write(file)?;
    }

    let (mut scenes, mut measurements) = (Vec::new(), Vec::new());
    for load in args.scenes.loaders(SCENES) {
        let Some(scene) = load()? else { continue };
        let (described, measured) = run_scene(args, &scene, &peers, library.as_ref(), &pools)?;
        scenes.push(described);
        measurements.extend(measured);
        // Written anew after each scene, so that a run that is stopped leaves what it has.
        if let Some(file) = &args.json {
            let everything = json!({
                "date": started,
                "machine": machine(),
                "raywood": env!("CARGO_PKG_VERSION"),
                "embree": library.as_ref().map(|library| json!({
                    "version": library.version(), "config": args.embree_config,
                })),
                "settings": { "rounds": args.rounds, "rays": args.rays },
                "peers": peers.iter().map(|peer| json!({
                    "name": peer.name, "settings": peer.settings,
                })).collect::<Vec<_>>(),
                "scenes": scenes,
                "measurements":
                    measurements.iter().map(report::measurement_json).collect::<Vec<_>>(),
                "ratios": measurements
                    .iter()
                    .flat_map(ratios)
                    .map(|ratio| ratio.json())
                    .collect::<Vec<_>>(),
            });
            output::write(file, &everything)?;
        }
    }
    if scenes.is_empty() {
        return Err(Failure::BadInput("there is no scene to trace".to_owned()));
    }
    Ok(())
}

/// Traces one scene: what it is, and what was measured.
fn run_scene(
    args: &Args,
    scene: &BenchScene,
    peers: &[&PeerEntry],
    library: Option<&Library>,
    pools: &[ThreadPool],
) -> Result<(Value, Vec<Measurement>), Failure> {
    let BenchScene { name, source, mesh, view } = scene;
    let in_scene = |why: &dyn std::fmt::Display| format!("{name}: {why}");
    let viewpoint = view.viewpoint(mesh).map_err(|why| Failure::BadInput(in_scene(&why)))?;
    let size = PictureSize::with_about(args.rays);
    let kinds = if args.sets.is_empty() { SetKind::ALL } else { &args.sets };
    let triangles = mesh.triangles().len();
    println!("\n{name}: {source}, {triangles} triangles");

    let reference = Reference::build(mesh).map_err(|error| Failure::BadInput(in_scene(&error)))?;
    let sets = ray_sets(kinds, &reference, &viewpoint, size);
    let mut builds = Vec::new();
    let mut built: Vec<(&PeerEntry, Built<'_>)> = Vec::new();
    for peer in peers {
        let (time, trees) = seconds(|| (peer.build)(mesh, library));
        match &trees {
            Ok(_) => {
                println!("  {} built in {time:.2} s", peer.name);
                builds.push(json!({ "peer": peer.name, "seconds": time }));
            }
            Err(why) => println!("  {}: {why}", peer.name),
        }
        built.push((peer, trees));
    }

    let mut measurements = Vec::new();
    for set in &sets {
        if set.rays.is_empty() {
            println!("\n{name}, {}: no rays, the eye sees nothing", set.kind.name());
            continue;
        }
        let expected = reference.answers(set).map_err(|why| {
            Failure::WhileRunning(in_scene(&format_args!("the reference is wrong: {why}")))
        })?;
        let contestants: Vec<_> = built
            .iter()
            .filter_map(|(peer, trees)| Some((peer, trees.as_ref().ok()?)))
            .flat_map(|(peer, trees)| {
                trees.modes().into_iter().map(|mode| Contestant { peer: peer.name, mode })
            })
            .filter(|contestant| {
                args.modes.is_empty() || args.modes.iter().any(|name| name == contestant.mode.name)
            })
            .collect();
        if contestants.is_empty() && !args.modes.is_empty() {
            let why = format!("no kernel has a mode named {}", args.modes.join(" or "));
            return Err(Failure::BadInput(why));
        }
        let rounds = usize::from(args.rounds);
        for mut measurement in measure(name, set, &expected, &contestants, pools, rounds) {
            for (peer, trees) in &built {
                if let Err(why) = trees {
                    let outcome = Outcome::Absent(why.clone());
                    let row = Row { peer: peer.name, mode: "", watertight: false, outcome };
                    measurement.rows.push(row);
                }
            }
            print!("{}", report::text(&measurement));
            measurements.push(measurement);
        }
    }
    let described = json!({
        "name": name,
        "source": source,
        "triangles": triangles,
        "diagonal": viewpoint.diagonal,
        "eye": view.eye.to_array(),
        "target": view.target.to_array(),
        "tan": view.tan,
        "light": view.light.to_array(),
        "width": size.width,
        "height": size.height,
        "builds": builds,
    });
    Ok((described, measurements))
}
