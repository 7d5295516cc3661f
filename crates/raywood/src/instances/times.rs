//! Rays at times: scenes as they are while instances are on their way.
//!
//! The tree over the instances is that of all times; what depends on the time is the way into an object that moves, which each ray finds for itself. Everything else is as for rays without a time, which
//! run through code of their own.

use std::ops::ControlFlow;

use super::many::MOST;
use super::motion::sound;
use super::place::{Placement, is_nearer};
use super::transform::{Inverse, ObjectRay};
use super::{ObjectPoint, Tlas, Traceable, Transform};
use crate::{Hit, PreparedRay, Ray, SurfacePoint, parallel};

impl<B: Traceable> Tlas<B> {
    /// Whether anything moves, on any level. If nothing does, rays at any time see the same.
    pub fn moves(&self) -> bool {
        self.built.moves
    }

    /// As [`intersect`](Self::intersect), at a time from 0 to 1: the hit is that with a scene whose instances stand still where they are then, each at its [blend](Transform::blended). What lies
    /// beyond counts as the nearest time, NaN as 0.
    ///
    /// Cost: as `intersect`, and some 100 arithmetic operations more for each moving instance whose box the ray meets.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, Ray, Spheres, Tlas, Transform};
    /// use std::sync::Arc;
    ///
    /// let ball = Arc::new(Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?);
    /// let flies = Instance::new(ball, Transform::IDENTITY).moving_to(Transform::translation([0.0, 0.0, -4.0]));
    /// let scene = Tlas::build(vec![flies])?;
    ///
    /// let ray = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    /// let hit = scene.intersect_at(&ray, 0.25).expect("it is there");
    /// assert_eq!(hit.t, 3.0);
    /// assert_eq!(scene.surface_point_at(&ray, &hit, 0.25).position.z, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn intersect_at(&self, ray: &Ray, time: f32) -> Option<Hit> {
        self.closest_at(ray, f32::INFINITY, u32::MAX, time)
    }

    /// As [`occluded`](Self::occluded), at a time as [`intersect_at`](Self::intersect_at) has it.
    #[inline]
    pub fn occluded_at(&self, ray: &Ray, time: f32) -> bool {
        self.any_at(ray, u32::MAX, time)
    }

    /// [`intersect_at`](Self::intersect_at) for many rays, each at its time, over all cores of the caller's rayon pool. Those that meet the same instance go through it together, whenever they do.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn intersect_batch_at(&self, rays: &[Ray], times: &[f32], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        in_pieces(rays, times, hits, |rays, times, hits| {
            self.closest_of_many_at(rays, times, u32::MAX, hits);
        });
    }

    /// [`occluded_at`](Self::occluded_at) for many rays, each at its time, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn occluded_batch_at(&self, rays: &[Ray], times: &[f32], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        in_pieces(rays, times, occluded, |rays, times, occluded| {
            self.any_of_many_at(rays, times, u32::MAX, occluded);
        });
    }

    /// [`intersect_batch_at`](Self::intersect_batch_at) on the calling thread.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn intersect_batch_at_serial(&self, rays: &[Ray], times: &[f32], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        assert_eq!(rays.len(), times.len(), "as many times as rays");
        self.closest_of_many_at(rays, times, u32::MAX, hits);
    }

    /// [`occluded_batch_at`](Self::occluded_batch_at) on the calling thread.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn occluded_batch_at_serial(&self, rays: &[Ray], times: &[f32], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        assert_eq!(rays.len(), times.len(), "as many times as rays");
        self.any_of_many_at(rays, times, u32::MAX, occluded);
    }

    /// As [`surface_point`](Self::surface_point), of what a ray hit at a time. Rays spawned from there leave the surface as it is at that time.
    pub fn surface_point_at(&self, ray: &Ray, hit: &Hit, time: f32) -> SurfacePoint {
        self.object_point_at(ray, hit, time).rounded()
    }

    /// [`closest`](Self::closest) at a time.
    #[inline]
    pub(super) fn closest_at(&self, ray: &Ray, limit: f32, mask: u32, time: f32) -> Option<Hit> {
        let prepared = PreparedRay::new(ray)?;
        let mut best: Option<Hit> = None;
        let _ = self.walk(ray, &prepared, limit, mask, |place, limit| {
            let seen = place.seen_at(ray, time);
            let hit = place.object.intersect_within_at(&seen.ray, seen.limit(limit), mask, time);
            match hit.map(|hit| place.in_scene(&hit, &seen)) {
                Some(hit) if is_nearer(&hit, best.as_ref()) => {
                    best = Some(hit);
                    ControlFlow::Continue(limit.min(hit.t))
                }
                _ => ControlFlow::Continue(limit),
            }
        });
        best
    }

    /// [`any`](Self::any) at a time.
    #[inline]
    pub(super) fn any_at(&self, ray: &Ray, mask: u32, time: f32) -> bool {
        let Some(prepared) = PreparedRay::new(ray) else { return false };
        let flow = self.walk(ray, &prepared, f32::INFINITY, mask, |place, limit| {
            let seen = place.seen_at(ray, time).ray;
            match place.object.occluded_within_at(&seen, mask, time) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(limit),
            }
        });
        flow.is_break()
    }

    /// The closest hits of any number of rays, each at its time.
    pub(super) fn closest_of_many_at(
        &self,
        rays: &[Ray],
        times: &[f32],
        mask: u32,
        hits: &mut [Option<Hit>],
    ) {
        let pieces = rays.chunks(MOST).zip(times.chunks(MOST));
        for ((rays, times), hits) in pieces.zip(hits.chunks_mut(MOST)) {
            self.closest_of_many_when(AtTimes { times, together: vec![] }, rays, mask, hits);
        }
    }

    /// Whether anything blocks any number of rays, each at its time.
    pub(super) fn any_of_many_at(
        &self,
        rays: &[Ray],
        times: &[f32],
        mask: u32,
        occluded: &mut [bool],
    ) {
        let pieces = rays.chunks(MOST).zip(times.chunks(MOST));
        for ((rays, times), occluded) in pieces.zip(occluded.chunks_mut(MOST)) {
            self.any_of_many_when(AtTimes { times, together: vec![] }, rays, mask, occluded);
        }
    }
}

