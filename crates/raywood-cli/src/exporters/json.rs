//! JSON: what several reports have in common.

use raywood::{StructureKind, StructureStats};
use raywood_lab::{RaySetSummary, Timing};
use serde_json::{Value, json};

/// A time that was measured.
pub(super) fn timing(timing: &Timing) -> Value {
    json!({ "median": timing.median(), "spread": timing.spread(), "rounds": timing.rounds() })
}

/// A set of rays.
pub(super) fn ray_set(set: &RaySetSummary) -> Value {
    json!({
        "kind": set.kind.name(), "description": set.kind.description(),
        "rays": set.rays, "hits": set.hits,
    })
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
