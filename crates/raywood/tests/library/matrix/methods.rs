//! No public query is forgotten: every method of the facades is asked by the matrix, or is known to be no query.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What the matrix asks.
const ASKED: &[&str] = &[
    "intersect",
    "intersect_with",
    "intersect_batch",
    "intersect_batch_masked",
    "intersect_from",
    "intersect_from_serial",
    "occluded",
    "occluded_with",
    "occluded_batch",
    "occluded_batch_masked",
    "occluded_towards",
    "all_hits",
    "all_hits_with",
    "all_hits_batch",
    "for_each_hit",
    "for_each_hit_with",
    "crossings",
    "nearest_hits",
    "nearest_hits_with",
    "nearest_hits_batch",
    "closest_point",
    "closest_point_masked",
    "closest_point_batch",
    "solid",
    "contains",
    "contains_batch",
    "signed_distance",
    "signed_distance_batch",
    "overlapping",
    "overlaps",
    "overlaps_batch",
    "overlapping_pairs",
    "overlaps_any_of",
    "sphere_cast",
    "sphere_cast_batch",
    "visit",
    "intersect_packet",
    "occluded_packet",
];

/// The same questions in other words, which other tests ask.
const ELSEWHERE: &[&str] = &[
    // On one thread; telling a probe.
    "intersect_batch_serial",
    "occluded_batch_serial",
    "occluded_towards_serial",
    "occluded_from_surfaces_serial",
    "intersect_probed",
    "occluded_probed",
    // `intersect_with` is asked with masks.
    "intersect_masked",
    "occluded_masked",
    // `motion.rs` compares scenes at times with scenes that stand still.
    "intersect_at",
    "intersect_batch_at",
    "intersect_batch_at_serial",
    "occluded_at",
    "occluded_batch_at",
    "occluded_batch_at_serial",
    "surface_point_at",
    // `solid.rs` sums angles.
    "winding_number",
    "winding_number_batch",
];

/// What is no question about space.
const NO_QUERIES: &[&str] = &[
    "build",
    "build_with",
    "build_watched",
    "build_by",
    "geometry",
    "mesh",
    "tree",
    "kind",
    "instances",
    "instances_mut",
    "bounds",
    "bytes",
    "stats",
    "validate",
    "visit_nodes",
    "locate",
    "moves",
    "nodes",
    "primitive_indices",
    "simd_level",
    "set_simd_level",
    "surface_point",
    "refit",
    "save",
    "save_with",
    "load",
    "set_transform",
    "insert",
    "remove",
    "rebuild",
    "update",
];

/// The files below a folder.
fn files(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the sources") {
        let path = entry.expect("the sources").path();
        if path.is_dir() { files(&path, all) } else { all.push(path) }
    }
}

#[test]
fn no_query_is_forgotten() {
    let mut sources = Vec::new();
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut sources);
    let mut found = BTreeSet::new();
    for path in sources {
        let text = fs::read_to_string(&path).expect("a source");
        // Blocks of methods begin and end in the first column.
        let mut is_facade = false;
        for line in text.lines() {
            if let Some(head) = line.strip_prefix("impl") {
                let name = |types: &[&str]| types.iter().any(|t| head.contains(t));
                is_facade = !head.contains(" for ")
                    && name(&[
                        " Bvh<",
                        " Bvh2 ",
                        " Bvh64 ",
                        " Tlas<",
                        " Structure<",
                        "Solid<",
                        "Solid64<",
                    ]);
            } else if line == "}" {
                is_facade = false;
            }
            if let Some(method) = line.strip_prefix("    pub fn ").filter(|_| is_facade) {
                let end = method.find(['<', '(']).expect("a name");
                found.insert(method[..end].to_string());
            }
        }
    }
    let known: BTreeSet<String> =
        [ASKED, ELSEWHERE, NO_QUERIES].concat().iter().map(|name| name.to_string()).collect();
    let forgotten: Vec<_> = found.difference(&known).collect();
    assert!(forgotten.is_empty(), "add {forgotten:?} to the matrix, or here as no query");
    let gone: Vec<_> = ASKED.iter().filter(|name| !found.contains(**name)).collect();
    assert!(gone.is_empty(), "there is no {gone:?}");
}
