//! The ball as a region.

use super::Region;
use super::private::{Prepare, Touch};
use crate::geometry::{Frame, TriangleBlock, closest_on_triangle};
use crate::simd::{Float, Simd};
use crate::structures::wide::search::{Planes, lanes};
use crate::{Geometry, Vec3};

/// All points no further from a centre than a radius, as a [`Region`].
///
/// What touches it are the primitives whose [closest point](crate::Bvh::closest_point) is no further away, as that distance is told. The
/// radius may be zero or infinite; with one that is negative or NaN, or a centre that is not finite, the ball is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The centre.
    pub center: Vec3,
    /// The radius.
    pub radius: f32,
}

impl Ball {
    /// The ball with the given centre and radius.
    #[inline]
    pub fn new(center: impl Into<[f32; 3]>, radius: f32) -> Self {
        Self { center: Vec3::from(center.into()), radius }
    }
}

impl Region for Ball {}

impl Prepare for Ball {
    fn prepare(&self, reach: f32) -> Option<impl Touch> {
        (self.center.is_finite() && self.radius >= 0.0).then(|| {
            let frame = Frame::new(self.center, reach);
            let outside = frame.square(self.radius);
            Prepared { ball: *self, frame, inside: outside * (1.0 - 16.0 * f32::EPSILON), outside }
        })
    }
}

/// A ball among the boxes of a tree.
struct Prepared {
    ball: Ball,
    frame: Frame,
    /// What is certainly no further away than this, as a square in scaled coordinates, touches the ball.
    inside: f32,
    /// What is certainly further away than this does not.
    outside: f32,
}

impl Prepared {
    fn touches(&self, distance: f32) -> bool {
        distance <= self.ball.radius
    }
}

impl Touch for Prepared {
    #[inline(always)]
    fn boxes<S: Simd>(&self, simd: S, planes: &Planes) -> u32 {
        self.frame.boxes(simd, planes).less_or_equal(simd.splat16(self.outside))
    }

    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, block: &TriangleBlock, chosen: u32) -> u32 {
        let (lower, upper) = block.squared_distances(simd, &self.frame);
        let inside = chosen & upper.less_or_equal(simd.splat8(self.inside));
        let possible = chosen & lower.less_or_equal(simd.splat8(self.outside));
        let mut touching = inside;
        for lane in lanes(possible & !inside) {
            let closest = closest_on_triangle(self.ball.center, block.corners(lane));
            touching |= u32::from(self.touches(closest.distance)) << lane;
        }
        touching
    }

    fn primitive<G: Geometry>(&self, geometry: &G, primitive: u32) -> bool {
        let closest = geometry.closest_point(primitive, self.ball.center);
        closest.is_some_and(|closest| self.touches(closest.distance))
    }
}
