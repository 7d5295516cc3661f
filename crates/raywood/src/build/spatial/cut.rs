//! Cutting references at a plane: a reference is a primitive with a box around the part of it that is meant.

use super::super::{PackedAabb, Primitive};
use crate::geometry::round_down;
use crate::{Aabb, Geometry, Vec3};

/// The error of a point between two corners per unit of their largest coordinate: four roundings in double precision, where three are made.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A plane across an axis.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) place: f32,
}

/// On which side of a plane something lies.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    Left,
    Right,
    Both,
}

impl Plane {
    /// On which side a box lies. One that only touches the plane is on one side of it.
    #[inline(always)]
    pub(super) fn side_of(&self, bounds: &PackedAabb) -> Side {
        if bounds.max()[self.axis] <= self.place {
            Side::Left
        } else if bounds.min()[self.axis] >= self.place {
            Side::Right
        } else {
            Side::Both
        }
    }

    /// The boxes around what lies to the left and to the right of the plane of the part of a triangle in `bounds`, which the plane crosses. Either may be
    /// [empty](PackedAabb::is_empty).
    ///
    /// Together they hold all of the triangle that `bounds` holds. The triangle as a whole is cut, and its halves are brought into `bounds`: looser than
    /// to cut the part again, and much faster.
    pub(super) fn cut(&self, corners: [Vec3; 3], bounds: &PackedAabb) -> [PackedAabb; 2] {
        let bounds = Aabb::from(*bounds);
        let (mut end, mut start) = (bounds.max.to_array(), bounds.min.to_array());
        end[self.axis] = self.place;
        start[self.axis] = self.place;
        let [left, right] = self.halves(corners);
        let left = left.intersection(&Aabb { max: end.into(), ..bounds });
        let right = right.intersection(&Aabb { min: start.into(), ..bounds });
        [left, right].map(|part| if part.is_empty() { PackedAabb::EMPTY } else { part.into() })
    }

    /// The boxes around both halves of a triangle: around its corners on that side and the points where edges cross the plane.
    fn halves(&self, corners: [Vec3; 3]) -> [Aabb; 2] {
        let mut halves = [Aabb::EMPTY; 2];
        for (number, corner) in corners.into_iter().enumerate() {
            if corner[self.axis] <= self.place {
                halves[0] = halves[0].including(corner);
            }
            if corner[self.axis] >= self.place {
                halves[1] = halves[1].including(corner);
            }
            if let Some([low, high]) = self.crossing(corner, corners[(number + 1) % 3]) {
                halves = halves.map(|half| half.including(low).including(high));
            }
        }
        halves
    }

    /// Where an edge between two corners crosses the plane, if these lie on different sides: the corners of a box around that point.
    fn crossing(&self, one: Vec3, other: Vec3) -> Option<[Vec3; 2]> {
        // Always from the left end, so that both triangles at an edge are given the same point.
        let (a, b) = if one[self.axis] < other[self.axis] { (one, other) } else { (other, one) };
        if !(a[self.axis] < self.place && self.place < b[self.axis]) {
            return None;
        }
        let [a, b] = [a, b].map(|corner| corner.to_array().map(f64::from));
        let axis = self.axis;
        let share = (f64::from(self.place) - a[axis]) / (b[axis] - a[axis]);
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let x = a[axis] + share * (b[axis] - a[axis]);
            let error = ROUNDING * a[axis].abs().max(b[axis].abs());
            (low[axis], high[axis]) = (round_down(x - error), -round_down(-(x + error)));
        }
        Some([low.into(), high.into()])
    }
}

/// The part of a triangle that a reference means, cut at a plane; `None` if the primitive is no triangle, which is never cut.
#[inline]
pub(super) fn cut<G: Geometry>(
    geometry: &G,
    plane: Plane,
    reference: &Primitive,
) -> Option<[PackedAabb; 2]> {
    let corners = geometry.triangle(reference.number())?;
    Some(plane.cut(corners, reference.bounds()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_hold_every_point_of_the_triangle() {
        let corners = [
            Vec3::new(-1.0, 0.25, 3.0),
            Vec3::new(2.0, -0.7, 1.0 / 3.0),
            Vec3::new(0.1, 5.0, -2.0),
        ];
        let bounds = Aabb::of_points(corners);
        for axis in 0..3 {
            for step in 1..20 {
                let share = step as f32 / 20.0;
                let place = bounds.min[axis] + share * (bounds.max[axis] - bounds.min[axis]);
                let parts = Plane { axis, place }.cut(corners, &bounds.into()).map(Aabb::from);
                for part in &parts {
                    assert!(bounds.contains(part), "{part:?}");
                }
                assert_eq!((parts[0].max[axis], parts[1].min[axis]), (place, place));
                for (i, j) in (0..=30).flat_map(|i| (0..=30 - i).map(move |j| (i, j))) {
                    let (u, v) = (f64::from(i) / 30.0, f64::from(j) / 30.0);
                    let point = [0, 1, 2].map(|axis| {
                        let [a, b, c] = corners.map(|corner| f64::from(corner[axis]));
                        a + u * (b - a) + v * (c - a)
                    });
                    let inside = |part: &Aabb| {
                        (0..3).all(|i| {
                            let error = 1e-14;
                            f64::from(part.min[i]) - error <= point[i]
                                && point[i] <= f64::from(part.max[i]) + error
                        })
                    };
                    assert!(parts.iter().any(inside), "{point:?} in none of {parts:?}");
                }
            }
        }
    }
}
