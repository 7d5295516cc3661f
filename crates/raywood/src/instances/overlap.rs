//! Which primitives of a scene of instances touch a region of space.

use std::ops::ControlFlow;

use super::Tlas;
use super::closest_point::closest_of;
use super::frustum::FrustumSearch;
use super::space::{Affine, Near, Numbers, Searchable, SpaceSearch};
use crate::double::{Double3, dot, double, single, sub};
use crate::geometry::{TOUCH_SLACK, closest_to_zero, triangle_overlaps, triangles_touch_in_double};
use crate::{Aabb, Ball, Frustum, Geometry, Region, Vec3, parallel};

/// A region that can be looked for in a [scene of instances](Tlas): an [`Aabb`], a [`Ball`], a [`Frustum`] or a triangle, `[Vec3; 3]`.
///
/// What touches it are the triangles that do where they stand, as [`Bvh::overlapping`](crate::Bvh::overlapping) says; their corners are computed in double precision, and rounded once for a box. Of other
/// primitives those touch a ball whose closest point is [told](Tlas::closest_point) and no further away than the radius, a box those whose own boxes, where they stand, do, a frustum those whose own boxes,
/// where they stand, are not beyond one of its planes, and a triangle those that touch it as it is seen from the object, as far as boxes there tell.
// Sealed: how a scene is searched for them is nobody else's business.
#[allow(private_bounds)]
pub trait SceneRegion: Region + Sought {}

impl SceneRegion for Aabb {}
impl SceneRegion for Ball {}
impl SceneRegion for Frustum {}
impl SceneRegion for [Vec3; 3] {}

/// How a scene is searched for a region.
pub(super) trait Sought {
    /// Tells of what touches it: see [`Tlas::overlapping`].
    fn find<B: Searchable>(
        &self,
        scene: &Tlas<B>,
        visit: &mut dyn FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()>;
}

/// A region that is looked for by what is near to it.
pub(super) trait Touches {
    /// A box, and how far from it at most things lie that touch the region; `None` if nothing touches it.
    fn around(&self) -> Option<(Aabb, f32)>;

    /// Whether a triangle touches it.
    fn triangle(&self, corners: [Double3; 3]) -> bool;

    /// Whether another primitive, which `placed` takes into the scene's space, touches it.
    fn other(&self, geometry: &dyn Geometry, primitive: u32, placed: &Affine) -> bool;
}

impl<R: Touches> Sought for R {
    fn find<B: Searchable>(
        &self,
        scene: &Tlas<B>,
        visit: &mut dyn FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Some((bounds, distance)) = self.around() else { return ControlFlow::Continue(()) };
        // Beyond that not even a rounded distance counts.
        let beyond = f64::from(distance.next_up());
        let limit = beyond * beyond;
        scene.search(&mut SpaceSearch {
            min: double(bounds.min),
            max: double(bounds.max),
            limit,
            mask: u32::MAX,
            placed: Affine::IDENTITY,
            first: 0,
            near: &mut Touching { region: self, limit, visit },
        })
    }
}

impl Sought for Frustum {
    fn find<B: Searchable>(
        &self,
        scene: &Tlas<B>,
        visit: &mut dyn FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (frustum, placed, first) = (self, Affine::IDENTITY, 0);
        scene.search_frustum(&mut FrustumSearch { frustum, placed, first, visit })
    }
}

impl Touches for Aabb {
    fn around(&self) -> Option<(Aabb, f32)> {
        // An empty one has no distance from anything. One with NaN is empty, too.
        Some((self.as_region()?, 0.0))
    }

    fn triangle(&self, corners: [Double3; 3]) -> bool {
        triangle_overlaps(corners.map(single), self)
    }

    fn other(&self, geometry: &dyn Geometry, primitive: u32, placed: &Affine) -> bool {
        let Aabb { min, max } = geometry.bounds(primitive);
        let (mut least, mut greatest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for number in 0..8 {
            let side = |axis: usize| if number >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let corner = placed.point([side(0), side(1), side(2)].map(f64::from));
            least = [0, 1, 2].map(|axis| least[axis].min(corner[axis]));
            greatest = [0, 1, 2].map(|axis| greatest[axis].max(corner[axis]));
        }
        !Aabb { min: single(least), max: single(greatest) }.intersection(self).is_empty()
    }
}

impl Touches for Ball {
    fn around(&self) -> Option<(Aabb, f32)> {
        let Self { center, radius } = *self;
        (center.is_finite() && radius >= 0.0).then_some((Aabb { min: center, max: center }, radius))
    }

    fn triangle(&self, corners: [Double3; 3]) -> bool {
        let center = double(self.center);
        let (offset, _, _) = closest_to_zero(corners.map(|corner| sub(corner, center)));
        dot(offset, offset).sqrt() as f32 <= self.radius
    }

