//! Eight triangles tested against a ray at once, with the answers of the one test in `watertight.rs`, to the bit.

use super::watertight::{
    DEPTH_ERROR, DISTANCE_TOLERANCE, EDGE_ERROR, GREATEST_DETERMINANT, LEAST_DETERMINANT,
};
use super::{PreparedRay, PrimitiveHit};
use crate::simd::{Float, Simd};
use crate::{Aabb, Vec3};

/// How many triangles a block holds.
pub(crate) const LANES: usize = 8;

/// Eight triangles, coordinate by coordinate, and their numbers: five cache lines.
///
/// Lanes without a triangle hold zeros; which these are is known to whoever refers to the block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// For each corner and axis the coordinates of all triangles.
    corners: [[[f32; LANES]; 3]; 3],
    /// The primitives' numbers.
    pub(crate) primitives: [u32; LANES],
}

const _: () = assert!(size_of::<TriangleBlock>() == 320);

/// What single precision says of a ray and eight triangles.
pub(crate) struct BlockHits {
    /// The lanes that are certainly hit within the ray's interval.
    pub(crate) hit: u32,
    /// The lanes about which single precision cannot be trusted.
    pub(crate) doubtful: u32,
    t: [f32; LANES],
    u: [f32; LANES],
    v: [f32; LANES],
}

impl BlockHits {
    /// Nothing is hit.
    pub(crate) const NONE: Self =
        Self { hit: 0, doubtful: 0, t: [0.0; LANES], u: [0.0; LANES], v: [0.0; LANES] };

    /// The hit in a lane that is certainly hit.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> PrimitiveHit {
        PrimitiveHit { t: self.t[lane], u: self.u[lane], v: self.v[lane] }
    }
}

impl TriangleBlock {
    /// Puts a triangle into a lane.
    pub(crate) fn set(&mut self, lane: usize, primitive: u32, corners: [Vec3; 3]) {
        self.primitives[lane] = primitive;
        for (corner, point) in self.corners.iter_mut().zip(corners) {
            for (axis, coordinate) in corner.iter_mut().zip(point.to_array()) {
                axis[lane] = coordinate;
            }
        }
    }

    /// The corners of the triangle in a lane.
    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [Vec3; 3] {
        self.corners
            .each_ref()
            .map(|corner| Vec3::new(corner[0][lane], corner[1][lane], corner[2][lane]))
    }

    /// The box around the triangle in a lane.
    #[inline(always)]
    pub(crate) fn bounds(&self, lane: usize) -> Aabb {
        let [a, b, c] = self.corners(lane);
        Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// The corners of one number, moved and sheared as `watertight.rs` does it.
    #[inline(always)]
    fn sheared<S: Simd>(&self, simd: S, ray: &PreparedRay, corner: usize) -> [S::F8; 3] {
        let corner = &self.corners[corner];
        let x = simd.load8(&corner[ray.axes[0]]) - simd.splat8(ray.permuted_origin[0]);
        let y = simd.load8(&corner[ray.axes[1]]) - simd.splat8(ray.permuted_origin[1]);
        let z = simd.load8(&corner[ray.axes[2]]) - simd.splat8(ray.permuted_origin[2]);
        [x - simd.splat8(ray.shear[0]) * z, y - simd.splat8(ray.shear[1]) * z, z]
    }

    /// Tests the triangles in the given lanes: the steps of `intersect_triangle`, each operation the same, in the same order, so that the numbers are
    /// the same. Doubtful lanes are left to it. Hits that are clearly beyond `limit` are left out.
    #[inline(always)]
    pub(crate) fn intersect<S: Simd>(
        &self,
        simd: S,
        ray: &PreparedRay,
        lanes: u32,
        limit: f32,
    ) -> BlockHits {
        // Move and shear the vertices.
        let (a, b, c) =
            (self.sheared(simd, ray, 0), self.sheared(simd, ray, 1), self.sheared(simd, ray, 2));

        // The edge functions, and what their signs can be trusted to say.
        let e0 = c[0] * b[1] - c[1] * b[0];
        let e1 = a[0] * c[1] - a[1] * c[0];
        let e2 = b[0] * a[1] - b[1] * a[0];
        let least = e0.smaller(e1).smaller(e2);
        let greatest = e0.larger(e1).larger(e2);
        let across = a[0].abs().larger(simd.splat8(0.0));
        let across = b[0].abs().larger(a[1].abs().larger(across));
        let across = c[0].abs().larger(b[1].abs().larger(across));
        let across = c[1].abs().larger(across);
        let along = a[2].abs().larger(simd.splat8(0.0));
        let along = c[2].abs().larger(b[2].abs().larger(along));
        let edge_error =
            simd.splat8(EDGE_ERROR) * across * (across + along) + simd.splat8(f32::MIN_POSITIVE);
        let negative_error = simd.splat8(0.0) - edge_error;
        let below = least.less(negative_error);
        let above = edge_error.less(greatest);
        let possible = lanes & !(below & above);
        let determinant = e0 + e1 + e2;
        let size = determinant.abs();
        let certain = edge_error.less(least) | greatest.less(negative_error);
        let trusted = simd.splat8(LEAST_DETERMINANT).less_or_equal(size)
            & size.less_or_equal(simd.splat8(GREATEST_DETERMINANT));
        let inside = possible & certain & trusted;

        // The weights, the depth, and how far off it may be.
        let reciprocal = simd.splat8(1.0) / determinant;
        let (w, u, v) = (e0 * reciprocal, e1 * reciprocal, e2 * reciprocal);
        let z = w * a[2] + u * b[2] + v * c[2];
        let z_error = simd.splat8(DEPTH_ERROR)
            * along
            * (across * across * reciprocal.abs() + simd.splat8(1.0));
        let inexact = (simd.splat8(DISTANCE_TOLERANCE) * z.abs()).less(z_error);

        // A trusted distance is off by less than the tolerance: twice that beyond the limit is too far, whatever rounding did.
        let t = z * simd.splat8(ray.shear[2]);
        let far_enough = limit + 2.0 * DISTANCE_TOLERANCE * limit.abs();
        let accepted = simd.splat8(ray.t_min).less_or_equal(t)
            & t.less(simd.splat8(ray.t_max))
            & t.less_or_equal(simd.splat8(far_enough));
        BlockHits {
            hit: inside & !inexact & accepted,
            doubtful: possible & !(inside & !inexact),
            t: t.to_array(),
            u: u.to_array(),
            v: v.to_array(),
        }
    }
}
