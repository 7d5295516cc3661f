//! The point of a mesh of double precision that is closest to a given one.

use std::ops::ControlFlow;

use super::{Bvh64, Ray64};
use crate::double::{Double3, add, dot, sub};
use crate::geometry::closest_to_zero;
use crate::{Aabb, parallel};

/// The point of a mesh of double precision that is closest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint64 {
    /// Where it lies.
    pub point: [f64; 3],
    /// How far it is from the given point; not negative.
    pub distance: f64,
    /// Which triangle it lies on; at exactly equal distance the lowest number wins.
    pub primitive: u32,
    /// The barycentric weight of the triangle's second corner.
    pub u: f64,
    /// The barycentric weight of the triangle's third corner.
    pub v: f64,
}

/// By how much of itself the distance of a box in single precision counts as less, for what is rounded on the way.
pub(super) const ROUNDINGS: f64 = 16.0 * f32::EPSILON as f64;

/// How far rounding moves a mesh of size one.
pub(super) const DISPLACEMENT: f64 = f32::EPSILON as f64;

impl Bvh64 {
    /// The point of the mesh that is closest to `point`, no further away than `max_distance` (infinity for any). `None` if there is none, or if the point is not
    /// finite or the distance NaN or negative.
    ///
    /// Differences of coordinates are rounded once, and so are products of these: the distance is off by some 2^-50 of itself and of the triangle's size. Boxes are visited best first, one by one: some ten times slower than
    /// [`Bvh::closest_point`](crate::Bvh::closest_point), whose bounds come from vectors.
    pub fn closest_point(&self, point: [f64; 3], max_distance: f64) -> Option<ClosestPoint64> {
        let is_usual = |x: &f64| x.abs() <= Ray64::GREATEST;
        if !(point.iter().all(is_usual) && max_distance >= 0.0) {
            return None;
        }
        // In the frame, where the size of everything is about one.
        let at = self.frame.point(point);
        let unit = self.frame.length(1.0);
        let limit = |distance: f64| ((distance * unit) as f32).next_up();
        let mut best: Option<ClosestPoint64> = None;
        let end = limit(max_distance);
        let bound = |bounds: &Aabb| {
            let distance = distance_of_box(at, bounds);
            let least = distance - DISPLACEMENT - ROUNDINGS * distance;
            let least = (least as f32).next_down();
            (least <= end).then_some(least)
        };
        let visit = |primitive: u32| {
            let corners = self.mesh.corners(primitive);
            let (offset, u, v) = closest_to_zero(corners.map(|corner| sub(corner, point)));
            let distance = dot(offset, offset).sqrt();
            let is_better = best.is_none_or(|best| {
                distance < best.distance || distance == best.distance && primitive < best.primitive
            });
            if is_better && distance <= max_distance {
                let point = add(point, offset);
                best = Some(ClosestPoint64 { point, distance, primitive, u, v });
            }
            ControlFlow::Continue(best.map_or(end, |best| limit(best.distance)))
        };
        let _ = self.tree.visit_primitives(bound, visit);
        best
    }

    /// [`closest_point`](Self::closest_point) for many points, over all cores of the caller's rayon pool, with the same answers.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn closest_point_batch(
        &self,
        points: &[[f64; 3]],
        max_distance: f64,
        answers: &mut [Option<ClosestPoint64>],
    ) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill(points, answers, |point| self.closest_point(*point, max_distance));
    }
}

/// How far a point is from a box.
pub(super) fn distance_of_box(point: Double3, bounds: &Aabb) -> f64 {
    let beside = [0, 1, 2].map(|axis| {
        let (min, max) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
        (min - point[axis]).max(point[axis] - max).max(0.0)
    });
    dot(beside, beside).sqrt()
}