    fn other(&self, geometry: &dyn Geometry, primitive: u32, placed: &Affine) -> bool {
        let closest = closest_of(geometry, primitive, placed, double(self.center));
        closest.is_some_and(|(offset, ..)| dot(offset, offset).sqrt() as f32 <= self.radius)
    }
}

impl Touches for [Vec3; 3] {
    fn around(&self) -> Option<(Aabb, f32)> {
        let bounds = Aabb::of_points(*self);
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        // What is farther away is farther than what counts as touching.
        let distance = 4.0 * TOUCH_SLACK as f32 * largest;
        self.iter().all(|corner| corner.is_finite()).then_some((bounds, distance))
    }

    fn triangle(&self, corners: [Double3; 3]) -> bool {
        triangles_touch_in_double(self.map(double), corners)
    }

    fn other(&self, geometry: &dyn Geometry, primitive: u32, placed: &Affine) -> bool {
        // As it is seen from the object, where the primitive is known.
        let Some(seen) = placed.back_in_general(self.map(double)) else { return false };
        let bounds = geometry.bounds(primitive);
        let (corners, around) = (seen.map(single), Aabb::of_points(seen.map(single)));
        let largest = around.min.abs().max(around.max.abs()).max(bounds.min.abs());
        let rounding = f32::EPSILON * largest.max(bounds.max.abs()).max_element();
        let wider = |bounds: &Aabb| Aabb {
            min: bounds.min - Vec3::splat(rounding),
            max: bounds.max + Vec3::splat(rounding),
        };
        triangle_overlaps(corners, &wider(&bounds)) && geometry.overlaps(primitive, &wider(&around))
    }
}

impl<B: Searchable> Tlas<B> {
    /// Tells `visit` the numbers of the instance and the primitive, as a hit has them, of each primitive that touches a [region](SceneRegion), once, in no particular order, until it
    /// breaks. Instances that no [mask](crate::Instance::mask) sees are not there.
    ///
    /// O(log N) and what it costs to look at those found and their neighbours.
    ///
    /// ```
    /// use raywood::{Aabb, Ball, Bvh, Instance, Tlas, Transform, TriangleMesh};
    /// use std::ops::ControlFlow;
    /// use std::sync::Arc;
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let leaf = Arc::new(Bvh::build(mesh)?);
    /// let at = |x: f32| Instance::new(Arc::clone(&leaf), Transform::translation([x, 0.0, 0.0]));
    /// let scene = Tlas::build((0..100).map(|x| at(2.0 * x as f32)).collect())?;
    ///
    /// let mut found = Vec::new();
    /// let _ = scene.overlapping(&Aabb::new([9.5, 0.0, -1.0], [13.0, 1.0, 1.0]), |instance, primitive| {
    ///     found.push((instance, primitive));
    ///     ControlFlow::Continue(())
    /// });
    /// found.sort();
    /// assert_eq!(found, [(5, 0), (6, 0)]);
    /// assert!(!scene.overlaps(&Ball::new([1.5, 0.0, 0.0], 0.4)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overlapping<R: SceneRegion>(
        &self,
        region: &R,
        mut visit: impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        region.find(self, &mut visit)
    }

    /// Whether anything touches a region: [`overlapping`](Self::overlapping) up to the first.
    pub fn overlaps<R: SceneRegion>(&self, region: &R) -> bool {
        self.overlapping(region, |_, _| ControlFlow::Break(())).is_break()
    }

    /// [`overlaps`](Self::overlaps) for many regions, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn overlaps_batch<R: SceneRegion>(&self, regions: &[R], answers: &mut [bool]) {
        assert_eq!(regions.len(), answers.len(), "as many answers as regions");
        parallel::fill(regions, answers, |region| self.overlaps(region));
    }
}

/// Tells of what touches a region.
struct Touching<'a, R> {
    region: &'a R,
    limit: f64,
    visit: &'a mut dyn FnMut(u32, u32) -> ControlFlow<()>,
}

impl<R: Touches> Touching<'_, R> {
    fn tell_if(&mut self, touches: bool, numbers: Numbers) -> ControlFlow<(), f64> {
        if touches {
            (self.visit)(numbers.instance, numbers.primitive)?;
        }
        ControlFlow::Continue(self.limit)
    }
}

impl<R: Touches> Near for Touching<'_, R> {
    fn triangle(&mut self, corners: [Double3; 3], numbers: Numbers) -> ControlFlow<(), f64> {
        let touches = self.region.triangle(corners);
        self.tell_if(touches, numbers)
    }

    fn other(
        &mut self,
        geometry: &dyn Geometry,
        placed: &Affine,
        numbers: Numbers,
    ) -> ControlFlow<(), f64> {
        let touches = self.region.other(geometry, numbers.primitive, placed);
        self.tell_if(touches, numbers)
    }
}
