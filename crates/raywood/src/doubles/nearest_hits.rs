//! The first few hits of a ray of double precision.

use super::{Bvh64, Hit64, Ray64};
use crate::query::NearestHits;
use crate::structures::Chooser;
use crate::{HitFilter, HitLists, QueryOptions};

impl Bvh64 {
    /// The nearest `k` hits, or all if there are fewer: the first of those that [`all_hits`](Self::all_hits) gives, in the same order. `hits` is emptied first.
    ///
    /// Cost: the less the smaller `k` is, for nothing behind the `k`-th hit is looked into once that is known; memory for `k` hits.
    pub fn nearest_hits(&self, ray: &Ray64, k: usize, hits: &mut Vec<Hit64>) {
        self.nearest_hits_with(ray, k, QueryOptions::new(), hits);
    }

    /// As [`nearest_hits`](Self::nearest_hits), but only hits that the options let count: the nearest `k` of these.
    pub fn nearest_hits_with<F: HitFilter<Hit64>>(
        &self,
        ray: &Ray64,
        k: usize,
        options: QueryOptions<F>,
        hits: &mut Vec<Hit64>,
    ) {
        hits.clear();
        self.append_nearest(ray, k, &mut self.chooser(options, ray), hits);
    }

    /// [`nearest_hits`](Self::nearest_hits) for many rays, over all cores of the caller's rayon pool.
    pub fn nearest_hits_batch(&self, rays: &[Ray64], k: usize) -> HitLists<Hit64> {
        HitLists::collect(rays, |ray, hits| {
            self.append_nearest(ray, k, &mut self.chooser(QueryOptions::new(), ray), hits);
        })
    }

    /// Puts the nearest hits of a ray behind those that are there.
    fn append_nearest<C: Chooser<Hit64>>(
        &self,
        ray: &Ray64,
        k: usize,
        chooser: &mut C,
        hits: &mut Vec<Hit64>,
    ) {
        if k == 0 {
            return;
        }
        let mut nearest = NearestHits::behind(hits, k, ray.t_max, chooser);
        let _ = self.tree.visit_crossings_in_double(self.scene(), ray, &mut nearest);
        nearest.sort();
    }
}
