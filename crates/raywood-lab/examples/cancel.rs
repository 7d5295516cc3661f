//! How builds are watched: `cancel SCENE THREADS STRUCTURE[:PRESET]...` prints how far the share that is said to be done is from the share of the time, the longest time
//! between two questions whether to go on, and how long a build takes to stop.

mod shared;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use raywood::{BuildError, Structure};
use shared::Builds;

/// At how many places of a build it is stopped.
const PLACES: u32 = 40;

fn main() {
    let Builds { scene, pool, builds } = Builds::from_args();
    let mesh = &scene.mesh.triangles;
    println!("{} triangles, {} threads", mesh.triangles().len(), pool.current_num_threads());
    pool.install(|| {
        for (kind, preset) in builds {
            let options = preset.options();
            let start = Instant::now();
            let mut told = Vec::with_capacity(1 << 20);
            let built = Structure::build_watched(kind, mesh, &options, |done| {
                told.push((start.elapsed(), done));
                ControlFlow::Continue(())
            });
            let whole = start.elapsed();
            drop(built.expect("it builds"));

            let off = told.iter().map(|(time, done)| {
                let share = time.as_secs_f64() / whole.as_secs_f64();
                ((done - share).abs(), *done, share)
            });
            let (off, done, share) = off.max_by(|a, b| a.0.total_cmp(&b.0)).expect("told");
            let gaps = told.windows(2).map(|pair| (pair[1].0 - pair[0].0, pair[0].1));
            let (gap, place) = gaps.max_by(|a, b| a.0.cmp(&b.0)).expect("told twice");
            let mut stops: Vec<Duration> = (0..PLACES)
                .map(|place| {
                    let (start, limit) = (Instant::now(), whole * place / PLACES);
                    let mut asked = None;
                    let stopped = Structure::build_watched(kind, mesh, &options, |_| {
                        if start.elapsed() < limit {
                            return ControlFlow::Continue(());
                        }
                        asked = Some(());
                        ControlFlow::Break(())
                    });
                    let time = start.elapsed().saturating_sub(limit);
                    // A build may be faster than the first.
                    match (stopped.map(|_| ()), asked) {
                        (Ok(()), None) => Duration::ZERO,
                        (Err(BuildError::Cancelled), Some(())) => time,
                        other => panic!("{other:?}"),
                    }
                })
                .collect();
            stops.sort_unstable();
            println!(
                "{:14}{:9}{:8.0} ms, {} times told, {off:.2} off ({done:.2} at {share:.2}), {:.1} ms without question (at {place:.2}), stopped after {:.1} ms, at most {:.1}",
                kind.name(),
                preset.name(),
                whole.as_secs_f64() * 1e3,
                told.len(),
                gap.as_secs_f64() * 1e3,
                stops[stops.len() / 2].as_secs_f64() * 1e3,
                stops[stops.len() - 1].as_secs_f64() * 1e3,
            );
        }
    });
}
