//! Everything, as JSON.

use raywood::{StructureKind, StructureStats};
use raywood_lab::{StructureReport, Timing, Traces};
use serde_json::{Value, json};

use super::Compared;

pub(super) fn write(Compared { scene, comparison }: &Compared<'_>) -> String {
    let ray_sets = comparison.ray_sets.iter().map(|set| {
        json!({
            "kind": set.kind.name(), "description": set.kind.description(),
            "rays": set.rays, "hits": set.hits,
        })
    });
    let value = json!({
        "scene": scene,
        "primitives": comparison.primitives,
        "threads": comparison.threads,
        "ray_sets": ray_sets.collect::<Vec<_>>(),
        "structures": comparison.structures.iter().map(report).collect::<Vec<_>>(),
    });
    format!("{value:#}\n")
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

fn timing(timing: &Timing) -> Value {
    json!({ "median": timing.median(), "spread": timing.spread(), "rounds": timing.rounds() })
}

/// Statistics of a structure, as every command prints them for machines.
pub(crate) fn structure(kind: StructureKind, stats: &StructureStats) -> Value {
    json!({
        "name": kind.name(),
        "primitives": stats.primitives,
        "references": stats.references,
        "nodes": stats.nodes,
        "leaves": stats.leaves,
        "empty_leaves": stats.empty_leaves,
        "depth": stats.depth,
        "mean_leaf_primitives": stats.mean_leaf_primitives,
        "max_leaf_primitives": stats.max_leaf_primitives,
        "bytes": stats.bytes,
        "q": stats.q,
        "levels": stats.levels.iter().map(|level| json!({
            "nodes": level.nodes, "leaves": level.leaves, "references": level.references,
        })).collect::<Vec<_>>(),
    })
}
