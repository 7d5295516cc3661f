//! All hits of a ray, each crossing exactly once.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use super::{HitFilter, HitLists, QueryOptions};
use crate::hit::RayHit;
use crate::structures::{Chooser, HitVisitor};
use crate::{Bvh, Geometry, Hit, PreparedRay, Ray};

impl<G: Geometry> Bvh<G> {
    /// All hits at `t_min <= t < t_max`, by ascending `t`, equally near ones by ascending primitive number. `hits` is emptied first; reuse it to save its
    /// memory.
    ///
    /// Each crossing of the surface is there exactly once: where a ray passes through an edge or a vertex that triangles share, one of those in front and one of
    /// those behind is hit, whichever way rounding goes. So a ray that comes from outside of a closed mesh and leaves it again has an even number of hits,
    /// one that starts inside an odd number, unless it starts on the surface itself. A ray in the plane of a triangle does not hit that one. (Closest
    /// hits count edges with both neighbours instead; and so a ray that only touches a mesh's silhouette may have a closest hit and none here.) By the simulation
    /// of simplicity, Edelsbrunner and Mücke 1990; always watertight, whatever the [`TriangleTest`](crate::TriangleTest).
    ///
    /// Other primitives are asked for [all their hits](Geometry::intersect_all): a sphere has two.
    ///
    /// Cost: one walk through everything along the ray, whatever the number of hits, and sorting these.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, Spheres};
    ///
    /// let spheres = Spheres::new(vec![([0.0, 0.0, 0.0].into(), 1.0), ([5.0, 0.0, 0.0].into(), 1.0)])?;
    /// let bvh = Bvh::build(&spheres)?;
    /// let mut hits = Vec::new();
    /// bvh.all_hits(&Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), &mut hits);
    /// assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [2.0, 4.0, 7.0, 9.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.append_hits(ray, hits);
    }

    /// As [`all_hits`](Self::all_hits), but only those hits that the options let count. The order in which a filter is asked is not specified.
    pub fn all_hits_with<F: HitFilter>(
        &self,
        ray: &Ray,
        options: QueryOptions<F>,
        hits: &mut Vec<Hit>,
    ) {
        hits.clear();
        let Some(ray) = PreparedRay::new(ray) else { return };
        let mut chooser = options.chooser(&self.geometry, &ray);
        let mut visitor = Each(&ray, |hit| {
            if chooser.counts(&hit) {
                hits.push(hit);
            }
            ControlFlow::Continue(())
        });
        let _ = self.tree.visit_crossings(&self.geometry, &ray, &mut visitor);
        hits.sort_unstable_by(by_distance);
    }

    /// Tells `visit` of every hit that [`all_hits`](Self::all_hits) would give, in no particular order, until it breaks off. Without memory of its own.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    ///
    /// use raywood::{Bvh, Ray, Spheres};
    ///
    /// let bvh = Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0); 100])?)?;
    /// let mut count = 0;
    /// let flow = bvh.for_each_hit(&Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), |_| {
    ///     count += 1;
    ///     if count < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    /// });
    /// assert_eq!((count, flow), (10, ControlFlow::Break(())));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn for_each_hit(
        &self,
        ray: &Ray,
        visit: impl FnMut(Hit) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        match PreparedRay::new(ray) {
            Some(ray) => self.tree.visit_crossings(&self.geometry, &ray, &mut Each(&ray, visit)),
            None => ControlFlow::Continue(()),
        }
    }

    /// How many hits [`all_hits`](Self::all_hits) would give. Odd for a ray without end that starts inside a closed mesh, even for one that starts outside.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, Spheres};
    ///
    /// let bvh = Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?;
    /// assert_eq!(bvh.crossings(&Ray::new([0.5, 0.0, 0.0], [0.0, 0.0, 1.0])), 1);
    /// assert_eq!(bvh.crossings(&Ray::new([0.5, 0.0, -2.0], [0.0, 0.0, 1.0])), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn crossings(&self, ray: &Ray) -> usize {
        let mut count = 0;
        let _ = self.for_each_hit(ray, |_| {
            count += 1;
            ControlFlow::Continue(())
        });
        count
    }

    /// [`all_hits`](Self::all_hits) for many rays, over all cores of the caller's rayon pool.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, Spheres};
    ///
    /// let bvh = Bvh::build(Spheres::new(vec![([0.0; 3].into(), 1.0)])?)?;
    /// let rays = [0.0, 0.5, 2.0].map(|y| Ray::new([-3.0, y, 0.0], [1.0, 0.0, 0.0]));
    /// let lists = bvh.all_hits_batch(&rays);
    /// assert_eq!(lists.offsets(), [0, 2, 4, 4]);
    /// assert_eq!(lists.of(0)[1].t, 4.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn all_hits_batch(&self, rays: &[Ray]) -> HitLists {
        HitLists::collect(rays, |ray, hits| self.append_hits(ray, hits))
    }

    /// Puts the hits of a ray behind those that are there.
    fn append_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        let start = hits.len();
        let _ = self.for_each_hit(ray, |hit| {
            hits.push(hit);
            ControlFlow::Continue(())
        });
        hits[start..].sort_unstable_by(by_distance);
    }
}

/// The order of hits: by distance, of equally near ones by the number of the instance, then by that of the primitive.
pub(crate) fn by_distance<H: RayHit>(a: &H, b: &H) -> Ordering {
    let (s, t) = (a.distance(), b.distance());
    s.partial_cmp(&t).unwrap_or(Ordering::Equal).then(a.numbers().cmp(&b.numbers()))
}

/// Tells a closure of every hit.
struct Each<'a, F>(&'a PreparedRay, F);

impl<F: FnMut(Hit) -> ControlFlow<()>> HitVisitor for Each<'_, F> {
    const LIMIT_SHRINKS: bool = false;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.0.t_max
    }

    #[inline(always)]
    fn visit(&mut self, hit: Hit) -> ControlFlow<()> {
        self.1(hit)
    }
}
