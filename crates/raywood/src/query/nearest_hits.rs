//! The first few hits of a ray.

use std::ops::ControlFlow;

use super::all_hits::by_distance;
use super::{HitFilter, HitLists, QueryOptions};
use crate::hit::RayHit;
use crate::structures::{Chooser, HitVisitor};
use crate::{Bvh, Geometry, Hit, PreparedRay, Ray};

impl<G: Geometry> Bvh<G> {
    /// The nearest `k` hits, or all if there are fewer: the first of those that [`all_hits`](Self::all_hits) gives, in the same order. `hits` is emptied first.
    ///
    /// Cost: the less the smaller `k` is, for nothing behind the `k`-th hit is looked into once that is known; memory for `k` hits.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, Spheres};
    ///
    /// let row = (0..100).map(|i| ([3.0 * i as f32, 0.0, 0.0].into(), 1.0)).collect();
    /// let bvh = Bvh::build(Spheres::new(row)?)?;
    /// let mut hits = Vec::new();
    /// bvh.nearest_hits(&Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), 3, &mut hits);
    /// assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [2.0, 4.0, 5.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn nearest_hits(&self, ray: &Ray, k: usize, hits: &mut Vec<Hit>) {
        hits.clear();
        self.append_nearest(ray, k, &mut All, hits);
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
        let Some(prepared) = PreparedRay::new(ray) else { return };
        self.append_nearest(ray, k, &mut options.chooser(&self.geometry, &prepared), hits);
    }

    /// [`nearest_hits`](Self::nearest_hits) for many rays, over all cores of the caller's rayon pool.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, Spheres};
    ///
    /// let bvh = Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0), ([5.0, 0.0, 0.0].into(), 1.0)])?)?;
    /// let rays = [0.0, 2.0].map(|y| Ray::new([-3.0, y, 0.0], [1.0, 0.0, 0.0]));
    /// let lists = bvh.nearest_hits_batch(&rays, 3);
    /// assert_eq!(lists.iter().map(<[_]>::len).collect::<Vec<_>>(), [3, 0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn nearest_hits_batch(&self, rays: &[Ray], k: usize) -> HitLists {
        HitLists::collect(rays, |ray, hits| self.append_nearest(ray, k, &mut All, hits))
    }

    /// Puts the nearest hits of a ray behind those that are there.
    fn append_nearest<C: Chooser>(
        &self,
        ray: &Ray,
        k: usize,
        chooser: &mut C,
        hits: &mut Vec<Hit>,
    ) {
        let (Some(ray), true) = (PreparedRay::new(ray), k > 0) else { return };
        let mut nearest = NearestHits::behind(hits, k, ray.t_max, chooser);
        let _ = self.tree.visit_crossings(&self.geometry, &ray, &mut nearest);
        nearest.sort();
    }
}

/// Every hit counts.
struct All;

impl Chooser for All {
    #[inline(always)]
    fn counts(&mut self, _: &Hit) -> bool {
        true
    }
}

/// Keeps the nearest hits that count, as soon as there are `k` as a heap: the farthest of them comes first, and none is farther than the one at half its place.
pub(crate) struct NearestHits<'a, H: RayHit, C> {
    /// Those of other rays, and behind them those of this one.
    hits: &'a mut Vec<H>,
    start: usize,
    k: usize,
    limit: H::Distance,
    chooser: &'a mut C,
}

impl<'a, H: RayHit, C> NearestHits<'a, H, C> {
    /// None yet, behind those of other rays: of at most `k`, which is not zero, none of them beyond the limit.
    pub(crate) fn behind(
        hits: &'a mut Vec<H>,
        k: usize,
        limit: H::Distance,
        chooser: &'a mut C,
    ) -> Self {
        let start = hits.len();
        Self { hits, start, k, limit, chooser }
    }

    /// Puts them into order.
    pub(crate) fn sort(self) {
        self.hits[self.start..].sort_unstable_by(by_distance);
    }
}

impl<H: RayHit, C: Chooser<H>> HitVisitor<H> for NearestHits<'_, H, C> {
    const LIMIT_SHRINKS: bool = true;

    #[inline(always)]
    fn limit(&self) -> H::Distance {
        self.limit
    }

    #[inline(always)]
    fn visit(&mut self, hit: H) -> ControlFlow<()> {
        let kept = self.hits.len() - self.start;
        if kept < self.k {
            if self.chooser.counts(&hit) {
                self.hits.push(hit);
                if kept + 1 == self.k {
                    let heap = &mut self.hits[self.start..];
                    (0..heap.len() / 2).rev().for_each(|place| sift_down(heap, place));
                    self.limit = heap[0].distance();
                }
            }
        } else {
            let heap = &mut self.hits[self.start..];
            if by_distance(&hit, &heap[0]).is_lt() && self.chooser.counts(&hit) {
                heap[0] = hit;
                sift_down(heap, 0);
                self.limit = heap[0].distance();
            }
        }
        ControlFlow::Continue(())
    }
}

/// Moves a hit to where none below it is farther.
fn sift_down<H: RayHit>(heap: &mut [H], mut place: usize) {
    loop {
        let farther = |a: usize, b: usize| {
            let is_farther = heap.get(b).is_some_and(|b| by_distance(b, &heap[a]).is_gt());
            if is_farther { b } else { a }
        };
        let farthest = farther(farther(place, 2 * place + 1), 2 * place + 2);
        if farthest == place {
            return;
        }
        heap.swap(place, farthest);
        place = farthest;
    }
}
