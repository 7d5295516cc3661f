//! A comparison as JSON: everything.

use raywood_lab::{StructureReport, Traces};
use serde_json::{Value, json};

use super::Compared;
use crate::exporters::json::{ray_set, structure, timing};

pub(super) fn write(Compared { scene, comparison }: &Compared<'_>) -> Value {
    json!({
        "scene": scene,
        "primitives": comparison.primitives,
        "threads": comparison.threads,
        "ray_sets": comparison.ray_sets.iter().map(ray_set).collect::<Vec<_>>(),
        "structures": comparison.structures.iter().map(report).collect::<Vec<_>>(),
    })
}

fn report(StructureReport { kind, build, stats, traces: sets }: &StructureReport) -> Value {
    let mut value = structure(*kind, stats);
    value["build_seconds"] = timing(build);
    value["rays"] = sets.iter().map(traces).collect();
    value
}

fn traces(traces: &Traces) -> Value {
    let Traces { kind, rays, counts, timing: seconds } = traces;
    json!({
        "kind": kind.name(),
        "rays": rays,
        "million_rays_per_second": traces.million_rays_per_second(),
        "seconds": timing(seconds),
        "per_ray": {
            "nodes": traces.per_ray(counts.nodes),
            "boxes": traces.per_ray(counts.boxes),
            "primitives": traces.per_ray(counts.primitives),
        },
    })
}
