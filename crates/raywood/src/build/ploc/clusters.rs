//! Clusters along the curve.

use crate::build::{Cancelled, PackedAabb, Work};
use crate::{Geometry, parallel};

/// Some primitives: the box around them and, in the lanes of the box that mean nothing, what the cluster is and how many primitives it has.
#[derive(Clone, Copy)]
pub(super) struct Cluster(PackedAabb);

/// What a cluster is: a primitive, by its place on the curve, or one of the merges, which count on from there.
pub(super) type Id = u32;

impl Cluster {
    pub(super) const NONE: Self = Self(PackedAabb::EMPTY);

    #[inline(always)]
    pub(super) fn new(bounds: PackedAabb, id: Id, size: u32) -> Self {
        Self(bounds.with_tags([id, size]))
    }

    /// The box around it.
    #[inline(always)]
    pub(super) fn bounds(&self) -> &PackedAabb {
        &self.0
    }

    /// What it is.
    #[inline(always)]
    pub(super) fn id(&self) -> Id {
        self.0.tags()[0]
    }

    /// How many primitives it has.
    #[inline(always)]
    pub(super) fn size(&self) -> u32 {
        self.0.tags()[1]
    }
}

/// Each primitive as a cluster, in the order of the curve.
pub(super) fn clusters_of_primitives<G: Geometry>(
    geometry: &G,
    order: &[u32],
    work: Work<'_>,
) -> Result<Vec<Cluster>, Cancelled> {
    parallel::map_watched(order.len(), work, |place| {
        let bounds = geometry.bounds(order[place]);
        Cluster::new(bounds.into(), place as Id, 1)
    })
}
