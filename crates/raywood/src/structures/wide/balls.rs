//! Primitives that are no triangles: which rays pass by the balls around them, and need not ask the primitives themselves.
//!
//! What is left out here would not be hit: how far a ray passes by a centre is known up to a few roundings of its distance, and balls are made larger by that.

use crate::PreparedRay;
use crate::Vec3;
use crate::geometry::TriangleBlock;
use crate::simd::{Float, Simd};

/// A distance from a line is off by no more than so many roundings of that from the line's origin.
pub(super) const ROUNDINGS: f32 = 32.0;

/// Squares below this may have lost digits to underflow.
pub(super) const LEAST_SQUARE: f32 = f32::MIN_POSITIVE;

/// Directions of another squared length may come too near to overflow or underflow.
const SQUARED_LENGTHS: std::ops::Range<f32> = 1e-12..1e12;

/// Which of the balls in the given lanes of a block the line of a ray may meet.
#[inline(always)]
pub(super) fn balls_met<S: Simd>(
    simd: S,
    block: &TriangleBlock,
    lanes: u32,
    ray: &PreparedRay,
) -> u32 {
    let Vec3 { x: dx, y: dy, z: dz } = ray.direction;
    let squared_length = dx * dx + dy * dy + dz * dz;
    if !SQUARED_LENGTHS.contains(&squared_length) {
        return lanes;
    }
    let (dx, dy, dz) = (simd.splat8(dx), simd.splat8(dy), simd.splat8(dz));
    let x = simd.load8(block.coordinates(0, 0)) - simd.splat8(ray.origin.x);
    let y = simd.load8(block.coordinates(0, 1)) - simd.splat8(ray.origin.y);
    let z = simd.load8(block.coordinates(0, 2)) - simd.splat8(ray.origin.z);
    let radius = simd.load8(block.coordinates(1, 0));

    // From the point of the line that is closest to the centre.
    let along = (x * dx + y * dy + z * dz) * simd.splat8(1.0 / squared_length);
    let (by_x, by_y, by_z) = (x - along * dx, y - along * dy, z - along * dz);
    let squared = by_x * by_x + by_y * by_y + by_z * by_z;
    let distance = x.abs() + y.abs() + z.abs();
    let reach = radius + distance * simd.splat8(ROUNDINGS * f32::EPSILON);
    lanes & !(reach * reach + simd.splat8(LEAST_SQUARE)).less(squared)
}
