//! What can be placed in a scene: a tree over a geometry, or a scene of instances again.

use std::ops::ControlFlow;

use super::ObjectPoint;
use crate::structures::{AccelerationStructure, Chooser, HitVisitor};
use crate::{Aabb, AcceptAll, Bvh, Geometry, Hit, HitRules, PreparedRay, Ray};

/// What a [`Tlas`](super::Tlas) can have instances of: a [`Bvh`], or a [`Tlas`](super::Tlas) for scenes on several levels.
///
/// Scenes of several kinds of geometry have a type of their own that is either, and hands every question on:
///
/// ```
/// use raywood::{Aabb, BoundsMargin, Bvh, Hit, HitRules, ObjectPoint, Ray, Spheres, Traceable, TriangleMesh};
/// use std::ops::ControlFlow;
///
/// enum Object {
///     Mesh(Bvh<TriangleMesh>),
///     Balls(Bvh<Spheres>),
/// }
///
/// impl Object {
///     fn get(&self) -> &dyn Traceable {
///         match self {
///             Object::Mesh(mesh) => mesh,
///             Object::Balls(balls) => balls,
///         }
///     }
/// }
///
/// impl Traceable for Object {
///     fn bounds(&self) -> Aabb { self.get().bounds() }
///     fn bounds_margin(&self) -> BoundsMargin { self.get().bounds_margin() }
///     fn instances(&self) -> usize { self.get().instances() }
///     fn intersect_within(&self, ray: &Ray, limit: f32, mask: u32) -> Option<Hit> { self.get().intersect_within(ray, limit, mask) }
///     fn occluded_within(&self, ray: &Ray, mask: u32) -> bool { self.get().occluded_within(ray, mask) }
///     fn object_point(&self, ray: &Ray, hit: &Hit) -> ObjectPoint { self.get().object_point(ray, hit) }
///     fn intersect_chosen(&self, ray: &Ray, limit: f32, rules: &HitRules, accepts: &mut dyn FnMut(&Hit) -> bool) -> Option<Hit> {
///         self.get().intersect_chosen(ray, limit, rules, accepts)
///     }
///     fn visit_hits(&self, ray: &Ray, limit: f32, rules: &HitRules, visit: &mut dyn FnMut(Hit) -> ControlFlow<(), f32>) -> ControlFlow<()> {
///         self.get().visit_hits(ray, limit, rules, visit)
///     }
/// }
/// ```
///
/// If scenes in which something [moves](super::Instance::later) are among them, the questions at a time are to be handed on as well.
pub trait Traceable: Send + Sync {
    /// The box around everything; empty if there is nothing.
    fn bounds(&self) -> Aabb;

    /// How far beside [`bounds`](Self::bounds) a ray may pass that hits something, by rounding. None by default.
    fn bounds_margin(&self) -> BoundsMargin {
        BoundsMargin::NONE
    }

    /// How many numbers hits tell instances apart by: 1 for what has none.
    fn instances(&self) -> usize {
        1
    }

    /// The closest hit at `t_min <= t < t_max` of what `mask` lets see. What lies beyond `limit` may be left out.
    fn intersect_within(&self, ray: &Ray, limit: f32, mask: u32) -> Option<Hit>;

    /// Whether the ray hits anything at `t_min <= t < t_max` that `mask` lets see.
    fn occluded_within(&self, ray: &Ray, mask: u32) -> bool;

    /// The point that a ray hit. `hit` must be an answer to `ray`.
    fn object_point(&self, ray: &Ray, hit: &Hit) -> ObjectPoint;

