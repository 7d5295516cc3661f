//! How much larger the boxes around parts of triangles are than these parts.
//!
//! Whether a ray hits a triangle, and where, is known up to rounding, and it is the triangle's own box that decides in the end which hits count. But the ray must meet the box of
//! one of the parts wherever it is said to hit. At the distance that is told of a hit the ray is inside the triangle's own box; how far it may be from the triangle itself follows
//! from the triangle test (`docs/numerics.md`):
//!
//! - The distance may be wrong by `2^-13` of itself. So intervals along rays count as longer by [`DISTANCE_ERROR`].
//! - Vertices are moved by some eight roundings of their distance from the ray's origin: a ray beside an edge is taken for one inside, and at a grazing angle the ray meets the
//!   triangle's plane so much farther from the edge. With `2^-15` of the distance angles down to a sixty-fourth are covered. So much larger are the boxes of parts, but
//!   not beyond the triangle's own box, as far as rays do not start farther from the tree's centre than seven times half its size. For rays from farther away all boxes count as larger.
//!
//! These margins are ample, not a proof, as those of `traverse/margins.rs` are.

use crate::{Aabb, Vec3};

/// The margin per distance of the ray's origin from the farthest corner.
pub(crate) const PER_DISTANCE: f32 = 1.0 / (1 << 15) as f32;

/// By how much of themselves intervals along rays are longer, and depths: twice the error of a hit.
pub(crate) const DISTANCE_ERROR: f32 = 1.0 / (1 << 12) as f32;

/// How far from the tree's centre rays usually start at most, by half its size; along any axis.
pub(crate) const USUAL_DISTANCE: f32 = 7.0;

/// By which share of the largest coordinate boxes are larger in any case: for points that are computed on a triangle.
const ROUNDING: f32 = 16.0 * 0.5 * f32::EPSILON;

/// The middle of a box, and how far it reaches from there along any axis.
pub(crate) fn center_and_half(bounds: &Aabb) -> (Vec3, f32) {
    let center = bounds.center();
    (center, (bounds.max - center).max(center - bounds.min).max_element())
}

/// The margin of parts in a tree of which this is the box.
pub(crate) fn margin(bounds: &Aabb) -> f32 {
    let (_, half) = center_and_half(bounds);
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    PER_DISTANCE * (USUAL_DISTANCE + 1.0) * half + ROUNDING * largest
}
