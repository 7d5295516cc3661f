//! What rays can hit: the trait [`Geometry`] and the kinds of it that come with the library, one per file.

mod around_axis;
mod assembly;
mod block_distances;
mod boxes;
mod buffers;
mod candidates;
mod capsules;
mod chord;
mod clip;
mod closest_point;
mod crossing;
mod cut;
mod cylinders;
mod discs;
mod frustum_faces;
mod joined;
mod mesh_part;
mod mesh_view;
mod of_triangles;
mod orientation;
mod prepared_ray;
mod quads;
mod separation;
mod shape_error;
mod spheres;
mod strided;
mod surface;
mod swept_sphere;
mod triangle_block;
mod triangle_mesh;
mod triangle_pair;
mod watertight;

pub use assembly::Assembly;
pub(crate) use block_distances::{Frame, squared_distances_of};
pub use boxes::Boxes;
pub use buffers::{IndexNumber, Indices, Vertices};
pub(crate) use candidates::Candidates;
pub use capsules::{Capsule, Capsules};
pub(crate) use clip::round_down;
pub use closest_point::PrimitivePoint;
pub(crate) use closest_point::{closest_on_triangle, closest_to_zero};
pub(crate) use crossing::{cross_triangle, meets_front};
pub(crate) use cut::{Plane, is_left_of};
pub use cylinders::{Cylinder, Cylinders};
pub use discs::{Disc, Discs};
pub(crate) use frustum_faces::frustum_faces;
pub use joined::Joined;
pub use mesh_part::MeshPart;
pub use mesh_view::{Consecutive, MeshView};
pub(crate) use orientation::{Side, Sides};
pub use prepared_ray::PreparedRay;
pub use quads::Quads;
pub(crate) use separation::triangle_overlaps;
pub use shape_error::{ShapeError, ShapeProblem};
pub use spheres::{Spheres, SpheresError};
pub use strided::{Strided, StridedError};
pub use surface::SurfacePoint;
pub(crate) use swept_sphere::swept_sphere;
pub(crate) use triangle_block::{BlockHits, LANES, TriangleBlock};
pub use triangle_mesh::{MeshError, TriangleMesh};
pub(crate) use triangle_mesh::{are_below, are_finite, check_count};
pub(crate) use triangle_pair::{SLACK as TOUCH_SLACK, triangles_touch, triangles_touch_in_double};

use std::sync::Arc;

use crate::{Aabb, Hit, Ray, Vec3};

/// Where a ray meets one primitive: the part of a [`Hit`] that the primitive itself can tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveHit {
    /// Distance along the ray, in units of the direction's length.
    pub t: f32,
    /// First surface coordinate.
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
}

/// A numbered set of primitives that can be bounded and intersected: all that an acceleration structure asks for.
///
/// Implement it for a type of your own and every structure, traversal and batch works with it. The primitives must
/// not change while a structure is built over them. References, `Box` and `Arc` hand everything on to what they point to, `dyn Geometry` too.
pub trait Geometry: Sync {
    /// How many primitives there are; they are numbered from 0. Structures take at most 2^31.
    fn len(&self) -> usize;

    /// Whether there are no primitives at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A box around the primitive. It must be finite and must hold every point that [`intersect`](Self::intersect)
    /// can report.
    fn bounds(&self, primitive: u32) -> Aabb;

    /// Whether all boxes are known to be finite and not empty, so that nobody need look before a tree [takes them on](crate::Bvh::refit). The default
    /// does not know.
    fn has_sound_bounds(&self) -> bool {
        false
    }