    /// The closest hit at `t_min <= t < t_max` that the rules let count and `accepts` accepts, which is asked last, of hits as this object tells of them. What lies beyond `limit` may be left out.
    fn intersect_chosen(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> Option<Hit>;

    /// Whether there is any such hit. The default looks for the closest.
    fn occluded_chosen(
        &self,
        ray: &Ray,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> bool {
        self.intersect_chosen(ray, f32::INFINITY, rules, accepts).is_some()
    }

    /// Tells `visit` of every hit at `t_min <= t < t_max` that the rules let count, each crossing once as [`Bvh::all_hits`] says, in any order, until it breaks off. It returns the limit from there
    /// on, at first `limit`: what lies beyond may be left out.
    fn visit_hits(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        visit: &mut dyn FnMut(Hit) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()>;

    /// The closest hits of many rays at `t_min <= t < t_max`, on the calling thread: of as many places. What can trace rays together does so; the default asks one by one.
    fn intersect_many(&self, rays: &[Ray], mask: u32, hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.intersect_within(ray, f32::INFINITY, mask);
        }
    }

    /// The same for whether rays hit anything.
    fn occluded_many(&self, rays: &[Ray], mask: u32, occluded: &mut [bool]) {
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = self.occluded_within(ray, mask);
        }
    }

    /// Whether anything in it moves. By default nothing does, and questions at a time are answered as those without.
    fn moves(&self) -> bool {
        false
    }

    /// As [`intersect_within`](Self::intersect_within), at a time from 0 to 1.
    #[inline]
    fn intersect_within_at(&self, ray: &Ray, limit: f32, mask: u32, time: f32) -> Option<Hit> {
        let _ = time;
        self.intersect_within(ray, limit, mask)
    }

    /// As [`occluded_within`](Self::occluded_within), at a time from 0 to 1.
    #[inline]
    fn occluded_within_at(&self, ray: &Ray, mask: u32, time: f32) -> bool {
        let _ = time;
        self.occluded_within(ray, mask)
    }

    /// As [`object_point`](Self::object_point), of an answer at a time.
    fn object_point_at(&self, ray: &Ray, hit: &Hit, time: f32) -> ObjectPoint {
        let _ = time;
        self.object_point(ray, hit)
    }

    /// As [`intersect_many`](Self::intersect_many), each ray at its time.
    fn intersect_many_at(&self, rays: &[Ray], times: &[f32], mask: u32, hits: &mut [Option<Hit>]) {
        let _ = times;
        self.intersect_many(rays, mask, hits);
    }

    /// As [`occluded_many`](Self::occluded_many), each ray at its time.
    fn occluded_many_at(&self, rays: &[Ray], times: &[f32], mask: u32, occluded: &mut [bool]) {
        let _ = times;
        self.occluded_many(rays, mask, occluded);
    }
}

/// How far beside a box a ray may pass that hits something inside of it, by rounding: a share of the largest coordinate of the ray's origin, and a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundsMargin {
    pub(super) share: f64,
    pub(super) length: f64,
}

impl BoundsMargin {
    /// None: the ray itself meets the box.
    pub const NONE: Self = Self { share: 0.0, length: 0.0 };

    /// The larger of both.
    pub(super) fn max(self, other: Self) -> Self {
        Self { share: self.share.max(other.share), length: self.length.max(other.length) }
    }

    /// That of a ray, rounded upwards.
    #[inline(always)]
    pub(super) fn of(&self, ray: &Ray) -> f32 {
        let largest = f64::from(ray.origin.abs().max_element());
        ((self.share * largest + self.length) as f32).next_up()
    }
}

impl<G: Geometry + Send> Traceable for Bvh<G> {
    fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    #[inline]
    fn intersect_within(&self, ray: &Ray, limit: f32, _mask: u32) -> Option<Hit> {
        self.tree.intersect_within(&self.geometry, ray, limit)
    }

    #[inline]
    fn occluded_within(&self, ray: &Ray, _mask: u32) -> bool {
        self.tree.occluded(&self.geometry, ray, &mut ())
    }

    fn object_point(&self, ray: &Ray, hit: &Hit) -> ObjectPoint {
        let point = self.geometry.surface_point(ray, hit);
        match self.geometry.triangle(hit.primitive) {
            Some(corners) => ObjectPoint::on_triangle(corners, &point),
            None => ObjectPoint::from(point),
        }
    }

    fn intersect_chosen(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        self.intersect_with_within(ray, limit, rules.with(accepts))
    }

    fn occluded_chosen(
        &self,
        ray: &Ray,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> bool {
        self.occluded_with(ray, rules.with(accepts))
    }

    fn visit_hits(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        visit: &mut dyn FnMut(Hit) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let Some(ray) = PreparedRay::new(ray) else { return ControlFlow::Continue(()) };
        let chooser = rules.with(AcceptAll).chooser(&self.geometry, &ray);
        let mut visitor = UpToLimit { limit: limit.min(ray.t_max), chooser, visit };
        self.tree.visit_crossings(&self.geometry, &ray, &mut visitor)
    }

    fn intersect_many(&self, rays: &[Ray], _mask: u32, hits: &mut [Option<Hit>]) {
        self.tree.intersect_batch(&self.geometry, rays, hits);
    }

    fn occluded_many(&self, rays: &[Ray], _mask: u32, occluded: &mut [bool]) {
        self.tree.occluded_batch(&self.geometry, rays, occluded);
    }
}

/// Tells of the hits that a chooser lets count, up to a limit that may fall.
struct UpToLimit<'a, C> {
    limit: f32,
    chooser: C,
    visit: &'a mut dyn FnMut(Hit) -> ControlFlow<(), f32>,
}

impl<C: Chooser> HitVisitor for UpToLimit<'_, C> {
    const LIMIT_SHRINKS: bool = true;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn visit(&mut self, hit: Hit) -> ControlFlow<()> {
        if hit.t <= self.limit && self.chooser.counts(&hit) {
            self.limit = self.limit.min((self.visit)(hit)?);
        }
        ControlFlow::Continue(())
    }
}
