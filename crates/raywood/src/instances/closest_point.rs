//! The point of a scene of instances that is closest to a given one.

use std::ops::ControlFlow;

use super::Tlas;
use super::space::{Affine, Near, Numbers, Searchable, SpaceSearch};
use crate::double::{Double3, add, dot, double, single, sub};
use crate::geometry::closest_to_zero;
use crate::{ClosestPoint, Geometry, Vec3, parallel};

impl<B: Searchable> Tlas<B> {
    /// The point of the scene that is closest to `point`, no further away than `max_distance` (infinity for any). `None` if there is none, or if the point is not finite or the distance
    /// NaN or negative.
    ///
    /// Of primitives at exactly the same distance (as it is returned) that of the lowest instance is told, of these the one with the lowest number. Instances that no
    /// [mask](crate::Instance::mask) sees are not there.
    ///
    /// Triangles are looked at where they stand, by corners that are not rounded on their way, however often they are scaled and sheared: distances are the scene's. Of primitives that are no triangles
    /// the closest point is told where transforms only turn, mirror, move and scale by the same in all directions, within a millionth of the distance and the coordinates; elsewhere such primitives are not seen.
    ///
    /// About O(log N) in the number of instances and of their primitives where the point is much closer to some than to most. It takes about as long as the same of the flattened geometry in one
    /// [`Bvh`](crate::Bvh::closest_point): less where instances stand apart, a quarter more where they overlap.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, Tlas, Transform, TriangleMesh};
    /// use std::sync::Arc;
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let leaf = Arc::new(Bvh::build(mesh)?);
    /// let wide = Transform::scaling([8.0, 1.0, 1.0]).then(&Transform::translation([0.0, 0.0, 5.0]));
    /// let scene = Tlas::build(vec![Instance::new(Arc::clone(&leaf), Transform::IDENTITY), Instance::new(leaf, wide)])?;
    ///
    /// let closest = scene.closest_point([4.0, 0.25, 3.0], f32::INFINITY).expect("there are triangles");
    /// assert_eq!((closest.instance, closest.distance, closest.point), (1, 2.0, [4.0, 0.25, 5.0].into()));
    /// assert_eq!(scene.closest_point([4.0, 0.25, 3.0], 1.9), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_point(
        &self,
        point: impl Into<[f32; 3]>,
        max_distance: f32,
    ) -> Option<ClosestPoint> {
        self.closest_point_masked(point, max_distance, u32::MAX)
    }

    /// As [`closest_point`](Self::closest_point), of instances alone whose [mask](crate::Instance::mask) has a bit in common with `mask`, on every level.
    pub fn closest_point_masked(
        &self,
        point: impl Into<[f32; 3]>,
        max_distance: f32,
        mask: u32,
    ) -> Option<ClosestPoint> {
        let point = Vec3::from(point.into());
        if !point.is_finite() || max_distance.is_nan() || max_distance < 0.0 {
            return None;
        }
        let point = double(point);
        let mut closest = Closest { point, max_distance, best: None };
        let mut search = SpaceSearch {
            min: point,
            max: point,
            limit: closest.limit(),
            mask,
            placed: Affine::IDENTITY,
            first: 0,
            near: &mut closest,
        };
        // A search for what is closest goes on to its end.
        let _ = self.search(&mut search);
        closest.best
    }

    /// [`closest_point`](Self::closest_point) for many points, over all cores of the caller's rayon pool, with the same answers.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn closest_point_batch(
        &self,
        points: &[Vec3],
        max_distance: f32,
        answers: &mut [Option<ClosestPoint>],
    ) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill(points, answers, |&point| self.closest_point(point, max_distance));
    }
}

/// The closest point so far.
struct Closest {
    point: Double3,
    max_distance: f32,
    best: Option<ClosestPoint>,
}

impl Closest {
    /// The square of the distance from which on nothing is as close, not even after it is rounded.
    fn limit(&self) -> f64 {
        let distance = self.best.map_or(self.max_distance, |best| best.distance);
        let beyond = f64::from(distance.next_up());
        beyond * beyond
    }

    /// Takes a point that lies so far from the given one, if it is the closest.
    fn offer(&mut self, offset: Double3, (u, v): (f32, f32), numbers: Numbers) {
        let Numbers { instance, primitive } = numbers;
        let distance = dot(offset, offset).sqrt() as f32;
        let is_better = match &self.best {
            None => distance <= self.max_distance,
            Some(best) => {
                let order = (best.distance, best.instance, best.primitive);
                (distance, instance, primitive) < order
            }
        };
        if is_better {
            let point = single(add(self.point, offset));
            self.best = Some(ClosestPoint { point, distance, primitive, instance, u, v });
        }
    }
}

impl Near for Closest {
    fn triangle(&mut self, corners: [Double3; 3], numbers: Numbers) -> ControlFlow<(), f64> {
        let (offset, u, v) = closest_to_zero(corners.map(|corner| sub(corner, self.point)));
        self.offer(offset, (u as f32, v as f32), numbers);
        ControlFlow::Continue(self.limit())
    }

    fn other(
        &mut self,
        geometry: &dyn Geometry,
        placed: &Affine,
        numbers: Numbers,
    ) -> ControlFlow<(), f64> {
        if let Some((offset, u, v)) = closest_of(geometry, numbers.primitive, placed, self.point) {
            self.offer(offset, (u, v), numbers);
        }
        ControlFlow::Continue(self.limit())
    }
}

/// The way from a point to the closest one of a primitive that is no triangle, and its surface coordinates, if that can be told.
pub(super) fn closest_of(
    geometry: &dyn Geometry,
    primitive: u32,
    placed: &Affine,
    point: Double3,
) -> Option<(Double3, f32, f32)> {
    let scale = placed.similarity()?;
    let seen = single(placed.back(point, scale));
    let found = geometry.closest_point(primitive, seen).filter(|_| seen.is_finite())?;
    Some((sub(placed.point(double(found.point)), point), found.u, found.v))
}
