//! All hits of a ray in scenes of instances, each crossing once, and the first few of them.

use std::ops::ControlFlow;

use super::{Tlas, Traceable};
use crate::query::{NearestHits, by_distance};
use crate::structures::{Chooser, HitVisitor};
use crate::{Hit, HitFilter, HitLists, HitRules, PreparedRay, QueryOptions, Ray};

impl<B: Traceable> Tlas<B> {
    /// All hits at `t_min <= t < t_max`, by ascending `t`, equally near ones by ascending instance, then by ascending primitive number. `hits` is emptied first; reuse it to save its memory.
    ///
    /// Each crossing of an object's surface is there exactly once, as [`Bvh::all_hits`](crate::Bvh::all_hits) says: a ray that comes from outside of a closed object has an even number of hits with each instance of
    /// it, whatever its transform. (Where surfaces of several instances touch, each is crossed for itself.)
    ///
    /// Cost: one walk through everything along the ray, whatever the number of hits, and sorting these.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, Ray, Spheres, Tlas, Transform};
    /// use std::sync::Arc;
    ///
    /// let ball = Arc::new(Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?);
    /// let at = |x: f32| Instance::new(Arc::clone(&ball), Transform::translation([x, 0.0, 0.0]));
    /// let scene = Tlas::build(vec![at(5.0), at(0.0)])?;
    /// let mut hits = Vec::new();
    /// scene.all_hits(&Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), &mut hits);
    /// let found: Vec<_> = hits.iter().map(|hit| (hit.t, hit.instance)).collect();
    /// assert_eq!(found, [(2.0, 1), (4.0, 1), (7.0, 0), (9.0, 0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.append_hits(ray, QueryOptions::new(), hits);
    }

    /// As [`all_hits`](Self::all_hits), but only those hits that the options let count, which mean what they do for [`intersect_with`](Self::intersect_with). The order in which a filter is
    /// asked is not specified.
    pub fn all_hits_with<F: HitFilter>(
        &self,
        ray: &Ray,
        options: QueryOptions<F>,
        hits: &mut Vec<Hit>,
    ) {
        hits.clear();
        self.append_hits(ray, options, hits);
    }

    /// Tells `visit` of every hit that [`all_hits`](Self::all_hits) would give, in no particular order, until it breaks off.
    pub fn for_each_hit(
        &self,
        ray: &Ray,
        visit: impl FnMut(Hit) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        self.for_each_hit_with(ray, QueryOptions::new(), visit)
    }

    /// As [`for_each_hit`](Self::for_each_hit), but only of those hits that the options let count.
    pub fn for_each_hit_with<F: HitFilter>(
        &self,
        ray: &Ray,
        options: QueryOptions<F>,
        mut visit: impl FnMut(Hit) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (rules, mut chooser) = options.parts();
        self.visit_crossings(ray, f32::INFINITY, &rules, &mut |hit| {
            if chooser.counts(&hit) {
                visit(hit)?;
            }
            ControlFlow::Continue(f32::INFINITY)
        })
    }

    /// How many hits [`all_hits`](Self::all_hits) would give.
    pub fn crossings(&self, ray: &Ray) -> usize {
        let mut count = 0;
        let _ = self.for_each_hit(ray, |_| {
            count += 1;
            ControlFlow::Continue(())
        });
        count
    }

    /// [`all_hits`](Self::all_hits) for many rays, over all cores of the caller's rayon pool.
    pub fn all_hits_batch(&self, rays: &[Ray]) -> HitLists {
        HitLists::collect(rays, |ray, hits| self.append_hits(ray, QueryOptions::new(), hits))
    }

    /// The nearest `k` hits, or all if there are fewer: the first of those that [`all_hits`](Self::all_hits) gives, in the same order. `hits` is emptied first.
    ///
    /// Cost: the less the smaller `k` is, for nothing behind the `k`-th hit is looked into once that is known; memory for `k` hits.
    pub fn nearest_hits(&self, ray: &Ray, k: usize, hits: &mut Vec<Hit>) {
        self.nearest_hits_with(ray, k, QueryOptions::new(), hits);
    }

    /// As [`nearest_hits`](Self::nearest_hits), but only hits that the options let count: the nearest `k` of these.
    pub fn nearest_hits_with<F: HitFilter>(
        &self,
        ray: &Ray,
        k: usize,
        options: QueryOptions<F>,
        hits: &mut Vec<Hit>,
    ) {
        hits.clear();
        self.append_nearest(ray, k, options, hits);
    }

    /// [`nearest_hits`](Self::nearest_hits) for many rays, over all cores of the caller's rayon pool.
    pub fn nearest_hits_batch(&self, rays: &[Ray], k: usize) -> HitLists {
        HitLists::collect(rays, |ray, hits| self.append_nearest(ray, k, QueryOptions::new(), hits))
    }

    /// Puts the hits of a ray behind those that are there.
    fn append_hits<F: HitFilter>(&self, ray: &Ray, options: QueryOptions<F>, hits: &mut Vec<Hit>) {
        let start = hits.len();
        let _ = self.for_each_hit_with(ray, options, |hit| {
            hits.push(hit);
            ControlFlow::Continue(())
        });
        hits[start..].sort_unstable_by(by_distance);
    }

    /// Puts the nearest hits of a ray behind those that are there.
    fn append_nearest<F: HitFilter>(
        &self,
        ray: &Ray,
        k: usize,
        options: QueryOptions<F>,
        hits: &mut Vec<Hit>,
    ) {
        if k == 0 {
            return;
        }
        let (rules, mut chooser) = options.parts();
        let mut nearest = NearestHits::behind(hits, k, f32::INFINITY, &mut chooser);
        let _ = self.visit_crossings(ray, f32::INFINITY, &rules, &mut |hit| {
            nearest.visit(hit)?;
            ControlFlow::Continue(nearest.limit())
        });
        nearest.sort();
    }

    /// Tells `visit` of hits up to the limit that it returns each time: see [`Traceable::visit_hits`].
    pub(super) fn visit_crossings(
        &self,
        ray: &Ray,
        limit: f32,
        rules: &HitRules,
        visit: &mut dyn FnMut(Hit) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let Some(prepared) = PreparedRay::new(ray) else { return ControlFlow::Continue(()) };
        self.walk(ray, &prepared, limit, rules.mask, |place, limit| {
            let seen = place.seen_at(ray, rules.time);
            let mut left = limit;
            place.object.visit_hits(&seen.ray, seen.limit(limit), rules, &mut |hit| {
                left = left.min(visit(place.in_scene(&hit, &seen))?);
                ControlFlow::Continue(seen.limit(left))
            })?;
            ControlFlow::Continue(left)
        })
    }
}
