//! Why a tree cannot take on other places of its primitives.

use std::fmt;

use crate::Aabb;

/// Why a tree cannot take on other places of its primitives. It stays as it was.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RefitError {
    /// The geometry has more or fewer primitives than the tree.
    PrimitiveCount {
        /// How many the tree has.
        tree: usize,
        /// How many the geometry has.
        geometry: usize,
    },
    /// A primitive has a box that is empty, NaN or infinite.
    BadBounds {
        /// The first such primitive.
        primitive: u32,
        /// Its box.
        bounds: Aabb,
    },
    /// Two references lead to one place in memory: of trees that were loaded from forged files.
    NotATree {
        /// The number of the cache line.
        line: usize,
    },
}

impl fmt::Display for RefitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PrimitiveCount { tree, geometry } => {
                write!(
                    f,
                    "a tree over {tree} primitives cannot take on the places of {geometry}; build it anew"
                )
            }
            Self::BadBounds { primitive, bounds: Aabb { min, max } } => write!(
                f,
                "primitive {primitive} has the bounds {:?} to {:?}: they must be finite and not empty",
                min.to_array(),
                max.to_array()
            ),
            Self::NotATree { line } => {
                write!(
                    f,
                    "more than one reference leads to cache line {line} of the tree: it was damaged when it was saved or loaded"
                )
            }
        }
    }
}

impl std::error::Error for RefitError {}
