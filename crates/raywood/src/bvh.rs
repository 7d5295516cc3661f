//! The facade: a geometry and the tree over it, with every query.

use std::ops::ControlFlow;

use crate::parallel;
use crate::structures::AccelerationStructure;
use crate::{
    BuildError, BuildOptions, Geometry, Hit, HitColumns, Probe, Ray, SimdLevel, StructureStats,
    SurfacePoint, ValidationError, Vec3, WideBvh,
};

/// A bounding volume hierarchy over a geometry: what most users need. The tree is the one that traces fastest, the [`WideBvh`].
///
/// It owns its geometry, or borrows it when built over a reference:
///
/// ```
/// use raywood::{Bvh, Ray, TriangleMesh};
///
/// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriangleMesh::new(positions, vec![[0, 1, 2]])?;
/// let bvh = Bvh::build(&mesh)?;
///
/// let hit = bvh.intersect(&Ray::new([0.25, 0.5, 1.0], [0.0, 0.0, -1.0])).expect("the ray hits");
/// assert_eq!((hit.primitive, hit.t, hit.u, hit.v), (0, 1.0, 0.25, 0.5));
/// assert!(!bvh.occluded(&Ray::between([0.25, 0.5, 1.0], [0.25, 0.5, 0.5])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Bvh<G> {
    pub(crate) geometry: G,
    pub(crate) tree: WideBvh,
}

impl<G: Geometry> Bvh<G> {
    /// Builds a tree over the geometry with good defaults. O(N log N), in parallel in the caller's rayon pool; the same tree for any
    /// number of threads.
    ///
    /// # Errors
    ///
    /// Too many primitives, or (from a geometry of your own) one whose box is empty or not finite.
    pub fn build(geometry: G) -> Result<Self, BuildError> {
        Self::build_with(geometry, &BuildOptions::default())
    }

    /// Builds a tree with the given options.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn build_with(geometry: G, options: &BuildOptions) -> Result<Self, BuildError> {
        let tree = WideBvh::build(&geometry, options)?;
        Ok(Self { geometry, tree })
    }

    /// As [`build_with`](Self::build_with), while `watcher` is told how much is done, from 0 to 1 in proportion to time, and may stop the build. What is built is the
    /// same, to the bit.
    ///
    /// The watcher is called every few milliseconds, first with 0 and last with 1, never with less than before. Any thread of the pool may call it, but no two at a
    /// time; the thread waits for the answer, so it should be quick. After it answered `Break` it is not called again, and the build ends within some 50
    /// milliseconds. If it panics, so does the build.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use std::time::{Duration, Instant};
    /// use raywood::{BuildError, BuildOptions, Bvh, TriangleMesh};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]])?;
    ///
    /// let end = Instant::now() + Duration::from_secs(60);
    /// let built = Bvh::build_watched(&mesh, &BuildOptions::default(), |done| {
    ///     eprint!("\r{:3.0}%", 100.0 * done);
    ///     if Instant::now() < end { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    /// });
    /// assert!(built.is_ok());
    ///
    /// let refused = Bvh::build_watched(&mesh, &BuildOptions::default(), |_| ControlFlow::Break(()));
    /// assert_eq!(refused.err(), Some(BuildError::Cancelled));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build), and [`BuildError::Cancelled`] if the watcher said so.
    pub fn build_watched(
        geometry: G,
        options: &BuildOptions,
        watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    ) -> Result<Self, BuildError> {
        let tree = WideBvh::build_watched(&geometry, options, watcher)?;
        Ok(Self { geometry, tree })
    }

    /// The geometry.
    pub fn geometry(&self) -> &G {
        &self.geometry
    }

    /// The tree.
    pub fn tree(&self) -> &WideBvh {
        &self.tree
    }

    /// The vector instructions that trace it.
    pub fn simd_level(&self) -> SimdLevel {
        self.tree.level()
    }

    /// Has other vector instructions trace it than the [active](SimdLevel::active) ones: for measuring and testing. A level that the processor lacks
    /// counts as portable. The tree stays the same.
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        self.tree.set_simd_level(level);
    }

    /// The closest hit at `t_min <= t < t_max`; of equally near ones that with the lowest primitive number.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_probed(ray, &mut ())
    }

    /// Whether the ray hits anything at `t_min <= t < t_max`. Faster than [`intersect`](Self::intersect): it stops at the
    /// first hit it finds.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_probed(ray, &mut ())
    }

    /// As [`intersect`](Self::intersect), telling a probe what is tested.
    #[inline]
    pub fn intersect_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.tree.intersect(&self.geometry, ray, probe)
    }

    /// As [`occluded`](Self::occluded), telling a probe what is tested.
    #[inline]
    pub fn occluded_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.tree.occluded(&self.geometry, ray, probe)
    }

    /// [`intersect`](Self::intersect) for many rays, over all cores of the caller's rayon pool. Several times as fast as one by one: rays that lie close together
    /// and share an origin travel as packets, all others many at a time. Pass hundreds at least.
    ///
    /// Hits are those of the single form, but `t`, `u` and `v` of packets may differ in the last digits (`docs/numerics.md`, "Packets").
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill_pieces(rays, hits, |rays, hits| {
            self.tree.intersect_batch(&self.geometry, rays, hits);
        });
    }

    /// [`occluded`](Self::occluded) for many rays, over all cores of the caller's rayon pool, as [`intersect_batch`](Self::intersect_batch). Answers as the single
    /// form does.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        parallel::fill_pieces(rays, occluded, |rays, occluded| {
            self.tree.occluded_batch(&self.geometry, rays, occluded);
        });
    }

    /// The closest hits of rays from one point, as a camera has them, over all cores of the caller's rayon pool. `hits` gets as many places as there are
    /// directions. The fastest way for such rays, best in tiles of 16 times 16 pixels: see [`Structure::intersect_from`](crate::Structure::intersect_from).
    pub fn intersect_from(&self, origin: Vec3, directions: &[Vec3], hits: &mut HitColumns) {
        hits.resize(directions.len());
        parallel::fill_columns(directions, hits.as_mut(), &|directions, hits| {
            self.tree.intersect_from(&self.geometry, origin, directions, hits);
        });
    }

    /// Whether anything lies between each point and `target`, such as a small light, over all cores of the caller's rayon pool: the same as of
    /// [`occluded_batch`](Self::occluded_batch) for `Ray::between(point, target)` that ends at the share `end` of its way. See
    /// [`Structure::occluded_towards`](crate::Structure::occluded_towards).
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_towards(&self, target: Vec3, end: f32, points: &[Vec3], occluded: &mut [bool]) {
        assert_eq!(points.len(), occluded.len(), "as many answers as points");
        parallel::fill_pieces(points, occluded, |points, occluded| {
            self.tree.occluded_towards(&self.geometry, (target, end), (points, &[]), occluded);
        });
    }

    /// The point that a ray hit, from which the next ray can be spawned. `hit` must be this tree's answer to `ray`.
    #[inline]
    pub fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.geometry.surface_point(ray, hit)
    }

    /// Counts, depth, memory and quality of the tree. O(N).
    pub fn stats(&self) -> StructureStats {
        self.tree.stats()
    }

    /// Checks every invariant of the tree against the geometry. O(N); for tests and after changes.
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold.
    pub fn validate(&self) -> Result<(), ValidationError> {
        self.tree.validate(&self.geometry)
    }
}
