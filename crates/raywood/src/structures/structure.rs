//! The facade over structures of any kind: a geometry and a structure over it.

use std::ops::ControlFlow;

use super::registry::AnyStructure;
use super::{AccelerationStructure, StructureKind, WideBvh};
use crate::build::{Work, watched};
use crate::{BuildError, BuildOptions, Geometry, Hit, HitColumns, Probe, Ray, StructureStats};
use crate::{NodeView, SimdLevel, SurfacePoint, ValidationError, Vec3, parallel};

/// A geometry with an acceleration structure over it whose kind is chosen at run time: for comparing. [`Bvh`](crate::Bvh) is the one for
/// everyday use.
///
/// ```
/// use raywood::{Ray, Structure, StructureKind, TriangleMesh};
///
/// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriangleMesh::new(positions, vec![[0, 1, 2]])?;
/// for &kind in StructureKind::ALL {
///     let structure = Structure::build(kind, &mesh, &Default::default())?;
///     assert!(structure.occluded(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0])), "{}", kind.name());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Structure<G> {
    geometry: G,
    kind: StructureKind,
    structure: AnyStructure,
}

impl<G: Geometry> Structure<G> {
    /// Builds a structure of the given kind over the geometry. The same structure for any number of threads.
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build(
        kind: StructureKind,
        geometry: G,
        options: &BuildOptions,
    ) -> Result<Self, BuildError> {
        let structure = AnyStructure::build(kind, &geometry, options, Work::UNWATCHED)?;
        Ok(Self { geometry, kind, structure })
    }

    /// As [`build`](Self::build), watched: see [`Bvh::build_watched`](crate::Bvh::build_watched). Trees (`bvh-*`) tell how far they are and can be stopped at any time;
    /// grids, octree and kD-tree tell less, and of a model of millions of triangles may take some tenths of a second to stop.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build), and [`BuildError::Cancelled`] if the watcher said so.
    pub fn build_watched(
        kind: StructureKind,
        geometry: G,
        options: &BuildOptions,
        watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    ) -> Result<Self, BuildError> {
        let build = |work: Work<'_>| AnyStructure::build(kind, &geometry, options, work);
        let structure = watched(watcher, build)?;
        Ok(Self { geometry, kind, structure })
    }

    /// A wide tree that is there already, over its geometry.
    pub(crate) fn of_wide(geometry: G, tree: WideBvh) -> Self {
        Self { geometry, kind: StructureKind::BvhWide, structure: AnyStructure::BvhWide(tree) }
    }

    /// What kind it is.
    pub fn kind(&self) -> StructureKind {
        self.kind
    }

    /// The geometry.
    pub fn geometry(&self) -> &G {
        &self.geometry
    }

    /// The vector instructions that trace it; `None` if structures of its kind use none.
    pub fn simd_level(&self) -> Option<SimdLevel> {
        self.structure.simd_level()
    }

