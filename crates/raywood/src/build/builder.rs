//! The builders of binary trees, by name.

use std::ops::ControlFlow;

use super::driver;
use super::hlbvh;
use super::lbvh;
use super::median::Median;
use super::midpoint::Midpoint;
use super::ploc;
use super::reinsertion;
use super::sah_binned::BinnedSah;
use super::sah_sweep::SweepSah;
use super::spatial;
use super::{BuildMemory, Work, watched};
use crate::{BuildError, BuildOptions, Bvh2, Geometry, StructureKind};

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
    /// From the bottom up: neighbours along the curve whose common box is smallest are merged, again and again. Trees about as good as those of `SahBinned`, in less time.
    Ploc,
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
        Self::build_in(builder, geometry, options, Work::UNWATCHED)
    }

    /// As [`build_by`](Self::build_by), watched: see [`Bvh::build_watched`](crate::Bvh::build_watched).
    ///
    /// # Errors
    ///
    /// As [`build_by`](Self::build_by), and [`BuildError::Cancelled`].
    pub fn build_watched<G: Geometry>(
        builder: Builder,
        geometry: &G,
        options: &BuildOptions,
        watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    ) -> Result<Self, BuildError> {
        watched(watcher, |work| Self::build_in(builder, geometry, options, work))
    }

    /// Builds the tree as a part of some work.
    pub(crate) fn build_in<G: Geometry>(
        builder: Builder,
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        BuildMemory::check(builder.structure(), geometry.len(), options)?;
        let [building, improving] = work.shares([builder.cost(), reinsertion::cost(options)]);
        let tree = match builder {
            Builder::Midpoint => driver::build(geometry, &Midpoint::new(options), building)?,
            Builder::Median => driver::build(geometry, &Median::new(options), building)?,
            Builder::SahSweep => driver::build(geometry, &SweepSah::new(options), building)?,
            Builder::SahBinned => driver::build(geometry, &BinnedSah::new(options), building)?,
            Builder::Lbvh => lbvh::build(geometry, options, building)?,
            Builder::Hlbvh => hlbvh::build(geometry, options, building)?,
            Builder::Ploc => ploc::build(geometry, options, building)?,
        };
        Ok(reinsertion::optimize(tree, options, improving)?)
    }

    /// As [`build_in`](Self::build_in) with the builder from which the wide tree is made and, if the options ask for it, with triangles cut: some primitives may
    /// then lie in several leaves, whose boxes are around parts of them.
    pub(crate) fn build_for_wide<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        if !options.cuts_triangles() {
            return Self::build_in(options.wide_builder, geometry, options, work);
        }
        let [building, improving] = work.shares([spatial::COST, reinsertion::cost(options)]);
        let tree = spatial::build(geometry, options, building)?;
        Ok(reinsertion::optimize(tree, options, improving)?)
    }

    /// About how long [`build_for_wide`](Self::build_for_wide) takes, in units in which reinsertion links the nodes of the tree in one.
    pub(crate) fn cost_for_wide(options: &BuildOptions) -> f64 {
        let building = match options.cuts_triangles() {
            true => spatial::COST,
            false => options.wide_builder.cost(),
        };
        building + reinsertion::cost(options)
    }
}

impl Builder {
    /// The structure that it makes.
    fn structure(self) -> StructureKind {
        match self {
            Self::Midpoint => StructureKind::BvhMidpoint,
            Self::Median => StructureKind::BvhMedian,
            Self::SahSweep => StructureKind::BvhSahSweep,
            Self::SahBinned => StructureKind::BvhSahBinned,
            Self::Lbvh => StructureKind::BvhLbvh,
            Self::Hlbvh => StructureKind::BvhHlbvh,
            Self::Ploc => StructureKind::BvhPloc,
        }
    }

    /// About how long it takes, in the units of [`Bvh2::cost_for_wide`].
    fn cost(self) -> f64 {
        match self {
            Self::Midpoint => 40.0,
            Self::Median => 80.0,
            Self::SahSweep => 1500.0,
            Self::SahBinned => 160.0,
            Self::Lbvh => 36.0,
            Self::Hlbvh => 105.0,
            Self::Ploc => 80.0,
        }
    }
}
