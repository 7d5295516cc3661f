//! What is decided about a tree whose primitives moved.

use std::fmt;

use crate::BuildOptions;

/// When a [`DynamicBvh`](crate::DynamicBvh) is only given new boxes, when parts of it are built anew, and when all of it.
#[derive(Clone, Debug, PartialEq)]
pub struct UpdateOptions {
    /// How trees are built.
    pub build: BuildOptions,
    /// How many times as high the expected cost [`Q`](crate::StructureStats::q) of the tree may be as when it was built, at least 1. Rays take longer about in proportion. What is
    /// beyond is repaired or built anew.
    pub max_growth: f64,
    /// How many primitives may be in what is repaired until the whole tree is built anew, all repairs since the last build together, as a share of all: 0 to 1.
    pub max_repair_share: f64,
}

impl Default for UpdateOptions {
    fn default() -> Self {
        Self { build: BuildOptions::default(), max_growth: 1.3, max_repair_share: 0.5 }
    }
}

/// What was decided about a tree whose primitives moved, and what it costs: the expected cost [`Q`](crate::StructureStats::q) of a ray through it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Update {
    /// What was done.
    pub decision: Decision,
    /// The measure of growth from now on: what the tree cost when it was last built, of parts that were repaired since then what they cost then.
    pub built_cost: f64,
    /// What it cost with new boxes alone; where primitives came or went, for which there are none, infinity.
    pub refitted_cost: f64,
    /// What it costs now.
    pub cost: f64,
}

/// What was done with a tree whose primitives moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Decision {
    /// It has new boxes.
    Refitted,
    /// It has new boxes, and instead of the subtrees that had become worst, or that had primitives which are gone, a new one, with those that have come.
    Repaired {
        /// How many subtrees these were.
        subtrees: usize,
        /// How many primitives there are in them.
        primitives: usize,
    },
    /// All of it is built anew.
    Rebuilt,
}

impl fmt::Display for Update {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.decision {
            Decision::Refitted => write!(f, "refitted")?,
            Decision::Repaired { subtrees, primitives } => {
                write!(f, "repaired, {subtrees} subtrees of {primitives} primitives")?;
            }
            Decision::Rebuilt => write!(f, "rebuilt")?,
        }
        write!(f, ": Q {:.1}", self.cost)?;
        if self.decision != Decision::Refitted && self.refitted_cost.is_finite() {
            write!(f, " instead of {:.1}", self.refitted_cost)?;
        }
        Ok(())
    }
}
