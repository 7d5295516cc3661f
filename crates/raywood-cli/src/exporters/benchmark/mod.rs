//! `raywood bench`: one structure on all instructions and cores of the machine.

mod contents;
mod csv;
mod json;

use raywood_lab::{Benchmark, RaySetSummary, RaySpeed, Speed};
use serde_json::Value;

use super::{Contents, Export};

/// A benchmark and what it was made of.
pub(crate) struct Benched<'a> {
    /// The scene's name.
    pub(crate) scene: &'a str,
    /// How long building the structure took, in seconds, and on how many threads.
    pub(crate) build: (f64, usize),
    /// What was found.
    pub(crate) benchmark: &'a Benchmark,
}

impl Export for Benched<'_> {
    fn contents(&self) -> Contents {
        contents::contents(self)
    }

    fn csv(&self) -> String {
        csv::write(self.benchmark)
    }

    fn json(&self) -> Value {
        json::write(self)
    }
}

/// What lines that are about pictures are called, where others have the kind of rays.
const PICTURE: &str = "picture";

/// What the structure's instructions are called.
fn level_name(benchmark: &Benchmark) -> &'static str {
    benchmark.level.map_or("scalar", |level| level.name())
}

/// The set that rays were taken of.
fn set_of<'a>(benchmark: &'a Benchmark, rays: &RaySpeed) -> Option<&'a RaySetSummary> {
    benchmark.ray_sets.iter().find(|set| set.kind == rays.kind)
}

fn nanoseconds(speed: &Speed) -> f64 {
    1e9 * speed.seconds_per_ray()
}

fn million_rays_per_second(speed: &Speed) -> f64 {
    1e-6 * speed.rays_per_second()
}