    /// Has other vector instructions trace it than the [active](SimdLevel::active) ones, which every structure begins with: for measuring. A
    /// level that the processor lacks counts as portable. The structure and its answers stay the same.
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        self.structure.set_simd_level(level);
    }

    /// The closest hit at `t_min <= t < t_max`; of equally near ones that with the lowest primitive number.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_probed(ray, &mut ())
    }

    /// Whether the ray hits anything at `t_min <= t < t_max`.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_probed(ray, &mut ())
    }

    /// As [`intersect`](Self::intersect), telling a probe what is tested.
    #[inline]
    pub fn intersect_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.structure.intersect(&self.geometry, ray, probe)
    }

    /// As [`occluded`](Self::occluded), telling a probe what is tested.
    #[inline]
    pub fn occluded_probed<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.structure.occluded(&self.geometry, ray, probe)
    }

    /// [`intersect`](Self::intersect) for many rays, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill_pieces(rays, hits, |rays, hits| {
            self.structure.intersect_batch(&self.geometry, rays, hits);
        });
    }

    /// [`occluded`](Self::occluded) for many rays, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        parallel::fill_pieces(rays, occluded, |rays, occluded| {
            self.structure.occluded_batch(&self.geometry, rays, occluded);
        });
    }

    /// The closest hits of rays from one point, which have no end, over all cores of the caller's rayon pool: the same as of
    /// [`intersect_batch`](Self::intersect_batch) for `Ray::new(origin, direction)`. `hits` gets as many places as there are directions.
    ///
    /// For a camera's rays the fastest way, best in tiles of 16 times 16 pixels: half as much to read and write, and nobody has to find out that the rays start
    /// at one point. Directions need not be normalised.
    ///
    /// ```
    /// use raywood::{BuildOptions, HitColumns, Structure, StructureKind, TriangleMesh, Vec3};
    ///
    /// let corners = vec![[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]];
    /// let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]])?;
    /// let structure = Structure::build(StructureKind::BvhWide, mesh, &BuildOptions::default())?;
    /// let mut hits = HitColumns::default();
    /// structure.intersect_from(Vec3::ZERO, &[Vec3::new(0.05, 0.05, 1.0), Vec3::new(0.0, 0.0, -1.0)], &mut hits);
    /// assert_eq!(hits.primitive, [0, HitColumns::NONE]);
    /// assert!((hits.t[0] - 5.0).abs() < 0.001);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn intersect_from(&self, origin: Vec3, directions: &[Vec3], hits: &mut HitColumns) {
        hits.resize(directions.len());
        parallel::fill_columns(directions, hits.as_mut(), &|directions, hits| {
            self.structure.intersect_from(&self.geometry, origin, directions, hits);
        });
    }

    /// As [`intersect_from`](Self::intersect_from), on this thread alone.
    pub fn intersect_from_serial(&self, origin: Vec3, directions: &[Vec3], hits: &mut HitColumns) {
        hits.resize(directions.len());
        self.structure.intersect_from(&self.geometry, origin, directions, hits.as_mut());
    }

    /// Whether anything lies between each point and `target`, which is how many points are in the shadow of a small light, over all cores of the caller's rayon
    /// pool: the same as of [`occluded_batch`](Self::occluded_batch) for `Ray::between(point, target)`, which ends at the share `end` of its way (1, or
    /// a little less so that a surface at the target does not count).
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_towards(&self, target: Vec3, end: f32, points: &[Vec3], occluded: &mut [bool]) {
        assert_eq!(points.len(), occluded.len(), "as many answers as points");
        parallel::fill_pieces(points, occluded, |points, occluded| {
            self.structure.occluded_towards(&self.geometry, (target, end), (points, &[]), occluded);
        });
    }

    /// As [`occluded_towards`](Self::occluded_towards), on this thread alone.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_towards_serial(
        &self,
        target: Vec3,
        end: f32,
        points: &[Vec3],
        occluded: &mut [bool],
    ) {
        assert_eq!(points.len(), occluded.len(), "as many answers as points");
        self.structure.occluded_towards(&self.geometry, (target, end), (points, &[]), occluded);
    }

    /// As [`occluded_towards_serial`](Self::occluded_towards_serial), of points that are known to lie beside surfaces: each where
    /// [`origin_towards`](crate::SurfacePoint::origin_towards) puts it on the target's side of the primitive of the given number. A triangle is then not in the
    /// way of the ray from there, and is not asked again, which saves time. Where that does not hold, the ray may pass through it or not.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn occluded_from_surfaces_serial(
        &self,
        target: Vec3,
        end: f32,
        points: &[Vec3],
        primitives: &[u32],
        occluded: &mut [bool],
    ) {
        assert_eq!(points.len(), occluded.len(), "as many answers as points");
        assert_eq!(points.len(), primitives.len(), "as many primitives as points");
        let points = (points, primitives);
        self.structure.occluded_towards(&self.geometry, (target, end), points, occluded);
    }

    /// As [`intersect_batch`](Self::intersect_batch), on this thread alone: for whoever hands out work to threads already.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch_serial(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        self.structure.intersect_batch(&self.geometry, rays, hits);
    }

    /// As [`occluded_batch`](Self::occluded_batch), on this thread alone.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch_serial(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        self.structure.occluded_batch(&self.geometry, rays, occluded);
    }

    /// The point that a ray hit, from which the next ray can be spawned. `hit` must be this structure's answer to `ray`.
    #[inline]
    pub fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.geometry.surface_point(ray, hit)
    }

    /// Counts, depth, memory and quality. O(size of the structure).
    pub fn stats(&self) -> StructureStats {
        self.structure.stats()
    }

    /// Shows every node or cell, parents before their children. O(size of the structure).
    pub fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        self.structure.visit_nodes(visit);
    }

    /// Checks every invariant of the structure against the geometry; for tests.
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold.
    pub fn validate(&self) -> Result<(), ValidationError> {
        self.structure.validate(&self.geometry)
    }
}
