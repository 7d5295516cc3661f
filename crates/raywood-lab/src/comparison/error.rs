//! Why there is no comparison.

use std::fmt;

use raywood::{BuildError, StructureKind};
use raywood_render::CameraError;

use crate::Mismatch;

/// Why there is no comparison.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CompareError {
    /// A structure cannot be built.
    Build(StructureKind, BuildError),
    /// Nothing can be seen through the camera.
    Camera(CameraError),
    /// Structures disagree, which they must never do.
    Mismatch(Box<Mismatch>),
}

impl fmt::Display for CompareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build(kind, error) => write!(f, "{}: {error}", kind.name()),
            Self::Camera(error) => error.fmt(f),
            Self::Mismatch(mismatch) => mismatch.fmt(f),
        }
    }
}

impl std::error::Error for CompareError {}
