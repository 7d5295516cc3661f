//! Why there is no comparison: above all, structures that disagree.

use std::fmt;

use raywood::{BuildError, Hit, Ray, StructureKind};
use raywood_render::CameraError;

use crate::RayKind;

/// Two structures that disagree about a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// What ray it is.
    pub kind: RayKind,
    /// The ray.
    pub ray: Ray,
    /// The structures.
    pub structures: [StructureKind; 2],
    /// What they say.
    pub answers: [Answer; 2],
}

/// What a structure says of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The closest hit, if any.
    Closest(Option<Hit>),
    /// Whether there is any hit.
    Any(bool),
}

impl Answer {
    /// Whether the ray hits.
    pub fn hits(&self) -> bool {
        match self {
            Self::Closest(hit) => hit.is_some(),
            Self::Any(blocked) => *blocked,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Closest(Some(Hit { t, u, v, primitive, .. })) => {
                write!(f, "hits primitive {primitive} at t = {t:?}, u = {u:?}, v = {v:?}")
            }
            Self::Any(true) => write!(f, "hits something"),
            Self::Closest(None) | Self::Any(false) => write!(f, "hits nothing"),
        }
    }
}

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

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, ray, structures: [a, b], answers: [x, y] } = self;
        let (o, d) = (ray.origin, ray.direction);
        write!(
            f,
            "structures disagree about a {} ray: {} {x}, {} {y}",
            kind.name(),
            a.name(),
            b.name()
        )?;
        write!(f, "; the ray starts at ({:?}, {:?}, {:?})", o.x, o.y, o.z)?;
        write!(f, " along ({:?}, {:?}, {:?})", d.x, d.y, d.z)?;
        write!(f, ", {:?} <= t < {:?}", ray.t_min, ray.t_max)
    }
}

impl std::error::Error for CompareError {}
