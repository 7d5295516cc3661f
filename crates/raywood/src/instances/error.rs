//! Why a scene of instances cannot be built.

use std::fmt;

use super::TransformError;
use crate::{Aabb, BuildError};

/// Why a scene of instances cannot be built.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InstanceError {
    /// A transform is NaN, infinite or has no inverse.
    BadTransform {
        /// The first such instance.
        instance: usize,
        /// What is wrong with it.
        error: TransformError,
    },
    /// An instance reaches beyond the largest number.
    BadBounds {
        /// The first such instance.
        instance: usize,
        /// The box around it.
        bounds: Aabb,
    },
    /// More instances than there are numbers, those of instanced scenes counted.
    TooManyInstances {
        /// How many there are.
        instances: usize,
    },
    /// The tree over the instances cannot be built for another reason.
    Build(BuildError),
}

impl fmt::Display for InstanceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadTransform { instance, error } => {
                write!(f, "the transform of instance {instance} {error}")
            }
            Self::BadBounds { instance, bounds: Aabb { min, max } } => write!(
                f,
                "instance {instance} has the bounds {:?} to {:?}: they must be finite",
                min.to_array(),
                max.to_array()
            ),
            Self::TooManyInstances { instances } => {
                write!(
                    f,
                    "{instances} instances, but a scene takes at most {}",
                    Self::MAX_INSTANCES
                )
            }
            Self::Build(error) => write!(f, "the tree over the instances: {error}"),
        }
    }
}

impl InstanceError {
    /// The most instances of a scene, those of instanced scenes counted.
    pub const MAX_INSTANCES: usize = crate::structures::wide::top::MAX_ENTRIES;
}

impl std::error::Error for InstanceError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::BadTransform { error, .. } => Some(error),
            Self::Build(error) => Some(error),
            _ => None,
        }
    }
}
