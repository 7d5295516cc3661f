//! Where rays enter the wide tree. Its kernels are large, and the geometry is asked by them only about what is no triangle or is in doubt: so they take it as a trait object,
//! and these functions, which no type is a parameter of, are compiled once in the library instead of again for every geometry in every crate.

use super::source::{FromPoint, Source, Towards};
use super::{WideBvh, batch, single, sink::Sink};
use crate::simd::dispatch_on;
use crate::{Geometry, Hit, HitColumnsMut, Probe, Ray, TriangleTest};

impl WideBvh {
    /// The closest hit of a ray.
    pub(crate) fn closest_hit(&self, geometry: &dyn Geometry, ray: &Ray) -> Option<Hit> {
        self.probed_closest_hit(geometry, ray, &mut ())
    }

    /// Whether a ray hits anything.
    pub(crate) fn any_hit(&self, geometry: &dyn Geometry, ray: &Ray) -> bool {
        self.probed_any_hit(geometry, ray, &mut ())
    }

    /// The closest hit of a ray, unless it lies beyond `limit`: then it, another or none.
    pub(crate) fn intersect_within(
        &self,
        geometry: &dyn Geometry,
        ray: &Ray,
        limit: f32,
    ) -> Option<Hit> {
        match self.triangle_test {
            TriangleTest::Watertight => dispatch_on(
                self.level,
                single::ClosestWithin::<false> { tree: self, geometry, ray, limit },
            ),
            TriangleTest::Fast => dispatch_on(
                self.level,
                single::ClosestWithin::<true> { tree: self, geometry, ray, limit },
            ),
        }
    }

    /// The closest hits of many rays.
    pub(super) fn closest_hits(
        &self,
        geometry: &dyn Geometry,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
    ) {
        self.closest_of_batch(geometry, rays, hits);
    }

    /// The closest hits of rays from one point.
    pub(super) fn closest_hits_from(
        &self,
        geometry: &dyn Geometry,
        rays: FromPoint<'_>,
        hits: HitColumnsMut<'_>,
    ) {
        self.closest_of_batch(geometry, rays, hits);
    }

    /// Whether anything blocks each of many rays.
    pub(super) fn any_hits(&self, geometry: &dyn Geometry, rays: &[Ray], occluded: &mut [bool]) {
        self.any_of_batch(geometry, rays, occluded);
    }

    /// Whether anything blocks each of many rays towards one point.
    pub(super) fn any_hits_towards(
        &self,
        geometry: &dyn Geometry,
        rays: Towards<'_>,
        occluded: &mut [bool],
    ) {
        self.any_of_batch(geometry, rays, occluded);
    }

    /// The closest hit of a ray. The probe is told what is tested.
    pub(super) fn probed_closest_hit<P: Probe>(
        &self,
        geometry: &dyn Geometry,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        match self.triangle_test {
            TriangleTest::Watertight => dispatch_on(
                self.level,
                single::Closest::<_, false> { tree: self, geometry, ray, probe },
            ),
            TriangleTest::Fast => dispatch_on(
                self.level,
                single::Closest::<_, true> { tree: self, geometry, ray, probe },
            ),
        }
    }

    /// Whether a ray hits anything. The probe is told what is tested.
    pub(super) fn probed_any_hit<P: Probe>(
        &self,
        geometry: &dyn Geometry,
        ray: &Ray,
        probe: &mut P,
    ) -> bool {
        match self.triangle_test {
            TriangleTest::Watertight => dispatch_on(
                self.level,
                single::Any::<_, false> { tree: self, geometry, ray, probe },
            ),
            TriangleTest::Fast => {
                dispatch_on(self.level, single::Any::<_, true> { tree: self, geometry, ray, probe })
            }
        }
    }

    fn closest_of_batch<R: Source, H: Sink>(&self, geometry: &dyn Geometry, rays: R, hits: H) {
        match self.triangle_test {
            TriangleTest::Watertight => dispatch_on(
                self.level,
                batch::Closest::<_, _, false> { tree: self, geometry, rays, hits },
            ),
            TriangleTest::Fast => dispatch_on(
                self.level,
                batch::Closest::<_, _, true> { tree: self, geometry, rays, hits },
            ),
        }
    }

    fn any_of_batch<R: Source>(&self, geometry: &dyn Geometry, rays: R, occluded: &mut [bool]) {
        match self.triangle_test {
            TriangleTest::Watertight => dispatch_on(
                self.level,
                batch::Any::<_, false> { tree: self, geometry, rays, occluded },
            ),
            TriangleTest::Fast => dispatch_on(
                self.level,
                batch::Any::<_, true> { tree: self, geometry, rays, occluded },
            ),
        }
    }
}
