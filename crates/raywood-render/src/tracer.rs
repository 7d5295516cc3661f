//! What rays are sent through: one structure over all surfaces of a scene, or a tree over its instances.

use raywood::{Hit, HitColumns, Ray, SimdLevel, Structure, SurfacePoint, Vec3};

use crate::instanced::Instanced;
use crate::prepared::Surfaces;

/// What rays are sent through. Each question goes to where the scene's surfaces are; which that is, is the same for all of a picture.
// A scene has one of them.
#[allow(clippy::large_enum_variant)]
pub(crate) enum Tracer<'a> {
    /// All surfaces stand in the world as they are.
    Surfaces(Structure<Surfaces<'a>>),
    /// Objects are shown at many places.
    Instances(Instanced<'a>),
}

impl Tracer<'_> {
    /// The vector instructions that trace.
    pub(crate) fn simd_level(&self) -> Option<SimdLevel> {
        match self {
            Self::Surfaces(structure) => structure.simd_level(),
            Self::Instances(instances) => Some(instances.tree.simd_level()),
        }
    }

    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Self::Surfaces(structure) => structure.intersect(ray),
            Self::Instances(instances) => instances.tree.intersect(ray),
        }
    }

    /// Whether anything moves. If nothing does, times do not matter.
    #[inline(always)]
    pub(crate) fn moves(&self) -> bool {
        match self {
            Self::Surfaces(_) => false,
            Self::Instances(instances) => instances.tree.moves(),
        }
    }

    /// [`intersect`](Self::intersect) at a time.
    #[inline]
    pub(crate) fn intersect_at(&self, ray: &Ray, time: f32) -> Option<Hit> {
        match self {
            Self::Surfaces(structure) => structure.intersect(ray),
            Self::Instances(instances) => instances.tree.intersect_at(ray, time),
        }
    }

    #[inline]
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        match self {
            Self::Surfaces(structure) => structure.occluded(ray),
            Self::Instances(instances) => instances.tree.occluded(ray),
        }
    }

    /// The closest hits of many rays, on the calling thread. `times` has that of each where something [moves](Self::moves), else it is empty.
    pub(crate) fn intersect_batch(&self, rays: &[Ray], times: &[f32], hits: &mut [Option<Hit>]) {
        match self {
            Self::Surfaces(structure) => structure.intersect_batch_serial(rays, hits),
            Self::Instances(instances) if times.is_empty() => {
                instances.tree.intersect_batch_serial(rays, hits);
            }
            Self::Instances(instances) => {
                instances.tree.intersect_batch_at_serial(rays, times, hits);
            }
        }
    }

    /// Whether anything blocks rays, on the calling thread. `times` as above.
    pub(crate) fn occluded_batch(&self, rays: &[Ray], times: &[f32], occluded: &mut [bool]) {
        match self {
            Self::Surfaces(structure) => structure.occluded_batch_serial(rays, occluded),
            Self::Instances(instances) if times.is_empty() => {
                instances.tree.occluded_batch_serial(rays, occluded);
            }
            Self::Instances(instances) => {
                instances.tree.occluded_batch_at_serial(rays, times, occluded);
            }
        }
    }

    /// The closest hits of rays from one point, on the calling thread; at time 0.
    pub(crate) fn intersect_from(&self, origin: Vec3, directions: &[Vec3], hits: &mut HitColumns) {
        match self {
            Self::Surfaces(structure) => structure.intersect_from_serial(origin, directions, hits),
            Self::Instances(instances) => {
                instances.tree.intersect_from_serial(origin, directions, hits);
            }
        }
    }

    /// Whether anything lies between points on surfaces, beside the primitives of these numbers, and a target, up to `end` of the way; on the calling thread. `times` as above.
    pub(crate) fn occluded_from_surfaces(
        &self,
        target: Vec3,
        end: f32,
        (points, times): (&[Vec3], &[f32]),
        primitives: &[u32],
        occluded: &mut [bool],
    ) {
        match self {
            Self::Surfaces(structure) => {
                structure.occluded_from_surfaces_serial(target, end, points, primitives, occluded);
            }
            Self::Instances(_) => {
                let ray = |&point: &Vec3| Ray::between(point, target).with_interval(0.0, end);
                let rays: Vec<_> = points.iter().map(ray).collect();
                self.occluded_batch(&rays, times, occluded);
            }
        }
    }

    /// The point of a hit at a time, in the world.
    #[inline]
    pub(crate) fn surface_point(&self, ray: &Ray, hit: &Hit, time: f32) -> SurfacePoint {
        match self {
            Self::Surfaces(structure) => structure.surface_point(ray, hit),
            Self::Instances(instances) => instances.tree.surface_point_at(ray, hit, time),
        }
    }
}
