//! Structures compared on the same rays of the same scene, in the same run.

mod error;
mod run;

use raywood::{BuildOptions, Counts, StructureKind, StructureStats};

use crate::{RayKind, RaySetSummary, Timing};
pub use error::CompareError;
pub use run::{SceneStructure, compare};

/// What is compared, and how thoroughly.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// The structures.
    pub kinds: Vec<StructureKind>,
    /// How they are built.
    pub build: BuildOptions,
    /// The most rays of each kind.
    pub rays: usize,
    /// How often each set of rays is traced by each structure, at least once.
    pub rounds: usize,
    /// The picture's width over its height, for primary rays.
    pub aspect: f32,
}

impl Default for CompareOptions {
    /// All structures, built as by default, 65,536 rays of each kind, seven rounds.
    fn default() -> Self {
        Self {
            kinds: StructureKind::ALL.to_vec(),
            build: BuildOptions::default(),
            rays: 1 << 16,
            rounds: 7,
            aspect: 1.6,
        }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Primitives of the scene.
    pub primitives: usize,
    /// How many threads built and traced.
    pub threads: usize,
    /// The sets of rays.
    pub ray_sets: Vec<RaySetSummary>,
    /// The structures, in the order asked for.
    pub structures: Vec<StructureReport>,
}

/// A structure in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct StructureReport {
    /// What structure it is.
    pub kind: StructureKind,
    /// How long building it took.
    pub build: Timing,
    /// What it is like.
    pub stats: StructureStats,
    /// How it traced each set of rays.
    pub traces: Vec<Traces>,
}

/// How a structure traced a set of rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Traces {
    /// What rays they are.
    pub kind: RayKind,
    /// How many of the set it traced: all, or a sample if it is slow.
    pub rays: usize,
    /// What it visited and tested for all these together.
    pub counts: Counts,
    /// How long tracing these took, on all threads.
    pub timing: Timing,
}

impl Traces {
    /// Million rays a second; 0 if there were no rays.
    pub fn million_rays_per_second(&self) -> f64 {
        let seconds = self.timing.median();
        if seconds > 0.0 { 1e-6 * self.rays as f64 / seconds } else { 0.0 }
    }

    /// A number of the counts as a mean over the rays; 0 if there were none.
    pub fn per_ray(&self, count: u64) -> f64 {
        count as f64 / self.rays.max(1) as f64
    }
}
