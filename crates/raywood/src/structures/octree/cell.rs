//! The cells of an octree: how one is divided, and which octants a primitive belongs to.

use crate::{Aabb, Geometry, Vec3};

/// The octants on the lower side of each axis, as a set of bits: octant `o` lies on the upper side of axis `a` if bit `a` of `o` is set.
const LOWER: [u8; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];

/// The point at which a cell is divided. On an axis too short for a number between its ends it is the upper end: the lower
/// octants have it all, and the upper ones stay empty.
#[inline]
pub(super) fn middle(cell: &Aabb) -> Vec3 {
    let (center, max) = (cell.center().to_array(), cell.max.to_array());
    let min = cell.min.to_array();
    Vec3::from([0, 1, 2].map(|axis| {
        let divides = min[axis] < center[axis] && center[axis] < max[axis];
        if divides { center[axis] } else { max[axis] }
    }))
}

/// One of the eight octants of a cell that is divided at `middle`.
#[inline]
pub(super) fn octant(cell: &Aabb, middle: Vec3, number: usize) -> Aabb {
    let (min, mid, max) = (cell.min.to_array(), middle.to_array(), cell.max.to_array());
    let upper = |axis: usize| number >> axis & 1 == 1;
    Aabb {
        min: Vec3::from([0, 1, 2].map(|axis| if upper(axis) { mid[axis] } else { min[axis] })),
        max: Vec3::from([0, 1, 2].map(|axis| if upper(axis) { max[axis] } else { mid[axis] })),
    }
}

/// Decides to which octants primitives belong.
///
/// The rule finds every hit, to the last bit. A hit's distance lies in the interval that the slab test gives for the primitive's
/// own bounds. At each division follow the half that the bounds lie in, or, if they lie in both, the half in which the slab test
/// sees the hit's distance. Distances to planes are monotone in the planes, so the distance stays in the slab interval of every cell on
/// this way, and the way ends in a leaf that refers to the primitive: the ray visits it before any hit further away can end the search.
///
/// The same argument holds where bounds only touch the dividing plane, so one half is then enough.
pub(super) struct Placement<'a, G> {
    geometry: &'a G,
    /// By how much a cell is widened before a geometry is asked what part of a primitive lies in it.
    margin: f32,
}

/// The margin per length of the root's longest edge: eight times what the slab test's roundings and slack (20 units of 2^-24
/// of the distance, `docs/numerics.md`) amount to for a ray that starts within an edge's length of the root.
const MARGIN: f32 = 160.0 / (1 << 24) as f32;

impl<'a, G: Geometry> Placement<'a, G> {
    /// The rule for a geometry within the root's cell.
    pub(super) fn new(geometry: &'a G, root: &Aabb) -> Self {
        Self { geometry, margin: MARGIN * root.extent().max_element() }
    }

    /// The octants of `cell`, to which the primitive belongs, that it belongs to as well: one bit each.
    #[inline]
    pub(super) fn octants(&self, primitive: u32, bounds: &Aabb, cell: &Aabb, middle: Vec3) -> u8 {
        let mut octants = u8::MAX;
        for (axis, lower) in LOWER.into_iter().enumerate() {
            let in_upper = bounds.max[axis] > middle[axis];
            let in_lower = bounds.min[axis] < middle[axis] || !in_upper;
            octants &= if in_lower { lower } else { 0 } | if in_upper { !lower } else { 0 };
        }
        match octants.is_power_of_two() {
            true => octants,
            false => self.really_overlapped(octants, primitive, cell, middle),
        }
    }

    /// Those of the given octants that the primitive itself overlaps, not only its bounds.
    fn really_overlapped(&self, octants: u8, primitive: u32, cell: &Aabb, middle: Vec3) -> u8 {
        let margin = Vec3::splat(self.margin);
        (0..8)
            .filter(|number| octants >> number & 1 == 1)
            .filter(|&number| {
                let Aabb { min, max } = octant(cell, middle, number);
                let widened = Aabb { min: min - margin, max: max + margin };
                !self.geometry.clipped_bounds(primitive, &widened).is_empty()
            })
            .fold(0, |set, number| set | 1 << number)
    }
}
