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
        let mut answer =
            BlockHits { hit: 0, doubtful: 0, t: [0.0; LANES], u: [0.0; LANES], v: [0.0; LANES] };
        let number = |x: f32| simd.splat8(x);

        // Move and shear the vertices.
        let slopes = [number(ray.shear[0]), number(ray.shear[1])];
        let origin = ray.permuted_origin.map(number);
        let sheared = |corner: usize| {
            let [x, y, z] =
                [0, 1, 2].map(|k| simd.load8(&self.corners[corner][ray.axes[k]]) - origin[k]);
            [x - slopes[0] * z, y - slopes[1] * z, z]
        };
        let (a, b, c) = (sheared(0), sheared(1), sheared(2));

        // The edge functions, and what their signs can be trusted to say.
        let e0 = c[0] * b[1] - c[1] * b[0];
        let e1 = a[0] * c[1] - a[1] * c[0];
        let e2 = b[0] * a[1] - b[1] * a[0];
        let least = e0.smaller(e1).smaller(e2);
        let greatest = e0.larger(e1).larger(e2);
        let across = [a[0], a[1], b[0], b[1], c[0], c[1]]
            .into_iter()
            .fold(number(0.0), |largest, x| x.abs().larger(largest));
        let along =
            [a[2], b[2], c[2]].into_iter().fold(number(0.0), |largest, x| x.abs().larger(largest));
        let edge_error = number(EDGE_ERROR) * across * (across + along) + number(f32::MIN_POSITIVE);
        let negative_error = number(0.0) - edge_error;
        let below = least.less(negative_error);
        let above = edge_error.less(greatest);
        let possible = lanes & !(below & above);
        if possible == 0 {
            return answer;
        }
        let determinant = e0 + e1 + e2;
        let size = determinant.abs();
        let certain = edge_error.less(least) | greatest.less(negative_error);
        let trusted = number(LEAST_DETERMINANT).less_or_equal(size)
            & size.less_or_equal(number(GREATEST_DETERMINANT));
        let inside = possible & certain & trusted;
        answer.doubtful = possible & !inside;
        if inside == 0 {
            return answer;
        }

        // The weights, the depth, and how far off it may be.
        let reciprocal = number(1.0) / determinant;
        let (w, u, v) = (e0 * reciprocal, e1 * reciprocal, e2 * reciprocal);
        let z = w * a[2] + u * b[2] + v * c[2];
        let z_error =
            number(DEPTH_ERROR) * along * (across * across * reciprocal.abs() + number(1.0));
        let inexact = (number(DISTANCE_TOLERANCE) * z.abs()).less(z_error);
        answer.doubtful |= inside & inexact;

        // A trusted distance is off by less than the tolerance: twice that beyond the limit is too far, whatever rounding did.
        let t = z * number(ray.shear[2]);
        let far_enough = limit + 2.0 * DISTANCE_TOLERANCE * limit.abs();
        let accepted = number(ray.t_min).less_or_equal(t)
            & t.less(number(ray.t_max))
            & t.less_or_equal(number(far_enough));
        answer.hit = inside & !inexact & accepted;
        (answer.t, answer.u, answer.v) = (t.to_array(), u.to_array(), v.to_array());
        answer
    }
}
