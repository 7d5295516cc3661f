//! Closest and any hit in scenes of instances, of those hits that options let count.

use std::ops::ControlFlow;

use super::place::{Placement, is_nearer};
use super::{Tlas, Traceable};
use crate::structures::Chooser;
use crate::{Hit, HitFilter, HitRules, PreparedRay, QueryOptions, Ray};

impl<B: Traceable> Tlas<B> {
    /// The closest of the hits that the options let count, at `t_min <= t < t_max`; of equally near ones that of the lowest instance, as of [`intersect`](Self::intersect).
    ///
    /// Masks are those of instances, on every level, and those of [primitives](crate::Geometry::mask). A filter is given hits of this scene: their instances as numbered here. Front and back are
    /// the object's, as the normals of [`surface_point`](Self::surface_point) are: mirroring turns the order of a triangle's corners around, but leaves outside what was outside.
    ///
    /// Cost: as [`intersect`](Self::intersect), and what the options ask of each hit that is nearer than those before.
    ///
    /// ```
    /// use raywood::{Bvh, Face, Instance, QueryOptions, Ray, Spheres, Tlas, Transform};
    /// use std::sync::Arc;
    ///
    /// let ball = Arc::new(Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?);
    /// let mirrored = Transform::scaling([-1.0, 1.0, 1.0]).then(&Transform::translation([5.0, 0.0, 0.0]));
    /// let scene = Tlas::build(vec![Instance::new(Arc::clone(&ball), Transform::IDENTITY), Instance::new(ball, mirrored)])?;
    ///
    /// let ray = Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    /// let t = |options| scene.intersect_with(&ray, options).map(|hit| hit.t);
    /// assert_eq!(t(QueryOptions::new().skip_in(0, 0)), Some(7.0));
    /// assert_eq!(t(QueryOptions::new().skip_in(0, 0).cull(Face::Front)), Some(9.0));
    ///
    /// let second = scene.intersect_with(&ray, QueryOptions::new().filter(|hit| hit.instance == 1));
    /// assert_eq!(second.map(|hit| hit.t), Some(7.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn intersect_with<F: HitFilter>(&self, ray: &Ray, options: QueryOptions<F>) -> Option<Hit> {
        let (rules, mut chooser) = options.parts();
        self.closest_chosen(ray, f32::INFINITY, &rules, &mut |hit| chooser.counts(hit))
    }

    /// Whether any hit at `t_min <= t < t_max` counts under the options, which mean what they do for [`intersect_with`](Self::intersect_with). It stops at the first that does.
    pub fn occluded_with<F: HitFilter>(&self, ray: &Ray, options: QueryOptions<F>) -> bool {
        let (rules, mut chooser) = options.parts();
        self.any_chosen(ray, &rules, &mut |hit| chooser.counts(hit))
    }

    /// The closest hit that counts, unless it lies beyond the limit.
    pub(super) fn closest_chosen(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let prepared = PreparedRay::new(ray)?;
        let mut best: Option<Hit> = None;
        let _ = self.walk(ray, &prepared, limit, rules.mask, |place, limit| {
            match place.intersect_chosen(ray, limit, rules, accepts) {
                Some(hit) if is_nearer(&hit, best.as_ref()) => {
                    best = Some(hit);
                    ControlFlow::Continue(limit.min(hit.t))
                }
                _ => ControlFlow::Continue(limit),
            }
        });
        best
    }

    /// Whether any hit counts.
    pub(super) fn any_chosen(
        &self,
        ray: &Ray,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> bool {
        let Some(prepared) = PreparedRay::new(ray) else { return false };
        let flow = self.walk(ray, &prepared, f32::INFINITY, rules.mask, |place, limit| match place
            .occluded_chosen(ray, rules, accepts)
        {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(limit),
        });
        flow.is_break()
    }
}

impl<B: Traceable> Placement<B> {
    /// The closest hit with the instance that counts, up to a limit, which lies in the scene's units.
    fn intersect_chosen(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> Option<Hit> {
        let seen = self.seen_at(ray, rules.time);
        let mut accepts = |hit: &Hit| {
            // What lies beyond may be found, but nobody is asked of it.
            let hit = self.in_scene(hit, &seen);
            hit.t <= limit && accepts(&hit)
        };
        let hit =
            self.object.intersect_chosen(&seen.ray, seen.limit(limit), rules, &mut accepts)?;
        Some(self.in_scene(&hit, &seen))
    }

    /// Whether any hit with the instance counts.
    fn occluded_chosen(
        &self,
        ray: &Ray,
        rules: &HitRules,
        accepts: &mut dyn FnMut(&Hit) -> bool,
    ) -> bool {
        let seen = self.seen_at(ray, rules.time);
        let mut accepts = |hit: &Hit| accepts(&self.in_scene(hit, &seen));
        self.object.occluded_chosen(&seen.ray, rules, &mut accepts)
    }
}
