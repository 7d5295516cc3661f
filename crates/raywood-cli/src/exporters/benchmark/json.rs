//! A benchmark as JSON: everything.

use raywood_lab::frame_budget::{CYCLES_PER_RAY, FRAMES_PER_SECOND, RAYS_PER_FRAME};
use raywood_lab::{Benchmark, Clock, Pictures, RaySpeed, Speed};
use serde_json::{Value, json};

use super::{Benched, million_rays_per_second, nanoseconds};
use crate::exporters::json::{ray_set, timing};

pub(super) fn write(
    Benched { scene, build: (seconds, threads), benchmark }: &Benched<'_>,
) -> Value {
    let Benchmark { primitives, structure, level, levels, clocks, ray_sets, rays, pictures } =
        benchmark;
    let one = |rays: &RaySpeed| {
        let mut value = speed(benchmark, &rays.speed);
        value["kind"] = rays.kind.name().into();
        value["simd"] = rays.level.map(|level| level.name()).into();
        value
    };
    json!({
        "scene": scene,
        "primitives": primitives,
        "structure": structure.name(),
        "build": { "seconds": seconds, "threads": threads },
        "simd": level.map(|level| level.name()),
        "simd_levels": levels.iter().map(|level| level.name()).collect::<Vec<_>>(),
        "core_clocks": clocks.iter().map(clock).collect::<Vec<_>>(),
        "ray_sets": ray_sets.iter().map(ray_set).collect::<Vec<_>>(),
        "rays": rays.iter().map(one).collect::<Vec<_>>(),
        "pictures": picture(benchmark, pictures),
        "frame_budget": {
            "rays_per_frame": RAYS_PER_FRAME,
            "frames_per_second": FRAMES_PER_SECOND,
            "cycles_per_ray": CYCLES_PER_RAY,
        },
    })
}

fn clock(clock: &Clock) -> Value {
    let Clock { threads, cores, cycle } = clock;
    json!({ "threads": threads, "cores": cores, "hertz": clock.hertz(), "spread": cycle.spread() })
}

fn picture(benchmark: &Benchmark, Pictures { width, height, rays, speeds }: &Pictures) -> Value {
    json!({
        "width": width,
        "height": height,
        "rays": {
            "primary": rays.primary,
            "shadow": rays.shadow,
            "reflection": rays.reflection,
            "refraction": rays.refraction,
            "total": rays.total(),
        },
        "speeds": speeds.iter().map(|each| speed(benchmark, each)).collect::<Vec<_>>(),
    })
}

fn speed(benchmark: &Benchmark, speed: &Speed) -> Value {
    json!({
        "threads": speed.threads,
        "rays": speed.rays,
        "seconds": timing(&speed.timing),
        "ns_per_ray": nanoseconds(speed),
        "million_rays_per_second": million_rays_per_second(speed),
        "cycles_per_ray": benchmark.cycles_per_ray(speed),
        "frames_per_second": speed.frames_per_second(),
    })
}
