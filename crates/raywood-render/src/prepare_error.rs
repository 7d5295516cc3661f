//! Why a scene cannot be made ready for rays.

use std::fmt;

use raywood::{BuildError, InstanceError, StructureKind};

/// Why a scene cannot be made ready for rays.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PrepareError {
    /// A structure cannot be built, or its build was stopped.
    Build(BuildError),
    /// The tree over instances cannot be built.
    Instances(InstanceError),
    /// Instances are traced by [`StructureKind::BvhWide`] alone; others need [all triangles](raywood_scene::Scene::flatten).
    Kind {
        /// The kind that was asked for.
        kind: StructureKind,
        /// How many triangles the scene shows.
        visible: u64,
    },
}

impl fmt::Display for PrepareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build(error) => error.fmt(f),
            Self::Instances(error) => error.fmt(f),
            Self::Kind { kind, visible } => {
                let (name, wide) = (kind.name(), StructureKind::BvhWide.name());
                write!(
                    f,
                    "a {name} knows no instances, which show {visible} triangles: expected {wide}"
                )
            }
        }
    }
}

impl std::error::Error for PrepareError {}

impl From<BuildError> for PrepareError {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}

impl From<InstanceError> for PrepareError {
    fn from(error: InstanceError) -> Self {
        Self::Instances(error)
    }
}