/// Has `f` write the answers to pieces of rays at times, in parallel.
fn in_pieces<A: Send>(
    rays: &[Ray],
    times: &[f32],
    answers: &mut [A],
    f: impl Fn(&[Ray], &[f32], &mut [A]) + Sync,
) {
    assert_eq!(rays.len(), times.len(), "as many times as rays");
    let pieces = rays.chunks(MOST).zip(times.chunks(MOST)).zip(answers.chunks_mut(MOST));
    parallel::map_tasks(pieces.collect(), |((rays, times), answers)| f(rays, times, answers));
}

impl<B> Placement<B> {
    /// The transform at a time.
    fn transform_at(&self, time: f32) -> Option<Transform> {
        let motion = self.motion.as_ref()?;
        (sound(time) > 0.0).then(|| motion.transform(&self.transform, time))
    }

    /// A ray as the object sees it at a time.
    #[inline(always)]
    pub(super) fn seen_at(&self, ray: &Ray, time: f32) -> ObjectRay {
        if self.motion.is_none() { self.inverse.ray(ray) } else { self.seen_moving(ray, time) }
    }

    /// The same of one that moves. Not inlined, so that walks through what stands still stay small.
    #[inline(never)]
    fn seen_moving(&self, ray: &Ray, time: f32) -> ObjectRay {
        match self.transform_at(time) {
            None => self.inverse.ray(ray),
            Some(transform) => transform.way_back().ray(ray),
        }
    }
}

impl<B: Traceable> Placement<B> {
    /// The point of a hit at a time, whose instance is that within the object.
    pub(super) fn point_at(&self, ray: &Ray, hit: &Hit, time: f32) -> ObjectPoint {
        let moved = self.transform_at(time).map(|transform| (transform, transform.way_back()));
        let (transform, inverse): (&Transform, &Inverse) = match &moved {
            None => (&self.transform, &self.inverse),
            Some((transform, inverse)) => (transform, inverse),
        };
        let seen = inverse.ray(ray);
        let hit = Hit { t: hit.t / seen.unit, ..*hit };
        self.object.object_point_at(&seen.ray, &hit, time).placed(transform, inverse)
    }
}

