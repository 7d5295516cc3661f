//! Closest and any hit in double precision among those that options let count.

use std::ops::ControlFlow;

use super::{Bvh64, Hit64, PreparedRay64, Ray64, TriangleMesh64};
use crate::query::by_distance;
use crate::structures::{Chooser, HitVisitor};
use crate::{Face, HitFilter, QueryOptions};

impl Bvh64 {
    /// The closest of the hits that the options let count, at `t_min <= t < t_max`; of equally near ones that with the lowest number. All triangles are in all groups, so that a mask
    /// lets either all of them count or, being zero, none.
    ///
    /// ```
    /// use raywood::{Bvh64, Face, QueryOptions, Ray64, TriangleMesh64};
    ///
    /// let pane = |z| [[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]];
    /// let positions = [pane(1.0), pane(2.0)].concat();
    /// let bvh = Bvh64::build(TriangleMesh64::new(positions, vec![[0, 1, 2], [4, 3, 5]])?)?;
    ///
    /// let ray = Ray64::new([0.0; 3], [0.0, 0.0, 1.0]);
    /// let t = |options| bvh.intersect_with(&ray, options).map(|hit| hit.t);
    /// assert_eq!(t(QueryOptions::new()), Some(1.0));
    /// assert_eq!(t(QueryOptions::new().skip(0)), Some(2.0));
    /// assert_eq!(t(QueryOptions::new().cull(Face::Back)), Some(2.0));
    ///
    /// let far = bvh.intersect_with(&ray, QueryOptions::new().filter64(|hit| hit.t > 1.5));
    /// assert_eq!(far.map(|hit| hit.primitive), Some(1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn intersect_with<F: HitFilter<Hit64>>(
        &self,
        ray: &Ray64,
        options: QueryOptions<F>,
    ) -> Option<Hit64> {
        let mut best = Best::<_, false>::of(ray, self.chooser(options, ray));
        let _ = self.tree.visit_hits_in_double(self.scene(), ray, &mut best);
        best.hit
    }

    /// Whether any hit at `t_min <= t < t_max` counts under the options. It stops at the first that does.
    pub fn occluded_with<F: HitFilter<Hit64>>(
        &self,
        ray: &Ray64,
        options: QueryOptions<F>,
    ) -> bool {
        let mut any = Best::<_, true>::of(ray, self.chooser(options, ray));
        let _ = self.tree.visit_hits_in_double(self.scene(), ray, &mut any);
        any.hit.is_some()
    }

    /// Options at work on a ray.
    pub(super) fn chooser<F: HitFilter<Hit64>>(
        &self,
        options: QueryOptions<F>,
        ray: &Ray64,
    ) -> impl Chooser<Hit64> {
        Options { options, mesh: &self.mesh, ray: PreparedRay64::new(ray, self.tree.level()) }
    }
}

/// The best hit that counts so far; with `ANY` the first one.
struct Best<C, const ANY: bool> {
    hit: Option<Hit64>,
    t_max: f64,
    chooser: C,
}

impl<C, const ANY: bool> Best<C, ANY> {
    fn of(ray: &Ray64, chooser: C) -> Self {
        Self { hit: None, t_max: ray.t_max, chooser }
    }
}

impl<C: Chooser<Hit64>, const ANY: bool> HitVisitor<Hit64> for Best<C, ANY> {
    const LIMIT_SHRINKS: bool = true;

    #[inline(always)]
    fn limit(&self) -> f64 {
        self.hit.map_or(self.t_max, |hit| hit.t)
    }

    #[inline(always)]
    fn visit(&mut self, hit: Hit64) -> ControlFlow<()> {
        let is_better = self.hit.is_none_or(|best| by_distance(&hit, &best).is_lt());
        if is_better && self.chooser.counts(&hit) {
            self.hit = Some(hit);
            if ANY {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}

/// Chooses hits by options.
struct Options<'a, F> {
    options: QueryOptions<F>,
    mesh: &'a TriangleMesh64,
    ray: PreparedRay64,
}

impl<F: HitFilter<Hit64>> Chooser<Hit64> for Options<'_, F> {
    #[inline(always)]
    fn counts(&mut self, hit: &Hit64) -> bool {
        let Self { options, mesh, ray } = self;
        let face = || match ray.meets_front(mesh.corners(hit.primitive)) {
            true => Face::Front,
            false => Face::Back,
        };
        options.lets_count((0, hit.primitive), || u32::MAX, face) && options.accepts(hit)
    }
}
