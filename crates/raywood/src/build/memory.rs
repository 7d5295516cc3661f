//! How much memory a build takes, told before it begins: the lists that are held at the same time, stage by stage.

use super::{BuildOptions, Builder, driver};
use crate::structures::wide;
use crate::{BuildError, Node, StructureKind, parallel};

/// How much memory a build takes at most, in bytes, the geometry not counted: from the number of primitives and the options alone.
///
/// Of binary trees built from the top down (`bvh-midpoint` to `bvh-sah-binned`) this is a bound in any scene. What else is held depends on how many nodes and references a
/// scene needs; taken are as many as triangles need that lie some way from each other. Surfaces of small triangles need down to half of it, scattered dust more.
/// How large a [`WideBvh`](crate::WideBvh) becomes is known before its memory is taken, and a build beyond its [limit](BuildOptions::memory_limit) ends there.
/// `docs/memory.md` tells how it is made up, and has the bounds of all structures.
///
/// ```
/// use raywood::{BuildMemory, BuildOptions, BuildPreset, StructureKind};
///
/// let memory = |preset: BuildPreset| BuildMemory::of(StructureKind::BvhWide, 1_000_000, &preset.options());
/// assert!(memory(BuildPreset::Balanced).peak < 200 << 20);
/// assert!(memory(BuildPreset::Fastest).peak < memory(BuildPreset::Balanced).peak);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildMemory {
    /// When most is held, the structure or what is finished of it counted.
    pub peak: usize,
    /// What is left in the end: the structure.
    pub structure: usize,
}

/// Bytes for each primitive, at most during the build and in the end.
#[derive(Clone, Copy)]
struct PerPrimitive {
    peak: f64,
    structure: f64,
}

/// A primitive's box with its number.
const BOX: f64 = 32.0;

/// The number of a primitive or of its first reference.
const NUMBER: f64 = 4.0;

/// A place on the curve with the number of a primitive.
const KEY: f64 = 8.0;

/// A cluster of primitives: its box, what it is, and how many there are.
const CLUSTER: f64 = 32.0;

/// Two clusters that were merged.
const MERGE: f64 = 36.0;

/// A node of a binary tree.
const NODE: f64 = size_of::<Node>() as f64;

/// What all primitives' small shares in lists of pieces and tasks add up to.
const SMALL_LISTS: f64 = 2.0;

/// What even the smallest structures take: a wide node and its leaves, tables.
const LEAST: f64 = 8192.0;

impl BuildMemory {
    /// Of a structure over so many primitives. It counts the threads of the current rayon pool.
    pub fn of(kind: StructureKind, primitives: usize, options: &BuildOptions) -> Self {
        let options = options.clamped();
        let PerPrimitive { peak, structure } = match kind {
            // Lists of boxes alone.
            StructureKind::BruteForce => PerPrimitive { peak: BOX, structure: 0.0 },
            StructureKind::UniformGrid => uniform_grid(f64::from(options.grid_density)),
            StructureKind::NestedGrid => nested_grid(f64::from(options.grid_density)),
            StructureKind::Octree => octree(options.octree_leaf_size as f64),
            // References with boxes on a way down, those that planes doubled included.
            StructureKind::KdTree => PerPrimitive { peak: 115.0, structure: 45.0 },
            StructureKind::BvhWide => wide(primitives, &options),
            StructureKind::BvhMidpoint => binary(Builder::Midpoint, primitives, &options),
            StructureKind::BvhMedian => binary(Builder::Median, primitives, &options),
            StructureKind::BvhSahSweep => binary(Builder::SahSweep, primitives, &options),
            StructureKind::BvhSahBinned => binary(Builder::SahBinned, primitives, &options),
            StructureKind::BvhLbvh => binary(Builder::Lbvh, primitives, &options),
            StructureKind::BvhHlbvh => binary(Builder::Hlbvh, primitives, &options),
            StructureKind::BvhPloc => binary(Builder::Ploc, primitives, &options),
        };
        let n = primitives as f64;
        Self {
            peak: (LEAST + (peak + SMALL_LISTS) * n) as usize,
            structure: (LEAST + structure * n) as usize,
        }
    }

