//! Milliseconds per build of structures, for work on builders: `builds SCENE THREADS STRUCTURE[:PRESET]...`, the median and the least of nine rounds, and the quality of
//! the trees.

use std::time::Instant;

use raywood::{BuildPreset, Structure, StructureKind};
use raywood_scene::{LoadOptions, builtin, load_file};

fn main() {
    let mut args = std::env::args().skip(1);
    let name = args.next().expect("scene");
    let threads = args.next().and_then(|threads| threads.parse().ok()).expect("threads");
    let builds: Vec<_> = args
        .map(|build| {
            let (kind, preset) = build.split_once(':').unwrap_or((&build, "balanced"));
            let preset = BuildPreset::from_name(preset).expect("a preset");
            (StructureKind::from_name(kind).expect("a structure"), preset)
        })
        .collect();
    let scene = match name.strip_prefix("builtin:") {
        Some(name) => builtin(name).expect("a scene"),
        None => load_file(name.as_ref(), &LoadOptions::default()).expect("a scene"),
    };
    let mesh = &scene.mesh.triangles;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        for (kind, preset) in builds {
            let mut times = Vec::new();
            let mut stats = None;
            for _ in 0..9 {
                let start = Instant::now();
                let built = Structure::build(kind, mesh, &preset.options()).expect("ok");
                times.push(start.elapsed().as_secs_f64() * 1e3);
                stats.get_or_insert_with(|| built.stats());
            }
            times.sort_by(f64::total_cmp);
            let (median, least) = (times[4], times[0]);
            let speed = mesh.triangles().len() as f64 / median / 1e3;
            let stats = stats.expect("a round");
            println!(
                "{:16}{:9}{median:9.1} (min {least:.1}) {speed:.2} M/s, {} nodes, {} bytes, cost {:.4}",
                kind.name(),
                preset.name(),
                stats.nodes,
                stats.bytes,
                stats.q
            );
        }
    });
}
