//! All hits of a ray of double precision, each crossing exactly once.

use std::ops::ControlFlow;

use super::{Bvh64, Hit64, Ray64};
use crate::query::by_distance;
use crate::structures::{Chooser, HitVisitor};
use crate::{HitFilter, HitLists, QueryOptions};

impl Bvh64 {
    /// All hits at `t_min <= t < t_max`, by ascending `t`, equally near ones by ascending number. `hits` is emptied first; reuse it to save its memory.
    ///
    /// Each crossing of the surface is there exactly once, as [`Bvh::all_hits`](crate::Bvh::all_hits) says: what goes into a closed mesh comes out of it.
    ///
    /// Cost: one walk through everything along the ray, whatever the number of hits, and sorting these.
    ///
    /// ```
    /// use raywood::{Bvh64, Ray64, TriangleMesh64};
    ///
    /// // Two panes, ten micrometres apart, a million metres away.
    /// let pane = |z| [[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]];
    /// let positions = [pane(1e6), pane(1e6 + 1e-5)].concat();
    /// let bvh = Bvh64::build(TriangleMesh64::new(positions, vec![[0, 1, 2], [3, 4, 5]])?)?;
    ///
    /// let mut hits = Vec::new();
    /// bvh.all_hits(&Ray64::new([0.0; 3], [0.0, 0.0, 1.0]), &mut hits);
    /// assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [1e6, 1e6 + 1e-5]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn all_hits(&self, ray: &Ray64, hits: &mut Vec<Hit64>) {
        hits.clear();
        self.append_hits(ray, hits);
    }

    /// As [`all_hits`](Self::all_hits), but only those hits that the options let count. The order in which a filter is asked is not specified.
    pub fn all_hits_with<F: HitFilter<Hit64>>(
        &self,
        ray: &Ray64,
        options: QueryOptions<F>,
        hits: &mut Vec<Hit64>,
    ) {
        hits.clear();
        let mut chooser = self.chooser(options, ray);
        let _ = self.for_each_hit(ray, |hit| {
            if chooser.counts(&hit) {
                hits.push(hit);
            }
            ControlFlow::Continue(())
        });
        hits.sort_unstable_by(by_distance);
    }

    /// Tells `visit` of every hit that [`all_hits`](Self::all_hits) would give, in no particular order, until it breaks off. Without memory of its own.
    pub fn for_each_hit(
        &self,
        ray: &Ray64,
        visit: impl FnMut(Hit64) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut visitor = Each { limit: ray.t_max, visit };
        self.tree.visit_crossings_in_double(self.scene(), ray, &mut visitor)
    }

    /// How many hits [`all_hits`](Self::all_hits) would give. Odd for a ray without end that starts inside a closed mesh, even for one that starts outside.
    pub fn crossings(&self, ray: &Ray64) -> usize {
        let mut count = 0;
        let _ = self.for_each_hit(ray, |_| {
            count += 1;
            ControlFlow::Continue(())
        });
        count
    }

    /// [`all_hits`](Self::all_hits) for many rays, over all cores of the caller's rayon pool.
    pub fn all_hits_batch(&self, rays: &[Ray64]) -> HitLists<Hit64> {
        HitLists::collect(rays, |ray, hits| self.append_hits(ray, hits))
    }

    /// Puts the hits of a ray behind those that are there.
    fn append_hits(&self, ray: &Ray64, hits: &mut Vec<Hit64>) {
        let start = hits.len();
        let _ = self.for_each_hit(ray, |hit| {
            hits.push(hit);
            ControlFlow::Continue(())
        });
        hits[start..].sort_unstable_by(by_distance);
    }
}

/// Tells a closure of every hit.
struct Each<F> {
    limit: f64,
    visit: F,
}

impl<F: FnMut(Hit64) -> ControlFlow<()>> HitVisitor<Hit64> for Each<F> {
    const LIMIT_SHRINKS: bool = false;

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.limit
    }

    #[inline(always)]
    fn visit(&mut self, hit: Hit64) -> ControlFlow<()> {
        (self.visit)(hit)
    }
}
