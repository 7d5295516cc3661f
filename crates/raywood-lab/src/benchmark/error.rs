//! Why there is no benchmark.

use std::fmt;

use raywood_render::{CameraError, PrepareError, RenderError};

use crate::Mismatch;

/// Why there is no benchmark.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BenchmarkError {
    /// The reference to hold answers against cannot be built.
    Build(PrepareError),
    /// Nothing can be seen through the camera.
    Camera(CameraError),
    /// The picture cannot be rendered.
    Render(RenderError),
    /// The system has no more threads.
    Threads {
        /// How many were wanted.
        threads: usize,
    },
    /// Answers differ, which they must never do.
    Mismatch(Box<Mismatch>),
    /// Pictures differ, which they must never do.
    Picture {
        /// On how many threads.
        threads: [usize; 2],
    },
}

impl fmt::Display for BenchmarkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build(error) => error.fmt(f),
            Self::Camera(error) => error.fmt(f),
            Self::Render(error) => error.fmt(f),
            Self::Threads { threads } => write!(f, "cannot start {threads} threads"),
            Self::Mismatch(mismatch) => mismatch.fmt(f),
            Self::Picture { threads: [a, b] } => {
                write!(f, "the pictures rendered on {a} and on {b} threads differ")
            }
        }
    }
}

impl std::error::Error for BenchmarkError {}

impl From<Box<Mismatch>> for BenchmarkError {
    fn from(mismatch: Box<Mismatch>) -> Self {
        Self::Mismatch(mismatch)
    }
}