/// When the rays of a batch look at the scene. Rays are known by their numbers in it.
pub(super) trait When {
    /// A ray as the object of an instance sees it.
    fn seen<B>(&self, place: &Placement<B>, number: u32, ray: &Ray) -> ObjectRay;

    /// The closest hit of one ray, which is in the object's space, with an object.
    fn intersect<B: Traceable>(
        &self,
        object: &B,
        number: u32,
        ray: &Ray,
        limit: f32,
        mask: u32,
    ) -> Option<Hit>;

    /// Whether an object blocks one ray.
    fn occluded<B: Traceable>(&self, object: &B, number: u32, ray: &Ray, mask: u32) -> bool;

    /// The closest hits of several rays with an object.
    fn intersect_many<B: Traceable>(
        &mut self,
        object: &B,
        numbers: &[u32],
        rays: &[Ray],
        mask: u32,
        hits: &mut [Option<Hit>],
    );

    /// Whether an object blocks several rays.
    fn occluded_many<B: Traceable>(
        &mut self,
        object: &B,
        numbers: &[u32],
        rays: &[Ray],
        mask: u32,
        occluded: &mut [bool],
    );
}

/// All of them at time 0, without asking.
pub(super) struct AtStart;

impl When for AtStart {
    #[inline(always)]
    fn seen<B>(&self, place: &Placement<B>, _: u32, ray: &Ray) -> ObjectRay {
        place.inverse.ray(ray)
    }

    #[inline(always)]
    fn intersect<B: Traceable>(
        &self,
        object: &B,
        _: u32,
        ray: &Ray,
        limit: f32,
        mask: u32,
    ) -> Option<Hit> {
        object.intersect_within(ray, limit, mask)
    }

    #[inline(always)]
    fn occluded<B: Traceable>(&self, object: &B, _: u32, ray: &Ray, mask: u32) -> bool {
        object.occluded_within(ray, mask)
    }

    #[inline(always)]
    fn intersect_many<B: Traceable>(
        &mut self,
        object: &B,
        _: &[u32],
        rays: &[Ray],
        mask: u32,
        hits: &mut [Option<Hit>],
    ) {
        object.intersect_many(rays, mask, hits);
    }

    #[inline(always)]
    fn occluded_many<B: Traceable>(
        &mut self,
        object: &B,
        _: &[u32],
        rays: &[Ray],
        mask: u32,
        occluded: &mut [bool],
    ) {
        object.occluded_many(rays, mask, occluded);
    }
}

/// Each at its time.
struct AtTimes<'a> {
    times: &'a [f32],
    /// Memory for the times of rays that go through an object together.
    together: Vec<f32>,
}

impl AtTimes<'_> {
    #[inline(always)]
    fn time(&self, number: u32) -> f32 {
        self.times[number as usize]
    }

    fn gather(&mut self, numbers: &[u32]) {
        self.together.clear();
        self.together.extend(numbers.iter().map(|&number| self.times[number as usize]));
    }
}

impl When for AtTimes<'_> {
    #[inline(always)]
    fn seen<B>(&self, place: &Placement<B>, number: u32, ray: &Ray) -> ObjectRay {
        place.seen_at(ray, self.time(number))
    }

    #[inline(always)]
    fn intersect<B: Traceable>(
        &self,
        object: &B,
        number: u32,
        ray: &Ray,
        limit: f32,
        mask: u32,
    ) -> Option<Hit> {
        object.intersect_within_at(ray, limit, mask, self.time(number))
    }

    #[inline(always)]
    fn occluded<B: Traceable>(&self, object: &B, number: u32, ray: &Ray, mask: u32) -> bool {
        object.occluded_within_at(ray, mask, self.time(number))
    }

    fn intersect_many<B: Traceable>(
        &mut self,
        object: &B,
        numbers: &[u32],
        rays: &[Ray],
        mask: u32,
        hits: &mut [Option<Hit>],
    ) {
        self.gather(numbers);
        object.intersect_many_at(rays, &self.together, mask, hits);
    }

    fn occluded_many<B: Traceable>(
        &mut self,
        object: &B,
        numbers: &[u32],
        rays: &[Ray],
        mask: u32,
        occluded: &mut [bool],
    ) {
        self.gather(numbers);
        object.occluded_many_at(rays, &self.together, mask, occluded);
    }
}