    /// A box around the part of the primitive that lies in `cell`; empty if no part does. For structures that divide space.
    ///
    /// It must lie within the primitive's bounds and hold every point that [`intersect`](Self::intersect) can report in the
    /// cell. The default is the overlap of the primitive's bounds with the cell; a tighter box makes tighter structures.
    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        self.bounds(primitive).intersection(cell)
    }

    /// The corners of the primitive if it is a triangle whose hits are those of a [`TriangleMesh`], so that fast structures can keep it in a form
    /// of their own and test several at once. The default says that it is none.
    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        let _ = primitive;
        None
    }

    /// Asks for what [`bounds`](Self::bounds) and [`triangle`](Self::triangle) will read first of a primitive to be fetched from memory: builds
    /// do so some primitives ahead where these lie all over the memory. It changes nothing but how long that takes. The default does nothing.
    fn prefetch(&self, primitive: u32) {
        let _ = primitive;
    }

    /// The same for what they read next, where that follows from what was read first: asked for some time after [`prefetch`](Self::prefetch). The default does nothing.
    fn prefetch_rest(&self, primitive: u32) {
        let _ = primitive;
    }

    /// The centre and radius of a ball that holds the primitive, so that rays that pass by it need not ask [`intersect`](Self::intersect). Not asked of
    /// [triangles](Self::triangle).
    ///
    /// The line of a ray for which `intersect` reports a hit must pass through the ball, or by it by no more than a rounding of its distance from the ray's
    /// origin. The default knows of none, and every ray asks.
    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        let _ = primitive;
        None
    }

    /// Whether a part of the primitive may lie in `cell`: what structures that divide space ask most often.
    ///
    /// It must hold wherever [`clipped_bounds`](Self::clipped_bounds) would have to hold a point, and may hold elsewhere. The default clips; a
    /// geometry that can tell sooner makes builds faster.
    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        !self.clipped_bounds(primitive, cell).is_empty()
    }

    /// The nearest hit of the ray with this primitive at `ray.t_min <= t < ray.t_max`, if any.
    ///
    /// `t` must be a number and inside the interval; a caller may rely on it.
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit>;

    /// The point of the primitive that is closest to `point`, which is finite; `None` if that cannot be told.
    ///
    /// Queries about what is near, such as [`Bvh::closest_point`](crate::Bvh::closest_point), see no primitive of which it cannot be told. The point must lie in
    /// the primitive's bounds. Where [`triangle`](Self::triangle) tells of corners, these count and this is not asked. The default knows triangles and nothing
    /// else.
    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        Some(closest_on_triangle(point, self.triangle(primitive)?))
    }

    /// How often the primitive's surface goes around a finite point, counted with sign, parts of a whole for an open one: for [`Bvh::solid`](crate::Bvh::solid). Of one that is no
    /// [`triangle`](Self::triangle) it must be 0 at all points outside of its bounds, as it is for closed surfaces. It is not asked of triangles. The default is 0.
    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        let _ = (primitive, point);
        0.0
    }

    /// Tells `found` of every hit of the ray with this primitive at `ray.t_min <= t < ray.t_max`, in any order: for
    /// [all hits](crate::Bvh::all_hits).
    ///
    /// The default asks [`intersect`](Self::intersect) again from just beyond each hit, at most 16 times. A primitive that a ray crosses more often, or that
    /// can tell all at once, should say so itself. Not asked of [triangles](Self::triangle), which a ray crosses once.
    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        let mut rest = *ray;
        for _ in 0..16 {
            let Some(hit) = self.intersect(primitive, &rest) else { return };
            found(hit);
            rest.t_min = hit.t.next_up();
            if rest.t_min >= rest.t_max {
                return;
            }
        }
    }

    /// The groups that the primitive belongs to, a bit each: a query [with a mask](crate::QueryOptions::mask) sees it if they have a bit in common. The default
    /// says all.
    fn mask(&self, primitive: u32) -> u32 {
        let _ = primitive;
        u32::MAX
    }

    /// The point that a ray hit: where it lies, how exactly that is known, and the surface's normal there.
    ///
    /// `hit` must be an answer that this geometry gave for `ray`; it may panic on a primitive that does not exist.
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint;
}

/// Has what points to a geometry hand on every question to it.
macro_rules! hand_on {
    ($([$($bound:ident)?] $pointer:ty),*) => {$(
        impl<G: Geometry + ?Sized $(+ $bound)?> Geometry for $pointer {
            #[inline(always)]
            fn len(&self) -> usize {
                (**self).len()
            }

            #[inline(always)]
            fn bounds(&self, primitive: u32) -> Aabb {
                (**self).bounds(primitive)
            }

            fn has_sound_bounds(&self) -> bool {
                (**self).has_sound_bounds()
            }

            #[inline(always)]
            fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
                (**self).clipped_bounds(primitive, cell)
            }

            #[inline(always)]
            fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
                (**self).triangle(primitive)
            }

            #[inline(always)]
            fn prefetch(&self, primitive: u32) {
                (**self).prefetch(primitive);
            }

            #[inline(always)]
            fn prefetch_rest(&self, primitive: u32) {
                (**self).prefetch_rest(primitive);
            }

            fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
                (**self).bounding_ball(primitive)
            }

            #[inline(always)]
            fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
                (**self).overlaps(primitive, cell)
            }

            #[inline(always)]
            fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
                (**self).intersect(primitive, ray)
            }

            #[inline]
            fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
                (**self).closest_point(primitive, point)
            }

            fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
                (**self).winding_number(primitive, point)
            }

            fn intersect_all(
                &self,
                primitive: u32,
                ray: &PreparedRay,
                found: &mut dyn FnMut(PrimitiveHit),
            ) {
                (**self).intersect_all(primitive, ray, found);
            }

            fn mask(&self, primitive: u32) -> u32 {
                (**self).mask(primitive)
            }

            #[inline(always)]
            fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
                (**self).surface_point(ray, hit)
            }
        }
    )*};
}

hand_on!([] &G, [] Box<G>, [Send] Arc<G>);
