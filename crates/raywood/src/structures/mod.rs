//! Acceleration structures, one per file or folder, behind one trait and in one registry.

mod brute_force;
mod bvh2;
mod grid;
mod kd_tree;
pub(crate) mod octree;
mod registry;
mod structure;
pub(crate) mod wide;

pub use brute_force::BruteForce;
pub use bvh2::{Bvh2, Node};
pub use grid::{NestedGrid, UniformGrid};
pub use kd_tree::{KdNode, KdTree};
pub use octree::Octree;
pub use registry::StructureKind;
pub use structure::Structure;
pub use wide::WideBvh;
pub(crate) use wide::{Chooser, DoubleScene, HitVisitor, SavedWide, Unsound, WideNode};

use crate::{Geometry, Hit, HitColumnsMut, NodeView, Probe, Ray};
use crate::{SimdLevel, StructureStats, ValidationError, Vec3};

/// The most levels a tree may have, the root's counted: what the traversals' stacks hold.
pub(crate) const MAX_DEPTH: usize = 64;

/// What every acceleration structure can do.
///
/// A structure holds boxes, cells and primitive numbers, not the geometry, which every query is given: it must be the one that the
/// structure was built over. All structures give the same answers to single rays, to the bit: the hit of least distance, of equal ones
/// that of the lowest primitive number. Answers to batches [agree](Hit::agrees_with) with these.
pub trait AccelerationStructure: Send + Sync {
    /// The closest hit at `t_min <= t < t_max`. The probe is told what is tested.
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit>;

    /// Whether the ray hits anything at `t_min <= t < t_max`. The probe is told what is tested.
    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool;

    /// [`intersect`](Self::intersect) for many rays, on this thread. Both slices have the same length.
    fn intersect_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.intersect(geometry, ray, &mut ());
        }
    }

    /// [`occluded`](Self::occluded) for many rays, on this thread. Both slices have the same length.
    fn occluded_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = self.occluded(geometry, ray, &mut ());
        }
    }

    /// The closest hits of rays from one point without an end, on this thread, as [`intersect_batch`](Self::intersect_batch) gives them. There are as
    /// many places for hits as directions.
    fn intersect_from<G: Geometry>(
        &self,
        geometry: &G,
        origin: Vec3,
        directions: &[Vec3],
        mut hits: HitColumnsMut<'_>,
    ) {
        for (number, direction) in directions.iter().enumerate() {
            let ray = Ray::new(origin, *direction);
            hits.set(number, self.intersect(geometry, &ray, &mut ()));
        }
    }

    /// Whether anything lies between points and one that they look at, up to a share of the way, on this thread. There are as many answers as points, and
    /// as many numbers of primitives that the points lie beside, which are not in the way; or none, if that is not known.
    fn occluded_towards<G: Geometry>(
        &self,
        geometry: &G,
        (target, end): (Vec3, f32),
        (points, _beside): (&[Vec3], &[u32]),
        occluded: &mut [bool],
    ) {
        for (point, occluded) in points.iter().zip(occluded) {
            let ray = Ray::between(*point, target).with_interval(0.0, end);
            *occluded = self.occluded(geometry, &ray, &mut ());
        }
    }

    /// The vector instructions that trace it; `None` if it uses none.
    fn simd_level(&self) -> Option<SimdLevel> {
        None
    }

    /// Has other vector instructions trace it than the [active](SimdLevel::active) ones; a level that the processor lacks counts as
    /// portable. Nothing else changes, and nothing at all if it uses none.
    fn set_simd_level(&mut self, _level: SimdLevel) {}

    /// Shows every node or cell, parents before their children: the source of statistics and of pictures of the structure.
    /// O(size of the structure).
    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView));

    /// Bytes of the structure, without the geometry.
    fn bytes(&self) -> usize;

    /// How many primitives the geometry has.
    fn primitives(&self) -> usize;

    /// Counts, levels, memory and quality. O(size of the structure).
    fn stats(&self) -> StructureStats
    where
        Self: Sized,
    {
        StructureStats::of(self)
    }

    /// Checks every invariant against the geometry. O(size of the structure); for tests.
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold.
    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError>;
}
