//! A part of a triangle mesh as a geometry of its own.

use std::ops::Range;

use super::{Geometry, PreparedRay, PrimitiveHit, SurfacePoint, TriangleMesh};
use crate::{Aabb, Hit, Ray, Vec3};

/// Triangles of a mesh that stand side by side, as a geometry of its own: its primitives are numbered from 0.
///
/// One mesh can so hold many objects, each with a tree of its own; what belongs to their triangles besides is found by adding [`first`](Self::first) to a hit's primitive.
#[derive(Clone, Copy, Debug)]
pub struct MeshPart<'a> {
    mesh: &'a TriangleMesh,
    first: u32,
    count: u32,
}

impl<'a> MeshPart<'a> {
    /// These triangles of a mesh; those that it does not have are left out.
    pub fn new(mesh: &'a TriangleMesh, triangles: Range<u32>) -> Self {
        let end = (triangles.end as usize).min(mesh.len()) as u32;
        let first = triangles.start.min(end);
        Self { mesh, first, count: end - first }
    }

    /// The number of its first triangle in the mesh.
    pub fn first(&self) -> u32 {
        self.first
    }

    /// The box around all its triangles. O(triangles).
    pub fn total_bounds(&self) -> Aabb {
        (0..self.count).fold(Aabb::EMPTY, |all, triangle| all.union(self.bounds(triangle)))
    }
}

impl Geometry for MeshPart<'_> {
    fn len(&self) -> usize {
        self.count as usize
    }

    #[inline(always)]
    fn bounds(&self, primitive: u32) -> Aabb {
        self.mesh.bounds(self.first + primitive)
    }

    fn has_sound_bounds(&self) -> bool {
        self.mesh.has_sound_bounds()
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        self.mesh.clipped_bounds(self.first + primitive, cell)
    }

    #[inline(always)]
    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        self.mesh.triangle(self.first + primitive)
    }

    #[inline(always)]
    fn prefetch(&self, primitive: u32) {
        self.mesh.prefetch(self.first + primitive);
    }

    #[inline(always)]
    fn prefetch_rest(&self, primitive: u32) {
        self.mesh.prefetch_rest(self.first + primitive);
    }

    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        self.mesh.overlaps(self.first + primitive, cell)
    }

    #[inline(always)]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        self.mesh.intersect(self.first + primitive, ray)
    }

    #[inline(always)]
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.mesh.surface_point(ray, &Hit { primitive: self.first + hit.primitive, ..*hit })
    }
}
