//! `raywood-bench query`: closest points and crossings, by all libraries that find them, over the same points and rays.

use std::path::PathBuf;

use rayon::ThreadPool;
use raywood_lab::timing::seconds;
use serde_json::{Value, json};

use super::scene_args::{SceneArgs, few_scenes};
use super::{names, output, pools};
use crate::failure::Failure;
use crate::machine::{machine, now};
use crate::outcome::Outcome;
use crate::peers::queries::{QUERY_PEERS, QueryEntry};
use crate::query::measure::{Measurement, Row, measure};
use crate::query::ratios::ratios;
use crate::query::reference::Reference;
use crate::query::report;
use crate::query::sets::{QueryKind, query_sets};
use crate::scenes::BenchScene;

/// Let libraries find closest points and count crossings, and compare their times.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    scenes: SceneArgs,

    /// Which sets of points or rays, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::query_set)]
    sets: Vec<QueryKind>,

    /// Which libraries, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::query_peer)]
    peers: Vec<&'static str>,

    /// Which of the libraries' modes, by the names in the table, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    modes: Vec<String>,

    /// On how many threads, one number or several
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', default_value = "1")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,

    /// How often each library answers each set
    #[arg(long, value_name = "N", default_value_t = 7)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=10_000))]
    rounds: u16,

    /// How many points or rays of each kind
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_024_000))]
    queries: u32,

    /// Also write everything to a file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let started = now();
    let pools = pools(&args.threads)?;
    let chosen = |entry: &&QueryEntry| args.peers.is_empty() || args.peers.contains(&entry.name);
    let peers: Vec<_> = QUERY_PEERS.iter().filter(chosen).collect();
    if let Some(file) = &args.json {
        output::try_to_write(file)?;
    }

    let (mut scenes, mut measurements) = (Vec::new(), Vec::new());
    for load in args.scenes.loaders(&few_scenes()) {
        let Some(scene) = load()? else { continue };
        let (described, measured) = run_scene(args, &scene, &peers, &pools)?;
        scenes.push(described);
        measurements.extend(measured);
        // Written anew after each scene, so that a run that is stopped leaves what it has.
        if let Some(file) = &args.json {
            let everything = json!({
                "command": "query",
                "date": started,
                "machine": machine(),
                "raywood": env!("CARGO_PKG_VERSION"),
                "settings": { "rounds": args.rounds, "queries": args.queries },
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
        return Err(Failure::BadInput("there is no scene to ask about".to_owned()));
    }
    Ok(())
}

/// Asks about one scene: what it is, and what was measured.
fn run_scene(
    args: &Args,
    scene: &BenchScene,
    peers: &[&QueryEntry],
    pools: &[ThreadPool],
) -> Result<(Value, Vec<Measurement>), Failure> {
    let BenchScene { name, source, mesh, view } = scene;
    let in_scene = |why: &dyn std::fmt::Display| format!("{name}: {why}");
    let diagonal = view.diagonal.unwrap_or_else(|| mesh.total_bounds().diagonal());
    let kinds = if args.sets.is_empty() { QueryKind::ALL } else { &args.sets };
    let triangles = mesh.triangles().len();
    println!("\n{name}: {source}, {triangles} triangles");

    let reference = Reference::build(mesh).map_err(|error| Failure::BadInput(in_scene(&error)))?;
    let sets = query_sets(kinds, mesh, diagonal, args.queries as usize);
    let mut builds = Vec::new();
    let (mut built, mut absent) = (Vec::new(), Vec::new());
    for peer in peers {
        let (time, trees) = seconds(|| (peer.build)(mesh));
        match trees {
            Ok(trees) => {
                println!("  {} built in {time:.2} s", peer.name);
                builds.push(json!({ "peer": peer.name, "seconds": time }));
                built.push((peer.name, trees));
            }
            Err(why) => {
                println!("  {}: {why}", peer.name);
                absent.push(Row { peer: peer.name, mode: "", outcome: Outcome::Absent(why) });
            }
        }
    }

    let mut measurements = Vec::new();
    for set in &sets {
        let expected = reference.expected(set).map_err(|why| {
            Failure::WhileRunning(in_scene(&format_args!("the reference is wrong: {why}")))
        })?;
        let modes: Vec<_> = built
            .iter()
            .flat_map(|(peer, trees)| trees.modes().into_iter().map(|mode| (*peer, mode)))
            .filter(|(_, mode)| {
                args.modes.is_empty() || args.modes.iter().any(|name| name == mode.name)
            })
            .collect();
        if modes.is_empty() && !args.modes.is_empty() {
            let why = format!("no library has a mode named {}", args.modes.join(" or "));
            return Err(Failure::BadInput(why));
        }
        let rounds = usize::from(args.rounds);
        for mut measurement in measure(name, set, &expected, &modes, pools, rounds) {
            measurement.rows.extend(absent.iter().cloned());
            print!("{}", report::text(&measurement));
            measurements.push(measurement);
        }
    }
    let described = json!({
        "name": name,
        "source": source,
        "triangles": triangles,
        "diagonal": diagonal,
        "builds": builds,
    });
    Ok((described, measurements))
}
