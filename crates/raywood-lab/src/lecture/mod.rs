//! The lecture on accelerating ray tracing, its claims as experiments: each says what is claimed, how it is measured, what comes out,
//! and judges by these numbers alone whether the claim holds on this machine and these scenes.
//!
//! To add an experiment, write a file with a `pub(super) const ENTRY` and name it in [`EXPERIMENTS`].

mod coherence;
mod duplication;
mod fit;
mod frame;
mod growth;
mod lab;
mod measure;
mod nodes;
mod resolution;
mod sah;
mod shapes;
#[cfg(test)]
mod tests;

use raywood::BuildError;
use raywood_render::{CameraError, PrepareError};

use crate::figures::{Chart, Table};
pub use lab::Lab;
pub use shapes::default_scenes;

/// All experiments, in the order in which the lecture comes to them.
pub const EXPERIMENTS: &[Entry] = &[
    growth::ENTRY,
    resolution::ENTRY,
    duplication::ENTRY,
    nodes::ENTRY,
    sah::ENTRY,
    coherence::ENTRY,
    frame::ENTRY,
];

/// An experiment that can be run.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// What it is asked for by: one word.
    pub id: &'static str,
    /// What it is about, in a few words.
    pub title: &'static str,
    /// What the lecture says.
    pub claim: &'static str,
    measure: fn(&Lab<'_>) -> Result<Findings, LectureError>,
}

impl Entry {
    /// Runs the experiment: seconds to a minute. On the calling thread and, where more are used, in the caller's rayon pool.
    ///
    /// # Errors
    ///
    /// A structure cannot be built, or a scene has nothing in it that could be measured.
    pub fn run(&self, lab: &Lab<'_>) -> Result<Experiment, LectureError> {
        let Findings { method, tables, charts, verdict } = (self.measure)(lab)?;
        let Self { id, title, claim, .. } = *self;
        Ok(Experiment { id, title, claim, method, tables, charts, verdict })
    }
}

/// An experiment that was run.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// What it is asked for by.
    pub id: &'static str,
    /// What it is about, in a few words.
    pub title: &'static str,
    /// What the lecture says.
    pub claim: &'static str,
    /// What was measured, and how.
    pub method: String,
    /// The measured values.
    pub tables: Vec<Table>,
    /// The same to look at.
    pub charts: Vec<Chart>,
    /// Whether the claim holds.
    pub verdict: Verdict,
}

/// What an experiment finds.
struct Findings {
    method: String,
    tables: Vec<Table>,
    charts: Vec<Chart>,
    verdict: Verdict,
}

/// Whether a claim holds, and by which numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The judgement.
    pub judgement: Judgement,
    /// The numbers that it follows from, in one or two sentences.
    pub explanation: String,
}

/// How a claim fares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judgement {
    /// As claimed.
    Holds,
    /// Some of it, or not everywhere.
    HoldsInPart,
    /// Not on this machine and these scenes.
    Fails,
    /// There was nothing to measure, as where the eye sees nothing.
    NotMeasured,
}

impl Judgement {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsInPart => "holds in part",
            Self::Fails => "does not hold here",
            Self::NotMeasured => "could not be measured",
        }
    }

    /// By how many of some conditions are met.
    fn by_conditions(met: &[bool]) -> Self {
        match met.iter().filter(|met| **met).count() {
            _ if met.is_empty() => Self::NotMeasured,
            0 => Self::Fails,
            all if all == met.len() => Self::Holds,
            _ => Self::HoldsInPart,
        }
    }
}

/// Why an experiment cannot be run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LectureError {
    /// A scene without triangles and spheres.
    EmptyScene {
        /// What it is called.
        scene: String,
    },
    /// A structure cannot be built.
    Build(BuildError),
    /// A scene cannot be made ready for rays.
    Prepare(PrepareError),
    /// Nothing can be seen through a scene's camera.
    Camera(CameraError),
}

impl std::fmt::Display for LectureError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::EmptyScene { scene } => {
                write!(
                    f,
                    "{scene}: has no triangles and no spheres, so there is nothing to measure"
                )
            }
            Self::Build(error) => error.fmt(f),
            Self::Prepare(error) => error.fmt(f),
            Self::Camera(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for LectureError {}

impl From<BuildError> for LectureError {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}

impl From<PrepareError> for LectureError {
    fn from(error: PrepareError) -> Self {
        Self::Prepare(error)
    }
}

impl From<CameraError> for LectureError {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}
