//! Two kinds of geometry as one.

use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::{Aabb, Hit, Ray, Vec3};

/// Two geometries under one numbering: first all primitives of `first`, then all of `second`.
///
/// One structure over both finds the closest hit among them, and which kind a primitive is costs one comparison.
/// For more than two, or kinds that are not known before the program runs, there is [`Assembly`](super::Assembly).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Joined<A, B> {
    /// The geometry whose primitives come first.
    pub first: A,
    /// The geometry whose primitives are numbered on from those of `first`.
    pub second: B,
}

impl<A: Geometry, B: Geometry> Joined<A, B> {
    /// The primitive's number within the second geometry, or `None` if it is one of the first.
    #[inline]
    fn in_second(&self, primitive: u32) -> Option<u32> {
        primitive.checked_sub(self.first.len() as u32)
    }
}

impl<A: Geometry, B: Geometry> Geometry for Joined<A, B> {
    fn len(&self) -> usize {
        self.first.len() + self.second.len()
    }

    #[inline]
    fn bounds(&self, primitive: u32) -> Aabb {
        match self.in_second(primitive) {
            None => self.first.bounds(primitive),
            Some(primitive) => self.second.bounds(primitive),
        }
    }

    fn has_sound_bounds(&self) -> bool {
        self.first.has_sound_bounds() && self.second.has_sound_bounds()
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        match self.in_second(primitive) {
            None => self.first.clipped_bounds(primitive, cell),
            Some(primitive) => self.second.clipped_bounds(primitive, cell),
        }
    }

    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        match self.in_second(primitive) {
            None => self.first.triangle(primitive),
            Some(primitive) => self.second.triangle(primitive),
        }
    }

    fn prefetch(&self, primitive: u32) {
        match self.in_second(primitive) {
            None => self.first.prefetch(primitive),
            Some(primitive) => self.second.prefetch(primitive),
        }
    }

    fn prefetch_rest(&self, primitive: u32) {
        match self.in_second(primitive) {
            None => self.first.prefetch_rest(primitive),
            Some(primitive) => self.second.prefetch_rest(primitive),
        }
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        match self.in_second(primitive) {
            None => self.first.bounding_ball(primitive),
            Some(primitive) => self.second.bounding_ball(primitive),
        }
    }

    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        match self.in_second(primitive) {
            None => self.first.overlaps(primitive, cell),
            Some(primitive) => self.second.overlaps(primitive, cell),
        }
    }

    #[inline(always)]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        match self.in_second(primitive) {
            None => self.first.intersect(primitive, ray),
            Some(primitive) => self.second.intersect(primitive, ray),
        }
    }

    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        match self.in_second(primitive) {
            None => self.first.closest_point(primitive, point),
            Some(primitive) => self.second.closest_point(primitive, point),
        }
    }

    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        match self.in_second(primitive) {
            None => self.first.winding_number(primitive, point),
            Some(primitive) => self.second.winding_number(primitive, point),
        }
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        match self.in_second(primitive) {
            None => self.first.intersect_all(primitive, ray, found),
            Some(primitive) => self.second.intersect_all(primitive, ray, found),
        }
    }

    fn mask(&self, primitive: u32) -> u32 {
        match self.in_second(primitive) {
            None => self.first.mask(primitive),
            Some(primitive) => self.second.mask(primitive),
        }
    }

    #[inline(always)]
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self.in_second(hit.primitive) {
            None => self.first.surface_point(ray, hit),
            Some(primitive) => self.second.surface_point(ray, &Hit { primitive, ..*hit }),
        }
    }
}
