//! The axis-aligned box as a region.

use super::Region;
use super::private::{Prepare, Touch};
use crate::geometry::{TriangleBlock, triangle_overlaps};
use crate::simd::Simd;
use crate::structures::wide::search::{Planes, boxes_touching, lanes};
use crate::{Aabb, Geometry};

/// What touches a box are the triangles with a point in it, within `2^-48` of the largest coordinate, and of other primitives those that [say so](Geometry::overlaps).
/// The box may reach to infinity; if it is empty or has NaN nothing touches it.
impl Region for Aabb {}

impl Prepare for Aabb {
    fn prepare(&self, _: f32) -> Option<impl Touch> {
        // Finite, so that no child that is not there touches it.
        self.as_region()
    }
}

impl Touch for Aabb {
    #[inline(always)]
    fn boxes<S: Simd>(&self, simd: S, planes: &Planes) -> u32 {
        boxes_touching(simd, planes, self)
    }

    #[inline(always)]
    fn triangles<S: Simd>(&self, _: S, block: &TriangleBlock, chosen: u32) -> u32 {
        let mut touching = 0;
        for lane in lanes(chosen) {
            touching |= u32::from(triangle_overlaps(block.corners(lane), self)) << lane;
        }
        touching
    }

    fn primitive<G: Geometry>(&self, geometry: &G, primitive: u32) -> bool {
        geometry.overlaps(primitive, self)
    }
}