    /// Refuses a build that may take more than the options allow.
    pub(crate) fn check(
        kind: StructureKind,
        primitives: usize,
        options: &BuildOptions,
    ) -> Result<(), BuildError> {
        match options.memory_limit {
            None => Ok(()),
            Some(_) => Self::check_bytes(Self::of(kind, primitives, options).peak, options),
        }
    }

    /// Refuses a build that holds so many bytes in large lists, if the options do not allow it.
    pub(crate) fn check_lists(
        bytes: usize,
        primitives: usize,
        options: &BuildOptions,
    ) -> Result<(), BuildError> {
        let small_lists = 0.25 * LEAST + SMALL_LISTS * primitives as f64;
        Self::check_bytes(bytes.saturating_add(small_lists as usize), options)
    }

    /// Refuses what takes more than the options allow.
    fn check_bytes(needed: usize, options: &BuildOptions) -> Result<(), BuildError> {
        match options.memory_limit {
            Some(limit) if needed > limit => Err(BuildError::MemoryLimit { needed, limit }),
            _ => Ok(()),
        }
    }
}

/// The most nodes that a binary tree has for each primitive.
const MOST_NODES: f64 = 2.0;

/// How many nodes a binary tree has for each primitive in usual scenes.
fn usual_nodes(builder: Builder, max_leaf_size: usize) -> f64 {
    // Leaves come out half full or fuller; but where primitives lie far apart, the heuristic wants smaller ones.
    let half_full = 4.8 / max_leaf_size as f64;
    match builder {
        Builder::SahSweep | Builder::SahBinned | Builder::Ploc => half_full.clamp(1.7, MOST_NODES),
        Builder::Midpoint | Builder::Median | Builder::Lbvh | Builder::Hlbvh => {
            half_full.min(MOST_NODES)
        }
    }
}

/// A binary tree of `n` primitives, with what is held while it is built and improved.
fn binary(builder: Builder, n: usize, options: &BuildOptions) -> PerPrimitive {
    // Of a tree from the top down this is a bound in any scene.
    let nodes = match builder {
        Builder::Lbvh | Builder::Hlbvh => usual_nodes(builder, options.max_leaf_size),
        _ => MOST_NODES,
    };
    let tree = NODE * nodes + NUMBER;
    // Pieces have room for a node a primitive, and double it when they need more; in the end they and the tree that they are copied to are there, unless there is one alone.
    let pieces = if nodes > 1.0 { 2.0 * NODE } else { NODE };
    let copied = if n > driver::PARALLEL_SUBTREES { pieces + tree } else { 0.0 };
    let divided = |lists: f64| (lists + NUMBER + pieces).max(copied);
    let building = match builder {
        Builder::Midpoint | Builder::Median => divided(BOX),
        // Half areas of one side.
        Builder::SahSweep => divided(BOX + 8.0),
        // Room to copy to.
        Builder::SahBinned if n > driver::LARGE_SET => divided(2.0 * BOX),
        Builder::SahBinned => divided(BOX),
        // Keys, twice while they are sorted.
        Builder::Lbvh => (2.0 * KEY).max(KEY + pieces + tree),
        Builder::Hlbvh => {
            // The first tree, references to its leaves, and a tree over these, of one a leaf.
            let leaves = 0.5 * nodes;
            let above = leaves * (2.0 * BOX + NUMBER + MOST_NODES * NODE);
            (KEY + pieces + tree).max(tree + 8.0 * leaves + above + NUMBER)
        }
        Builder::Ploc => {
            // The order; clusters, and those of the next round; their neighbours. In the end merges and the tree.
            let clustering = NUMBER + 2.0 * CLUSTER + 1.0 + MERGE;
            (2.0 * KEY).max(clustering).max(NUMBER + MERGE + NUMBER + pieces + tree)
        }
    };

    // Each thread has a piece that grows, and the boxes of its primitives where these are not there anyway.
    let growing = if nodes > 1.0 { NODE } else { 0.0 };
    let boxes = match builder {
        Builder::Lbvh | Builder::Hlbvh => BOX,
        _ => 0.0,
    };
    let in_pieces = (driver::PARALLEL_SUBTREES * parallel::threads()) as f64;
    let building = building + (growing + boxes) * (in_pieces / n as f64).min(1.0);

    let share = f64::from(options.reinsertion_share);
    let improving = match options.improves() {
        false => 0.0,
        true => {
            // Parents of pairs, heights, and in turn: areas; candidates and moves; the copy.
            let linked = tree + 3.0 * nodes;
            let searching = nodes * (1.0 + share * (4.0 + 24.0 + 24.0));
            linked + (8.0 * nodes).max(searching).max(tree)
        }
    };
    PerPrimitive { peak: building.max(improving), structure: MOST_NODES * NODE + NUMBER }
}

