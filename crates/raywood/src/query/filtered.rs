//! Closest and any hit among those that options let count.

use super::{HitFilter, QueryOptions};
use crate::{Bvh, Geometry, Hit, PreparedRay, Ray};

impl<G: Geometry> Bvh<G> {
    /// The closest of the hits that the options let count, at `t_min <= t < t_max`; of equally near ones that with the lowest primitive number.
    ///
    /// Cost: as [`intersect`](Self::intersect), and what the options ask of each hit that is nearer than those before.
    ///
    /// ```
    /// use raywood::{Bvh, QueryOptions, Ray, TriangleMesh};
    ///
    /// // Two panes, the nearer one with a hole in the middle.
    /// let pane = |z| [[-1.0, -1.0, z], [3.0, -1.0, z], [-1.0, 3.0, z]];
    /// let positions = [pane(1.0), pane(2.0)].concat();
    /// let bvh = Bvh::build(TriangleMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?)?;
    ///
    /// let solid = |hit: &raywood::Hit| hit.primitive == 1 || hit.u + hit.v > 0.6;
    /// let options = QueryOptions::new().filter(solid);
    /// let through = Ray::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    /// let beside = Ray::new([0.9, 0.9, 0.0], [0.0, 0.0, 1.0]);
    /// assert_eq!(bvh.intersect_with(&through, options).map(|hit| hit.primitive), Some(1));
    /// assert_eq!(bvh.intersect_with(&beside, options).map(|hit| hit.primitive), Some(0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn intersect_with<F: HitFilter>(&self, ray: &Ray, options: QueryOptions<F>) -> Option<Hit> {
        self.intersect_with_within(ray, f32::INFINITY, options)
    }

    /// As [`intersect_with`](Self::intersect_with); what lies beyond the limit may be left out.
    pub(crate) fn intersect_with_within<F: HitFilter>(
        &self,
        ray: &Ray,
        limit: f32,
        options: QueryOptions<F>,
    ) -> Option<Hit> {
        let ray = PreparedRay::new(ray)?;
        let mut chooser = options.chooser(&self.geometry, &ray);
        self.tree.choose_hit::<_, false>(&self.geometry, &ray, limit, &mut chooser)
    }

    /// Whether any hit at `t_min <= t < t_max` counts under the options. It stops at the first that does.
    ///
    /// ```
    /// use raywood::{Bvh, QueryOptions, Ray, Spheres};
    ///
    /// let bvh = Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?;
    /// let ray = Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    /// assert!(bvh.occluded_with(&ray, QueryOptions::new()));
    /// assert!(!bvh.occluded_with(&ray, QueryOptions::new().skip(0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn occluded_with<F: HitFilter>(&self, ray: &Ray, options: QueryOptions<F>) -> bool {
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let mut chooser = options.chooser(&self.geometry, &ray);
        self.tree.choose_hit::<_, true>(&self.geometry, &ray, f32::INFINITY, &mut chooser).is_some()
    }
}
