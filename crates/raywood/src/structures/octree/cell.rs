//! The cells of an octree: how one is divided, and which octants a primitive belongs to.

use crate::minmax::larger;
use crate::{Aabb, Geometry, Vec3};

/// The octants on the lower side of each axis, as a set of bits: octant `o` lies on the upper side of axis `a` if bit `a` of `o` is set.
const LOWER: [u8; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];

/// The point at which a cell is divided. On an axis that is at most half as long as the longest, or too short for a number between its
/// ends, it is the upper end: the lower octants have it all, and the upper ones stay empty.
///
/// So cells become and stay nearly cubes whatever the shape of the scene. Were each axis divided every time, the cells of a wide and flat
/// scene would be flat as well, and each of its small things in hundreds of them.
#[inline]
pub(super) fn middle(cell: &Aabb) -> Vec3 {
    let half = 0.5 * cell.max - 0.5 * cell.min;
    let shortest = 0.5 * larger(half.x, larger(half.y, half.z));
    let center = cell.center();
    // Written out: the compiler makes calls of closures here.
    let divide = |half: f32, min: f32, center: f32, max: f32| {
        if half > shortest && min < center && center < max { center } else { max }
    };
    Vec3::new(
        divide(half.x, cell.min.x, center.x, cell.max.x),
        divide(half.y, cell.min.y, center.y, cell.max.y),
        divide(half.z, cell.min.z, center.z, cell.max.z),
    )
}

/// One of the eight octants of a cell that is divided at `middle`.
#[inline]
pub(super) fn octant(cell: &Aabb, middle: Vec3, number: usize) -> Aabb {
    let Aabb { mut min, mut max } = *cell;
    let lower = |axis: usize| number >> axis & 1 == 0;
    *(if lower(0) { &mut max.x } else { &mut min.x }) = middle.x;
    *(if lower(1) { &mut max.y } else { &mut min.y }) = middle.y;
    *(if lower(2) { &mut max.z } else { &mut min.z }) = middle.z;
    Aabb { min, max }
}

/// Decides to which octants primitives belong: to those that they overlap themselves, not only with their bounds.
///
/// What only touches the dividing plane belongs to one half, which is enough: a ray that near the plane visits both.
pub(super) struct Placement<'a, G> {
    geometry: &'a G,
}

impl<'a, G: Geometry> Placement<'a, G> {
    /// The rule for a geometry.
    pub(super) fn new(geometry: &'a G) -> Self {
        Self { geometry }
    }

    /// The octants of `cell`, to which the primitive belongs, that it belongs to as well: one bit each.
    #[inline]
    pub(super) fn octants(&self, primitive: u32, bounds: &Aabb, cell: &Aabb, middle: Vec3) -> u8 {
        let mut octants = u8::MAX;
        let mut within = true;
        for (axis, lower) in LOWER.into_iter().enumerate() {
            let in_upper = bounds.max[axis] > middle[axis];
            let in_lower = bounds.min[axis] < middle[axis] || !in_upper;
            octants &= if in_lower { lower } else { 0 } | if in_upper { !lower } else { 0 };
            let inside = cell.min[axis] <= bounds.min[axis] && bounds.max[axis] <= cell.max[axis];
            within &= inside || (in_lower && in_upper);
        }
        // What crosses one plane, inside the cell on the other axes, lies on both sides of it.
        match octants.count_ones() {
            1 => octants,
            2 if within => octants,
            _ => self.really_overlapped(octants, primitive, cell, middle),
        }
    }

    /// Those of the given octants that the primitive itself overlaps.
    fn really_overlapped(&self, octants: u8, primitive: u32, cell: &Aabb, middle: Vec3) -> u8 {
        (0..8)
            .filter(|number| octants >> number & 1 == 1)
            .filter(|&number| self.geometry.overlaps(primitive, &octant(cell, middle, number)))
            .fold(0, |set, number| set | 1 << number)
    }
}
