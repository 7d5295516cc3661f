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
    /// A wide tree larger than its references reach, which is [`BuildError::MAX_TREE_BYTES`].
    TreeTooLarge {
        /// How large it would be.
        bytes: usize,
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

    /// The most memory that the nodes and leaves of a wide tree take, about 4 GiB: 26 bits number their cache lines. Enough for some 75 million triangles.
    pub const MAX_TREE_BYTES: usize = 64 * ((1 << 26) - 1);
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TreeTooLarge { bytes } => write!(
                f,
                "the wide tree would take {bytes} bytes, but it can have at most {}; divide the geometry among several trees in a scene of instances, \
                 or choose another structure",
                Self::MAX_TREE_BYTES
            ),
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
