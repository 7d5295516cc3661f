//! Comma-separated values: one line per kind of rays, level of instructions and number of threads, and for pictures. No name needs quotes.

use raywood_lab::{Benchmark, Speed};

use super::{PICTURE, level_name, million_rays_per_second, nanoseconds, set_of};

const HEADER: &str = "what,simd,threads,rays,hit_share,ns_per_ray,spread,million_rays_per_second,\
                      cycles_per_ray,frames_per_second,core_clock_hertz\n";

pub(super) fn write(benchmark: &Benchmark) -> String {
    let scalar = level_name(benchmark);
    let mut text = HEADER.to_owned();
    for rays in &benchmark.rays {
        let level = rays.level.map_or(scalar, |level| level.name());
        let set = set_of(benchmark, rays).filter(|set| set.rays > 0);
        let hit = set.map(|set| (set.hits as f64 / set.rays as f64).to_string());
        text += &line(benchmark, rays.kind.name(), level, &hit.unwrap_or_default(), &rays.speed);
    }
    for speed in &benchmark.pictures.speeds {
        // How many rays of a picture hit is not known.
        text += &line(benchmark, PICTURE, scalar, "", speed);
    }
    text
}

fn line(benchmark: &Benchmark, what: &str, level: &str, hit: &str, speed: &Speed) -> String {
    let clock = benchmark.clocks.iter().find(|clock| clock.threads == speed.threads);
    let fields = [
        what.to_owned(),
        level.to_owned(),
        speed.threads.to_string(),
        speed.rays.to_string(),
        hit.to_owned(),
        nanoseconds(speed).to_string(),
        speed.timing.spread().to_string(),
        million_rays_per_second(speed).to_string(),
        benchmark.cycles_per_ray(speed).to_string(),
        speed.frames_per_second().to_string(),
        clock.map_or(0.0, |clock| clock.hertz()).to_string(),
    ];
    fields.join(",") + "\n"
}
