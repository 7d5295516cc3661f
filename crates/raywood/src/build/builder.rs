//! The builders of binary trees, by name.

use super::driver;
use super::hlbvh;
use super::lbvh;
use super::median::Median;
use super::midpoint::Midpoint;
use super::reinsertion;
use super::sah_binned::BinnedSah;
use super::sah_sweep::SweepSah;
use super::spatial;
use crate::{BuildError, BuildOptions, Bvh2, Geometry};

/// How a binary tree is built: the same kind of tree, of different quality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Builder {
    /// Split in the middle of the node's longest axis.
    Midpoint,
    /// Halve by number of primitives along the axis of largest spread.
    Median,
    /// Try every split by the surface area heuristic.
    SahSweep,
    /// Try the splits between a few bins by the surface area heuristic: nearly as good, much faster.
    #[default]
    SahBinned,
    /// Sort along a space-filling curve and split where the curve turns: the fastest to build, the slowest to trace.
    Lbvh,
    /// Groups of neighbours along the curve become leaves, and what is above them is built as by `SahBinned`: much of the speed of the one, most of the quality of
    /// the other.
    Hlbvh,
}

impl Bvh2 {
    /// Builds the tree with the given builder, in parallel in the caller's rayon pool, and improves it by reinsertion if the options ask for it; the
    /// same tree for any number of threads.
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build_by<G: Geometry>(
        builder: Builder,
        geometry: &G,
        options: &BuildOptions,
    ) -> Result<Self, BuildError> {
        let primitives = || driver::primitives(geometry);
        let tree = match builder {
            Builder::Midpoint => driver::build(primitives()?, &Midpoint::new(options)),
            Builder::Median => driver::build(primitives()?, &Median::new(options)),
            Builder::SahSweep => driver::build(primitives()?, &SweepSah::new(options)),
            Builder::SahBinned => driver::build(primitives()?, &BinnedSah::new(options)),
            Builder::Lbvh => lbvh::build(geometry, options)?,
            Builder::Hlbvh => hlbvh::build(geometry, options)?,
        };
        Ok(reinsertion::optimize(tree, options))
    }

    /// As [`build_by`](Self::build_by) with the builder from which the wide tree is made and, if the options ask for it, with triangles cut: some primitives may
    /// then lie in several leaves, whose boxes are around parts of them.
    pub(crate) fn build_for_wide<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
    ) -> Result<Self, BuildError> {
        if options.wide_builder == Builder::SahBinned && options.clamped().spatial_splits > 0.0 {
            return Ok(reinsertion::optimize(spatial::build(geometry, options)?, options));
        }
        Self::build_by(options.wide_builder, geometry, options)
    }
}
