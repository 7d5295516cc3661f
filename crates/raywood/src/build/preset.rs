//! Builds by name, from the fastest to the one with the best tree.

use super::{BuildOptions, Builder};

/// A point of the trade between the time to build a bounding volume hierarchy and the time to trace through it. What each chooses stands in
/// [`options`](Self::options); grids, octree and kD-tree are the same by all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum BuildPreset {
    /// The wide tree straight from the order along a space-filling curve: for scenes that change with every picture.
    Fastest,
    /// From a binary tree along the curve, all nodes improved by rotations and the largest by reinsertion.
    Fast,
    /// The default: neighbours merged from the bottom up.
    #[default]
    Balanced,
    /// The same, the largest nodes improved as long as it pays.
    High,
    /// From the top down by the surface area heuristic, a third of the nodes improved as long as it pays, and large triangles cut if that pays: for scenes that are traced for
    /// long.
    Best,
}

impl BuildPreset {
    /// All presets, the fastest build first.
    pub const ALL: &[Self] = &[Self::Fastest, Self::Fast, Self::Balanced, Self::High, Self::Best];

    /// Its name, as command lines have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fastest => "fastest",
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::High => "high",
            Self::Best => "best",
        }
    }

    /// The preset of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|preset| preset.name() == name)
    }

    /// What it chooses. `balanced` is [`BuildOptions::default`]; each of the others differs from it as told here, and all else may be changed:
    ///
    /// | preset | `wide_builder` | `wide_leaf_size` | `bins` | `rotation_passes` | `reinsertion_passes` | `reinsertion_share` | `reinsertion_gain` | `spatial_splits` |
    /// | --- | --- | ---: | ---: | ---: | --- | ---: | ---: | ---: |
    /// | `fastest` | `Lbvh` | 8 | | | none | | | |
    /// | `fast` | `Lbvh` | 8 | | 1 | up to 2 | 0.05 | 0.005 | |
    /// | `balanced` | `Ploc` | 8 | | | none; up to 4 for scenes of instances | 0.05 | 0.005 | |
    /// | `high` | `Ploc` | 8 | | | up to 6 | 0.05 | 0.005 | |
    /// | `best` | `SahBinned` | 8 | 32 | | up to 20 | 0.3 | 0.001 | 0.3 |
    pub fn options(self) -> BuildOptions {
        let balanced = BuildOptions::default();
        match self {
            Self::Fastest => BuildOptions {
                wide_builder: Builder::Lbvh,
                reinsertion_passes: Some(0),
                ..balanced
            },
            Self::Fast => BuildOptions {
                wide_builder: Builder::Lbvh,
                rotation_passes: 1,
                reinsertion_passes: Some(2),
                ..balanced
            },
            Self::Balanced => balanced,
            Self::High => BuildOptions { reinsertion_passes: Some(6), ..balanced },
            Self::Best => BuildOptions {
                wide_builder: Builder::SahBinned,
                bins: 32,
                reinsertion_passes: Some(20),
                reinsertion_share: 0.3,
                reinsertion_gain: 0.001,
                spatial_splits: 0.3,
                ..balanced
            },
        }
    }
}
