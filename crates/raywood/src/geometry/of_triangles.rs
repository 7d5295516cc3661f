//! What kinds of geometry that are made of triangles have in common.

/// The methods of [`Geometry`](super::Geometry) that follow from the corners of a triangle, which `self.corners(primitive)` tells and of which all are finite.
macro_rules! methods_of_triangles {
    () => {
        #[inline(always)]
        fn bounds(&self, primitive: u32) -> $crate::Aabb {
            let [a, b, c] = self.corners(primitive);
            $crate::Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
        }

        fn has_sound_bounds(&self) -> bool {
            // Corners are finite, as was checked when it was made.
            true
        }

        fn clipped_bounds(&self, primitive: u32, cell: &$crate::Aabb) -> $crate::Aabb {
            $crate::geometry::clip::clipped_triangle_bounds(self.corners(primitive), cell)
        }

        #[inline(always)]
        fn triangle(&self, primitive: u32) -> Option<[$crate::Vec3; 3]> {
            Some(self.corners(primitive))
        }

        fn overlaps(&self, primitive: u32, cell: &$crate::Aabb) -> bool {
            $crate::geometry::triangle_overlaps(self.corners(primitive), cell)
        }

        #[inline(always)]
        fn intersect(
            &self,
            primitive: u32,
            ray: &$crate::PreparedRay,
        ) -> Option<$crate::PrimitiveHit> {
            let [p0, p1, p2] = self.corners(primitive);
            $crate::geometry::watertight::intersect_triangle(ray, p0, p1, p2)
        }

        #[inline(always)]
        fn surface_point(&self, _ray: &$crate::Ray, hit: &$crate::Hit) -> $crate::SurfacePoint {
            $crate::SurfacePoint::on_triangle(self.corners(hit.primitive), hit.u, hit.v)
        }
    };
}

pub(super) use methods_of_triangles;
