//! `raywood-bench trace`: all kernels trace the same sets of rays.

use std::fs::File;
use std::path::{Path, PathBuf};

use rayon::{ThreadPool, ThreadPoolBuilder};
use raywood::Vec3;
use raywood_lab::timing::seconds;
use serde_json::{Value, json};

use crate::embree::Library;
use crate::failure::Failure;
use crate::machine::{machine, now};
use crate::measure::{Contestant, Measurement, Outcome, Row, measure};
use crate::peers::{Built, PEERS, PeerEntry};
use crate::pixel_order::PictureSize;
use crate::ratios::ratios;
use crate::ray_sets::{SetKind, ray_sets};
use crate::reference::Reference;
use crate::report;
use crate::scenes::{BenchScene, SCENES, SceneEntry, View, load_model};

/// Let all kernels trace the same rays, and compare their times.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Which scenes, separated by commas [default: all that are found]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = scene)]
    scenes: Vec<SceneEntry>,

    /// The folder with the models, searched to any depth [default: $RAYWOOD_TEST_SCENES]
    #[arg(long, value_name = "FOLDER")]
    scene_files: Option<PathBuf>,

    /// Any model instead, in any format that Raywood reads
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "scene_files"])]
    #[arg(requires_all = ["eye", "target", "tan", "light"])]
    triangles: Option<PathBuf>,

    /// Where the model is seen from
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(requires = "triangles")]
    eye: Option<Vec3>,

    /// What is in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(requires = "triangles")]
    target: Option<Vec3>,

    /// The tangent of half the vertical angle of view
    #[arg(long, value_name = "K", value_parser = above_zero, requires = "triangles")]
    tan: Option<f32>,

    /// Where the light is
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(requires = "triangles")]
    light: Option<Vec3>,

    /// Which sets of rays, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = set)]
    sets: Vec<SetKind>,

    /// Which kernels, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = peer)]
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
        // Now rather than after long work, and without harm to what is there.
        File::options().append(true).create(true).open(file).map_err(|error| {
            Failure::BadInput(format!("{}: cannot be written: {error}", file.display()))
        })?;
    }

    let (mut scenes, mut measurements) = (Vec::new(), Vec::new());
    for load in loaders(args) {
        let scene = match load() {
            Ok(scene) => scene,
            Err(Skip::Missing(why)) => {
                eprintln!("raywood-bench: {why}; skipped");
                continue;
            }
            Err(Skip::Bad(why)) => return Err(Failure::BadInput(why)),
        };
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
            std::fs::write(file, format!("{everything:#}\n"))
                .map_err(|error| Failure::WhileRunning(format!("{}: {error}", file.display())))?;
        }
    }
    if scenes.is_empty() {
        return Err(Failure::BadInput("there is no scene to trace".to_owned()));
    }
    Ok(())
}

/// Why a scene is not there.
enum Skip {
    /// Its file is not: the others are traced all the same.
    Missing(String),
    /// It was asked for as a file, or is broken.
    Bad(String),
}

/// What loads each scene, when its turn comes: they need not all be in memory.
fn loaders(args: &Args) -> Vec<Box<dyn Fn() -> Result<BenchScene, Skip> + '_>> {
    if let (Some(path), Some(eye), Some(target), Some(tan), Some(light)) =
        (&args.triangles, args.eye, args.target, args.tan, args.light)
    {
        let view = View { eye, target, tan, light, diagonal: None };
        return vec![Box::new(move || load_model(path, view).map_err(Skip::Bad))];
    }
    let from_environment = || std::env::var_os("RAYWOOD_TEST_SCENES").map(PathBuf::from);
    let folder = args.scene_files.clone().or_else(from_environment);
    let entries = if args.scenes.is_empty() { SCENES } else { &args.scenes };
    let load = |entry: &SceneEntry, folder: Option<&Path>| {
        entry.load(folder).map_err(|why| Skip::Missing(format!("{}: {why}", entry.name)))
    };
    let loader = |entry: &SceneEntry| {
        let (entry, folder) = (*entry, folder.clone());
        Box::new(move || load(&entry, folder.as_deref())) as Box<dyn Fn() -> _>
    };
    entries.iter().map(loader).collect()
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

/// A pool of threads for each number of them.
fn pools(threads: &[u16]) -> Result<Vec<ThreadPool>, Failure> {
    let pool = |&threads: &u16| ThreadPoolBuilder::new().num_threads(threads.into()).build();
    threads
        .iter()
        .map(pool)
        .collect::<Result<_, _>>()
        .map_err(|error| Failure::while_running(format!("cannot start the threads: {error}")))
}

/// The entry that is called so.
fn named<T>(items: &[T], name_of: fn(&T) -> &'static str, text: &str) -> Result<T, String>
where
    T: Copy,
{
    items.iter().find(|item| name_of(item) == text).copied().ok_or_else(|| {
        let names: Vec<_> = items.iter().map(name_of).collect();
        format!("expected one of {}", names.join(", "))
    })
}

fn scene(text: &str) -> Result<SceneEntry, String> {
    named(SCENES, |scene| scene.name, text)
}

fn set(text: &str) -> Result<SetKind, String> {
    named(SetKind::ALL, |set| set.name(), text)
}

fn peer(text: &str) -> Result<&'static str, String> {
    named(PEERS, |peer| peer.name, text).map(|peer| peer.name)
}

/// Three finite numbers between commas.
fn point(text: &str) -> Result<Vec3, String> {
    let numbers: Vec<_> = text.split(',').map(|part| part.trim().parse::<f32>()).collect();
    match numbers[..] {
        [Ok(x), Ok(y), Ok(z)] if [x, y, z].iter().all(|x| x.is_finite()) => Ok(Vec3::new(x, y, z)),
        _ => Err("expected three numbers, as in 1,2.5,-3".to_owned()),
    }
}

fn above_zero(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_read() {
        assert_eq!(set("ao"), Ok(SetKind::AmbientOcclusion));
        let said = set("reflection").expect_err("no such set");
        assert_eq!(said, "expected one of primary, shadow, mirror, ao, diffuse, shuffled");
        assert_eq!(peer("embree"), Ok("embree"));
        assert!(peer("embre").is_err());
        assert_eq!(scene("terrain").map(|scene| scene.name), Ok("terrain"));
        assert!(scene("Terrain").is_err());
        assert_eq!(point("1, -2.5,3e2"), Ok(Vec3::new(1.0, -2.5, 300.0)));
        for bad in ["", "1,2", "1,2,3,4", "1,2,nan", "1,2,x"] {
            assert!(point(bad).is_err(), "{bad}");
        }
        assert!(["0", "-1", "inf", ""].iter().all(|bad| above_zero(bad).is_err()));
    }
}
