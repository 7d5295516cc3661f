//! By how much a walk through divided space is wider than the ray: for structures whose leaves hold only what reaches into their cells.
//!
//! There the ray must visit one of the cells that a primitive's surface reaches, although the triangle test moves vertices by a few
//! roundings of their distance from the ray's origin, and may have the distance of a hit wrong by `2^-13` of itself
//! (`docs/numerics.md`). Three margins see to that:
//!
//! - Every plane is a slab as thick as 64 roundings of the largest distance between the origin and a point of the structure's box, 32
//!   to each side. A ray inside that slab is on both sides. This is more than the eight roundings by which the slab test lengthens
//!   its interval, and more than the vertices can move.
//! - The interval in which cells are visited is longer than the ray's by `2^-12` of the distance, twice the error of a hit.
//! - And by 64 of the first margins along the ray, as a ray that meets a surface at a grazing angle may pass it that much earlier.
//!
//! Both ends are moved so, and the closest hit so far when deciding whether a cell lies beyond it. These margins are ample, not a proof: a
//! triangle seen all but edge-on can have a distance that is off by more. Millions of rays at such triangles found none that is missed.

use crate::{Aabb, PreparedRay};

/// Half the thickness of a plane per unit of distance from the origin: 32 roundings.
const THICKNESS: f32 = 1.0 / (1 << 19) as f32;

/// The error of a hit's distance, relative to itself; twice what the triangle test allows.
const DISTANCE_ERROR: f32 = 1.0 / (1 << 12) as f32;

/// How far along the ray, in half thicknesses of planes, a hit at a grazing angle may be from its cell.
const GRAZING: f32 = 64.0;

/// The margins of one ray in one structure.
#[derive(Clone, Copy)]
pub(crate) struct Margins {
    /// Half the thickness of planes, with the sign of the direction on each axis.
    pub(crate) planes: [f32; 3],
    /// How much earlier than computed a hit may be met, beside its relative error.
    reach: f32,
}

impl Margins {
    /// The margins of a ray in a structure with the given box.
    #[inline]
    pub(crate) fn new(bounds: &Aabb, ray: &PreparedRay) -> Self {
        let Aabb { min, max } = *bounds;
        let distance = (min - ray.origin).abs().max((max - ray.origin).abs()).max_element();
        let margin = THICKNESS * distance;
        let planes = ray.reciprocal.to_array().map(|r| margin.copysign(r));
        Self { planes, reach: GRAZING * margin / ray.direction.abs().max_element() }
    }

    /// Where cells begin that cannot hold a hit at or before `t`.
    #[inline]
    pub(crate) fn limit(&self, t: f32) -> f32 {
        t + (t.abs() * DISTANCE_ERROR + self.reach)
    }
}
