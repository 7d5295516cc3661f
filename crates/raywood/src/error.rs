//! Errors of building and checking structures.

use std::fmt;

use crate::Aabb;

/// Why a structure cannot be built over a geometry.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// More than [`BuildError::MAX_PRIMITIVES`] primitives.
    TooManyPrimitives {
        /// How many there are.
        primitives: usize,
    },
    /// A primitive has a box that is empty, NaN or infinite.
    BadBounds {
        /// The first such primitive.
        primitive: u32,
        /// Its box.
        bounds: Aabb,
    },
    /// Who watched the build asked to stop.
    Cancelled,
    /// The build may take more memory than [`BuildOptions::memory_limit`](crate::BuildOptions::memory_limit).
    MemoryLimit {
        /// How many bytes it may take: see [`BuildMemory`](crate::BuildMemory).
        needed: usize,
        /// How many it is allowed.
        limit: usize,
    },
}

impl BuildError {
    /// The most primitives that a structure takes: with 2N-1 nodes, 32 bits still number every node.
    pub const MAX_PRIMITIVES: usize = 1 << 31;
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyPrimitives { primitives } => {
                write!(
                    f,
                    "{primitives} primitives, but a structure takes at most {}",
                    Self::MAX_PRIMITIVES
                )
            }
            Self::BadBounds { primitive, bounds: Aabb { min, max } } => write!(
                f,
                "primitive {primitive} has the bounds {:?} to {:?}: they must be finite and not empty",
                min.to_array(),
                max.to_array()
            ),
            Self::MemoryLimit { needed, limit } => {
                write!(
                    f,
                    "the build may take {needed} bytes of memory, more than the {limit} that it is allowed"
                )
            }
            Self::Cancelled => f.write_str("the build was cancelled"),
        }
    }
}

impl std::error::Error for BuildError {}