/// A wide tree, made from a binary one.
fn wide(n: usize, options: &BuildOptions) -> PerPrimitive {
    if wide::linear::is_asked_for(options) {
        return linear(n, options);
    }
    let options = wide::binary_options(options);
    let (builder, max_leaf_size) = (options.wide_builder, options.max_leaf_size);
    let PerPrimitive { mut peak, .. } = binary(builder, n, &options);
    // Where triangles are cut there may be so many references for each, whose boxes are there until all pieces are put together.
    let references = match options.cuts_triangles() {
        true => 1.0 + f64::from(options.spatial_splits),
        false => 1.0,
    };
    if references > 1.0 {
        peak += BOX;
    }
    let nodes = usual_nodes(builder, max_leaf_size);
    let structure = wide_structure(builder, max_leaf_size);
    let (tree, plan) = (NODE * nodes + NUMBER, 20.0 * nodes);
    let mut peak = references * peak.max(tree + plan + structure);
    if references > 1.0 {
        // With the tree of cut triangles there, one of whole ones is built.
        let whole = BuildOptions { spatial_splits: 0.0, ..options };
        peak = peak.max(references * (tree + plan) + binary(builder, n, &whole).peak);
    }
    PerPrimitive { peak, structure: references * structure }
}

/// A wide tree, made along the curve.
fn linear(n: usize, options: &BuildOptions) -> PerPrimitive {
    let leaves = 0.5 * usual_nodes(Builder::Lbvh, options.wide_leaf_size);
    let structure = wide_structure(Builder::Lbvh, options.wide_leaf_size);
    // Where leaves start, and their boxes; for every few of them a branch, and room for a node that may not be needed.
    let tree = leaves * (NUMBER + BOX) + leaves / 8.0 * (40.0 + 448.0);
    // Each thread reads the corners of a piece, three of four numbers.
    let in_pieces = (driver::PARALLEL_SUBTREES * parallel::threads()) as f64;
    let corners = 48.0 * (in_pieces / n as f64).min(1.0);
    let peak = (2.0 * KEY).max(KEY + tree + corners + structure);
    PerPrimitive { peak, structure }
}

/// How much a wide tree takes for each primitive.
fn wide_structure(builder: Builder, max_leaf_size: usize) -> f64 {
    // Blocks of eight are not full where primitives lie far apart.
    match builder {
        _ if max_leaf_size < 4 => 92.0,
        Builder::Lbvh if max_leaf_size >= 8 => 72.0,
        _ => 88.0,
    }
}

/// A grid of `density` cells a primitive and eight references at most.
fn uniform_grid(density: f64) -> PerPrimitive {
    // Boxes and their blocks of cells, numbers, sets of cells; references; counts, starts and ends of cells.
    let lists = 24.0 + 12.0 + NUMBER + 8.0;
    let references = 8.0 * NUMBER;
    PerPrimitive {
        peak: lists + references + 12.5 * density,
        structure: references + 4.2 * density,
    }
}

/// Grids in the crowded cells of a coarse one.
fn nested_grid(density: f64) -> PerPrimitive {
    PerPrimitive { peak: 115.0 + 5.0 * density, structure: 40.0 + 6.0 * density }
}

/// An octree whose leaves hold so many primitives.
fn octree(leaf_size: f64) -> PerPrimitive {
    PerPrimitive { peak: 110.0 + 400.0 / leaf_size, structure: 20.0 + 200.0 / leaf_size }
}
