//! The facade for meshes of double precision: a mesh and the tree over it, with every query that there is for these.

use super::{Hit64, LocalFrame, Ray64, SurfacePoint64, TriangleMesh64};
use crate::structures::{AccelerationStructure, DoubleScene};
use crate::{BuildError, BuildOptions, SimdLevel, StructureStats, ValidationError, WideBvh};
use crate::{TriangleMesh, parallel};

/// A bounding volume hierarchy over a [`TriangleMesh64`]: for coordinates that single precision cannot tell apart.
///
/// ```
/// use raywood::{Bvh64, Ray64, TriangleMesh64};
///
/// // A square of a millimetre on the Earth's equator, in metres from its centre.
/// let [x, e] = [6_378_137.0, 0.001];
/// let positions = vec![[x, 0.0, 0.0], [x, e, 0.0], [x, e, e], [x, 0.0, e]];
/// let bvh = Bvh64::build(TriangleMesh64::new(positions, vec![[0, 1, 2], [0, 2, 3]])?)?;
///
/// // From a satellite.
/// let hit = bvh.intersect(&Ray64::new([4.2e7, 0.0004, 0.0001], [-1.0, 0.0, 0.0])).expect("a hit");
/// assert_eq!((hit.primitive, hit.t), (0, 4.2e7 - x));
/// assert!((hit.u - 0.3).abs() < 1e-12 && (hit.v - 0.1).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Answers are those of brute force over all triangles, whatever the options of the build, the number of threads and the level of instructions, and
/// those of batches are those of single rays, all to the bit: [`Hit64`] says how exact they are. At exactly equal `t` the lowest triangle wins, and no ray slips between two that share an
/// edge.
///
/// The tree is the one of [`Bvh`](crate::Bvh), in single precision and relative to the middle of the mesh. It leaves out what is certainly not hit, and so is the faster the larger the triangles
/// are as seen from there: where a triangle is smaller than a few millionths of the whole, so that single precision cannot tell it from its neighbours, rays ask all of these. Such a mesh should be
/// cut into several.
///
/// Hits of all kinds, closest points, what is [inside](Self::solid), what [overlaps](Self::overlapping) a region or another mesh and [moving spheres](Self::sphere_cast) are all there is so far: walks of one's own, instances, refit and saving are for [`Bvh`](crate::Bvh) alone.
#[derive(Clone, Debug)]
pub struct Bvh64 {
    pub(super) mesh: TriangleMesh64,
    pub(super) frame: LocalFrame,
    pub(super) tree: WideBvh,
}

impl Bvh64 {
    /// Builds a tree over the mesh with good defaults. O(N log N), in parallel in the caller's rayon pool; the same tree for any number of threads.
    ///
    /// # Errors
    ///
    /// Too many triangles.
    pub fn build(mesh: TriangleMesh64) -> Result<Self, BuildError> {
        Self::build_with(mesh, &BuildOptions::default())
    }

    /// Builds a tree with the given options. [`TriangleTest`](crate::TriangleTest) does not matter: the test is always watertight.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build), and those that the options ask for.
    pub fn build_with(mesh: TriangleMesh64, options: &BuildOptions) -> Result<Self, BuildError> {
        let frame = LocalFrame::of(&mesh);
        let tree = WideBvh::build(&frame.mesh(&mesh), options)?;
        Ok(Self { mesh, frame, tree })
    }

    /// The mesh.
    pub fn mesh(&self) -> &TriangleMesh64 {
        &self.mesh
    }

    /// The vector instructions that trace it.
    pub fn simd_level(&self) -> SimdLevel {
        self.tree.level()
    }

    /// Has other vector instructions trace it than the [active](SimdLevel::active) ones: for measuring and testing. A level that the processor lacks
    /// counts as portable.
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        self.tree.set_simd_level(level);
    }

    /// The closest hit at `t_min <= t < t_max`; of equally near ones that with the lowest number.
    pub fn intersect(&self, ray: &Ray64) -> Option<Hit64> {
        self.tree.closest_in_double(self.scene(), ray)
    }

    /// Whether the ray hits anything at `t_min <= t < t_max`. Faster than [`intersect`](Self::intersect).
    pub fn occluded(&self, ray: &Ray64) -> bool {
        self.tree.any_in_double(self.scene(), ray)
    }

    /// [`intersect`](Self::intersect) for many rays, over all cores of the caller's rayon pool, with the same answers. Pass hundreds at least.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_batch(&self, rays: &[Ray64], hits: &mut [Option<Hit64>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        parallel::fill_pieces(rays, hits, |rays, hits| {
            self.tree.closest_of_batch_in_double(self.scene(), rays, hits);
        });
    }

    /// [`occluded`](Self::occluded) for many rays, over all cores of the caller's rayon pool, with the same answers.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_batch(&self, rays: &[Ray64], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        parallel::fill_pieces(rays, occluded, |rays, occluded| {
            self.tree.any_of_batch_in_double(self.scene(), rays, occluded);
        });
    }

    /// The point of a hit, from which the next ray can be spawned.
    ///
    /// # Panics
    ///
    /// If the mesh has no such triangle.
    pub fn surface_point(&self, hit: &Hit64) -> SurfacePoint64 {
        let corners = self.mesh.corners(hit.primitive);
        SurfacePoint64::on_triangle(corners, self.mesh.largest(hit.primitive), hit.u, hit.v)
    }

    /// Counts, depth, memory and quality of the tree. O(N).
    pub fn stats(&self) -> StructureStats {
        self.tree.stats()
    }

    /// Checks every invariant of the tree against the mesh. O(N); for tests.
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold.
    pub fn validate(&self) -> Result<(), ValidationError> {
        self.tree.validate::<TriangleMesh>(&self.frame.mesh(&self.mesh))
    }

    pub(super) fn scene(&self) -> DoubleScene<'_> {
        DoubleScene { mesh: &self.mesh, frame: &self.frame, level: self.tree.level() }
    }
}
