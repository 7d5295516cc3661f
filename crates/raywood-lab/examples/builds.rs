//! Milliseconds per build of structures, for work on builders: `builds SCENE THREADS STRUCTURE[:PRESET]...`, the median and the least of nine rounds, and the quality of
//! the trees.

mod shared;

use std::time::Instant;

use raywood::Structure;
use shared::Builds;

fn main() {
    let Builds { scene, pool, builds } = Builds::from_args();
    let mesh = &scene.mesh.triangles;
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
