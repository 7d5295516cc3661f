//! Nanoseconds per ray of structures' batches on one thread, for work on kernels: `kernels SCENE STRUCTURE...`, the median and the least of nine rounds.

use raywood::{Structure, StructureKind};
use raywood_lab::ray_sets::ray_sets;
use raywood_render::{PreparedScene, default_view};
use raywood_scene::{LoadOptions, builtin, load_file};

fn main() {
    let mut args = std::env::args().skip(1);
    let name = args.next().expect("scene");
    let kinds: Vec<_> = args.map(|k| StructureKind::from_name(&k).expect("a structure")).collect();
    let scene = match name.strip_prefix("builtin:") {
        Some(name) => builtin(name).expect("a scene"),
        None => load_file(name.as_ref(), &LoadOptions::default()).expect("a scene"),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(|| {
        let prepared = PreparedScene::new(&scene).expect("it builds");
        let view = default_view(&prepared, 1.6);
        let sets = ray_sets(&prepared, &view, 1.6, 1 << 18).expect("rays");
        for kind in kinds {
            let s = Structure::build(kind, &scene.mesh.triangles, &Default::default()).expect("ok");
            print!("{:16}", kind.name());
            for set in &sets {
                let mut times = Vec::new();
                let mut hits = vec![None; set.rays.len()];
                let mut blocked = vec![false; set.rays.len()];
                for _ in 0..9 {
                    let start = std::time::Instant::now();
                    if set.kind.any_hit() {
                        s.occluded_batch(&set.rays, &mut blocked);
                    } else {
                        s.intersect_batch(&set.rays, &mut hits);
                    }
                    times.push(start.elapsed().as_secs_f64() * 1e9 / set.rays.len() as f64);
                }
                times.sort_by(f64::total_cmp);
                print!("  {} {:.1} (min {:.1})", set.kind.name(), times[4], times[0]);
            }
            println!();
        }
    });
}
