//! What a ray on its way through the tree is and has found: in single precision, or in double.
//!
//! Kernels that take rays through the tree are generic over this. They hold boxes against rays in single precision either way; what differs is how the
//! primitives of a leaf are tested, and what the closest hit is.

use super::WideBvh;
use super::node::Reference;
use super::slabs::Slabs;
use super::step::{any_blocks, leaf_hits, take_closest};
use crate::geometry::BlockHits;
use crate::simd::Simd;
use crate::traverse::nearest::Nearest;
use crate::{Geometry, Hit, PreparedRay, Ray};

/// A ray that looks for hits.
pub(super) trait RaySearch {
    /// What it looks in, beside the tree.
    type Scene<'a>: Copy;
    /// What it starts from.
    type Ray;
    /// What vectors say of a leaf.
    type LeafHits;
    /// The closest hit.
    type Hit;

    /// Of no leaf.
    const NO_HITS: Self::LeafHits;

    /// Whether the ray and the tree are rounded from double precision.
    const IS_ROUNDED: bool;

    /// Whether a ray is valid.
    fn is_valid<S: Simd>(simd: S, ray: &Self::Ray) -> bool;

    /// A search that found nothing yet. The ray is valid.
    fn new<S: Simd>(simd: S, scene: Self::Scene<'_>, ray: &Self::Ray) -> Self;

    /// The ray in single precision.
    fn single(&self) -> &PreparedRay;

    /// How far beside their places a point of that and one of the tree may lie, where [rounded](Self::IS_ROUNDED).
    fn displacement(&self) -> f32 {
        0.0
    }

    /// Where looking further is of no use: the ray's end, later the closest hit so far.
    fn t_max(&self) -> f32;

    /// What vectors say of the primitives of a leaf.
    fn test_leaf<S: Simd>(&self, simd: S, tree: &WideBvh, leaf: Reference) -> Self::LeafHits;

    /// Whether that may be a hit.
    fn may_hit(hits: &Self::LeafHits) -> bool;

    /// Asks for the memory of what may be hit, some time before it is [looked at](Self::take_closest): in two steps, where the second place follows from what stands
    /// at the first.
    #[inline(always)]
    fn prefetch<const SECOND: bool>(
        &self,
        _tree: &WideBvh,
        _scene: Self::Scene<'_>,
        _leaf: Reference,
        _hits: &Self::LeafHits,
    ) {
    }

    /// Takes the closest hit of a leaf, and tells whether there was one closer than all before.
    fn take_closest<S: Simd>(
        &mut self,
        simd: S,
        tree: &WideBvh,
        scene: Self::Scene<'_>,
        leaf: Reference,
        hits: &Self::LeafHits,
    ) -> bool;

    /// Whether any primitive of a leaf blocks the ray.
    fn is_blocked_by<S: Simd>(
        &self,
        simd: S,
        tree: &WideBvh,
        scene: Self::Scene<'_>,
        leaf: Reference,
        hits: &Self::LeafHits,
    ) -> bool;

    /// Notes that something blocks the ray, no matter what.
    fn block(&mut self);

    /// Whether that was noted.
    fn is_blocked(&self) -> bool;

    /// The closest hit of all that was tested.
    fn hit(&self, scene: Self::Scene<'_>) -> Option<Self::Hit>;
}

/// A ray as boxes are tested against it.
#[inline(always)]
pub(super) fn slabs<Q: RaySearch>(search: &Q, tree: &WideBvh) -> Slabs {
    let slabs = tree.slabs(search.single());
    if Q::IS_ROUNDED { slabs.around(search.displacement()) } else { slabs }
}

/// A search in single precision.
#[repr(C)]
pub(super) struct InSingle<const FAST: bool> {
    nearest: Nearest,
    ray: PreparedRay,
}

impl<const FAST: bool> InSingle<FAST> {
    /// One whose ray is prepared, and that may have a limit.
    #[inline(always)]
    pub(super) fn of(ray: PreparedRay, nearest: Nearest) -> Self {
        Self { nearest, ray }
    }
}

impl<const FAST: bool> RaySearch for InSingle<FAST> {
    type Scene<'a> = &'a dyn Geometry;
    type Ray = Ray;
    type LeafHits = BlockHits;
    type Hit = Hit;

    const NO_HITS: BlockHits = BlockHits::NONE;
    const IS_ROUNDED: bool = false;

    #[inline(always)]
    fn is_valid<S: Simd>(simd: S, ray: &Ray) -> bool {
        PreparedRay::is_valid(simd, ray)
    }

    #[inline(always)]
    fn new<S: Simd>(simd: S, _: &dyn Geometry, ray: &Ray) -> Self {
        let ray = PreparedRay::of_valid(simd, ray);
        Self::of(ray, Nearest::new(&ray))
    }

    #[inline(always)]
    fn single(&self) -> &PreparedRay {
        &self.ray
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.nearest.t_max()
    }

    #[inline(always)]
    fn test_leaf<S: Simd>(&self, simd: S, tree: &WideBvh, leaf: Reference) -> BlockHits {
        leaf_hits::<S, FAST>(simd, tree, leaf, &self.ray, self.nearest.t_max())
    }

    #[inline(always)]
    fn may_hit(hits: &BlockHits) -> bool {
        hits.hit | hits.doubtful != 0
    }

    #[inline(always)]
    fn take_closest<S: Simd>(
        &mut self,
        simd: S,
        tree: &WideBvh,
        geometry: &dyn Geometry,
        leaf: Reference,
        hits: &BlockHits,
    ) -> bool {
        take_closest::<S, FAST>(simd, tree, geometry, leaf, hits, &self.ray, &mut self.nearest)
    }

    #[inline(always)]
    fn is_blocked_by<S: Simd>(
        &self,
        simd: S,
        tree: &WideBvh,
        geometry: &dyn Geometry,
        leaf: Reference,
        hits: &BlockHits,
    ) -> bool {
        any_blocks::<S, FAST>(simd, tree, geometry, leaf, hits, &self.ray)
    }

    #[inline(always)]
    fn block(&mut self) {
        self.nearest.block();
    }

    #[inline(always)]
    fn is_blocked(&self) -> bool {
        self.nearest.is_blocked()
    }

    #[inline(always)]
    fn hit(&self, _: &dyn Geometry) -> Option<Hit> {
        self.nearest.into_hit()
    }
}
