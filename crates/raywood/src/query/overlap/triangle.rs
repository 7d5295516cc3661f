//! The triangle as a region.

use super::Region;
use super::private::{Prepare, Touch};
use crate::geometry::{TriangleBlock, triangle_overlaps, triangles_touch};
use crate::simd::Simd;
use crate::structures::wide::search::{Planes, boxes_touching, lanes};
use crate::{Aabb, Geometry, Vec3};

/// A triangle by its corners. What touches it are the triangles that have a point in common with it, within `2^-40` of the largest coordinate, and of other primitives
/// those that, as far as boxes around both tell, may. If a corner is not finite nothing touches it.
impl Region for [Vec3; 3] {}

impl Prepare for [Vec3; 3] {
    fn prepare(&self, _: f32) -> Option<impl Touch> {
        let bounds = Aabb::of_points(*self);
        let is_finite = self.iter().all(|corner| corner.is_finite());
        is_finite.then_some(Prepared { corners: *self, bounds })
    }
}

/// A triangle and its box.
struct Prepared {
    corners: [Vec3; 3],
    bounds: Aabb,
}

impl Touch for Prepared {
    #[inline(always)]
    fn boxes<S: Simd>(&self, simd: S, planes: &Planes) -> u32 {
        boxes_touching(simd, planes, &self.bounds)
    }

    #[inline(always)]
    fn triangles<S: Simd>(&self, _: S, block: &TriangleBlock, chosen: u32) -> u32 {
        let mut touching = 0;
        for lane in lanes(chosen) {
            touching |= u32::from(triangles_touch(self.corners, block.corners(lane))) << lane;
        }
        touching
    }

    fn primitive<G: Geometry>(&self, geometry: &G, primitive: u32) -> bool {
        triangle_overlaps(self.corners, &geometry.bounds(primitive))
            && geometry.overlaps(primitive, &self.bounds)
    }
}
