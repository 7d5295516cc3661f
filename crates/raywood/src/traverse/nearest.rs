//! Testing primitives, as every traversal of every structure does it.

use super::slab::inside_own_bounds;
use crate::{Geometry, Hit, PreparedRay, PrimitiveHit};

/// The hit of a ray with one primitive; depends on nothing else.
#[inline]
pub(crate) fn hit<G: Geometry + ?Sized>(
    geometry: &G,
    ray: &PreparedRay,
    primitive: u32,
) -> Option<PrimitiveHit> {
    inside_own_bounds(ray, geometry.intersect(primitive, ray)?, &geometry.bounds(primitive))
}

/// Whether a primitive blocks a ray.
#[inline]
pub(crate) fn blocks<G: Geometry + ?Sized>(
    geometry: &G,
    ray: &PreparedRay,
    primitive: u32,
) -> bool {
    hit(geometry, ray, primitive).is_some()
}

/// The closest hit so far: the least distance, and of equal ones the lowest primitive number.
#[derive(Clone, Copy)]
pub(crate) struct Nearest {
    best: Option<Hit>,
    t_max: f32,
}

impl Nearest {
    /// Nothing found yet.
    #[inline]
    pub(crate) fn new(ray: &PreparedRay) -> Self {
        Self { best: None, t_max: ray.t_max }
    }

    /// Nothing found yet, and nothing of interest beyond `limit`: it need not be found. Hits are the same as without, for the ray's own interval decides of them.
    #[inline]
    pub(crate) fn within(ray: &PreparedRay, limit: f32) -> Self {
        Self { best: None, t_max: if limit < ray.t_max { limit } else { ray.t_max } }
    }

    /// Tests a primitive. Testing it twice changes nothing.
    #[inline]
    pub(crate) fn test<G: Geometry + ?Sized>(
        &mut self,
        geometry: &G,
        ray: &PreparedRay,
        primitive: u32,
    ) {
        if let Some(hit) = hit(geometry, ray, primitive) {
            self.offer(primitive, hit);
        }
    }

    /// Takes a hit if it is nearer, or equally near with a lower number.
    #[inline]
    pub(crate) fn offer(&mut self, primitive: u32, hit: PrimitiveHit) {
        if self.is_beaten_by(primitive, hit.t) {
            self.take(Hit { t: hit.t, u: hit.u, v: hit.v, primitive, instance: 0 });
        }
    }

    /// Whether a hit would be nearer, or equally near with a lower number.
    #[inline(always)]
    pub(crate) fn is_beaten_by(&self, primitive: u32, t: f32) -> bool {
        self.best.is_none_or(|best| t < best.t || (t == best.t && primitive < best.primitive))
    }

    /// Takes a hit that is nearer than all before.
    #[inline(always)]
    pub(crate) fn take(&mut self, hit: Hit) {
        self.best = Some(hit);
        self.t_max = hit.t;
    }

    /// Whether there is a hit.
    #[inline(always)]
    pub(crate) fn found(&self) -> bool {
        self.best.is_some()
    }

    /// Where looking further is of no use: the ray's end, later the closest hit so far. What begins exactly there may still
    /// hold an equally near hit of a lower number.
    #[inline]
    pub(crate) fn t_max(&self) -> f32 {
        self.t_max
    }

    /// Notes that something blocks the ray, no matter what.
    #[inline]
    pub(crate) fn block(&mut self) {
        self.t_max = f32::NEG_INFINITY;
    }

    /// Whether it was noted that something blocks the ray.
    #[inline]
    pub(crate) fn is_blocked(&self) -> bool {
        self.t_max == f32::NEG_INFINITY
    }

    /// The closest hit of all that was tested.
    #[inline]
    pub(crate) fn into_hit(self) -> Option<Hit> {
        self.best
    }
}
