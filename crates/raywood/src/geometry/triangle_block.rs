//! Eight triangles tested against a ray at once, with the answers of the one test in `watertight.rs`, to the bit.

use super::watertight::{
    DEPTH_ERROR, DISTANCE_TOLERANCE, EDGE_ERROR, GREATEST_DETERMINANT, LEAST_DETERMINANT,
    intersect_triangle,
};
use super::{PreparedRay, PrimitiveHit};
use crate::Aabb;
use crate::Vec3;
use crate::simd::{Float, Simd};
use crate::traverse::slab::{SLACK, inside_own_bounds};

/// How many triangles a block holds.
pub(crate) const LANES: usize = 8;

/// Eight triangles, coordinate by coordinate, and their numbers: five cache lines.
///
/// Lanes without a primitive hold zeros; which these are is known to whoever refers to the block. Of a primitive that is no triangle there is a ball around it:
/// its centre in place of the first corner, its radius as the second's first coordinate; the third corner is infinitely far away, as that of no triangle is.
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
    pub(crate) fn get(&self, lane: usize, t: f32) -> PrimitiveHit {
        PrimitiveHit { t, u: self.u[lane], v: self.v[lane] }
    }
}

impl TriangleBlock {
    /// Puts a triangle into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, primitive: u32, corners: [Vec3; 3]) {
        self.primitives[lane] = primitive;
        for (corner, point) in self.corners.iter_mut().zip(corners) {
            for (axis, coordinate) in corner.iter_mut().zip(point.to_array()) {
                axis[lane] = coordinate;
            }
        }
    }

    /// Puts a primitive that is no triangle into a lane, and a ball around it.
    pub(crate) fn set_other(&mut self, lane: usize, primitive: u32, ball: Option<(Vec3, f32)>) {
        let (center, radius) = ball.unwrap_or((Vec3::ZERO, f32::INFINITY));
        let corners = [center, Vec3::new(radius, 0.0, 0.0), Vec3::splat(f32::INFINITY)];
        self.set(lane, primitive, corners);
    }

    /// The lanes that hold primitives that are no triangles.
    #[inline(always)]
    pub(crate) fn others(&self) -> u32 {
        let infinite = |lane: usize| u32::from(self.corners[2][0][lane] == f32::INFINITY) << lane;
        (0..LANES).fold(0, |set, lane| set | infinite(lane))
    }

    /// The ball around the primitive in a lane that is no triangle: its centre and radius.
    #[inline(always)]
    pub(crate) fn ball(&self, lane: usize) -> (Vec3, f32) {
        let [center, size, _] = self.corners(lane);
        (center, size.x)
    }

    /// The corners of the triangle in a lane.
    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [Vec3; 3] {
        self.corners
            .each_ref()
            .map(|corner| Vec3::new(corner[0][lane], corner[1][lane], corner[2][lane]))
    }

    /// One coordinate of the corners of one number, of all triangles.
    #[inline(always)]
    pub(crate) fn coordinates(&self, corner: usize, axis: usize) -> &[f32; LANES] {
        &self.corners[corner][axis]
    }

    /// The hit of a ray with the triangle in a lane, as every traversal sees it.
    pub(crate) fn intersect_one(&self, ray: &PreparedRay, lane: usize) -> Option<PrimitiveHit> {
        let [a, b, c] = self.corners(lane);
        inside_own_bounds(ray, intersect_triangle(ray, a, b, c)?, &self.bounds(lane))
    }

    /// The box around the triangle in a lane.
    #[inline(always)]
    pub(crate) fn bounds(&self, lane: usize) -> Aabb {
        let [a, b, c] = self.corners(lane);
        Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// The lanes whose three corners lie in a box.
    #[inline(always)]
    pub(crate) fn corners_inside<S: Simd>(&self, simd: S, bounds: &Aabb) -> u32 {
        let mut inside = 0xff;
        for corner in &self.corners {
            for (axis, coordinates) in corner.iter().enumerate() {
                let coordinates = simd.load8(coordinates);
                inside &= simd.splat8(bounds.min[axis]).less_or_equal(coordinates)
                    & coordinates.less_or_equal(simd.splat8(bounds.max[axis]));
            }
        }
        inside
    }

    /// The distances of hits.
    #[inline(always)]
    pub(crate) fn distances<S: Simd>(simd: S, hits: &BlockHits) -> S::F8 {
        simd.load8(&hits.t)
    }

    /// The hits as every traversal sees them: the steps of `inside_own_bounds` for the boxes around all triangles, each operation the same. Which lanes
    /// are left, and their distances.
    #[inline(always)]
    pub(crate) fn inside_own_bounds<S: Simd>(
        &self,
        simd: S,
        ray: &PreparedRay,
        hits: &BlockHits,
    ) -> (u32, S::F8) {
        let (t_min, t_max) = (simd.splat8(ray.t_min), simd.splat8(ray.t_max));
        let (mut near, mut far) = (t_min, t_max);
        for axis in 0..3 {
            // The least of the differences is the difference to the least: rounding is monotone.
            let origin = simd.splat8(ray.origin[axis]);
            let [a, b, c] = [
                simd.load8(&self.corners[0][axis]) - origin,
                simd.load8(&self.corners[1][axis]) - origin,
                simd.load8(&self.corners[2][axis]) - origin,
            ];
            let least = a.smaller(b).smaller(c);
            let greatest = a.larger(b).larger(c);
            let backwards = ray.entry_corner(axis) == 1;
            let reciprocal = simd.splat8(ray.reciprocal[axis]);
            near = (greatest.where_else(backwards, least) * reciprocal).larger(near);
            far = (least.where_else(backwards, greatest) * reciprocal).smaller(far);
        }
        let t = simd.load8(&hits.t).smaller(far).larger(near);
        let end = far + far.abs() * simd.splat8(SLACK);
        let inside = near.less_or_equal(end) & t_min.less_or_equal(t) & t.less(t_max);
        (hits.hit & inside, t)
    }

    /// The corners of one number, moved and sheared as `watertight.rs` does it.
    #[inline(always)]
    pub(super) fn sheared<S: Simd>(&self, simd: S, ray: &PreparedRay, corner: usize) -> [S::F8; 3] {
        let corner = &self.corners[corner];
        let [x_axis, y_axis, z_axis] = ray.axes.numbers();
        let x = simd.load8(&corner[x_axis]) - simd.splat8(ray.permuted_origin[0]);
        let y = simd.load8(&corner[y_axis]) - simd.splat8(ray.permuted_origin[1]);
        let z = simd.load8(&corner[z_axis]) - simd.splat8(ray.permuted_origin[2]);
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
        let across = a[0].larger_magnitude(a[1]).larger_magnitude(b[0].larger_magnitude(b[1]));
        let across = across.larger_magnitude(c[0].larger_magnitude(c[1]));
        let along = a[2].larger_magnitude(b[2]).larger_magnitude(c[2]);
        let reach = across + along;
        let edge_error = simd.splat8(EDGE_ERROR) * across * reach + simd.splat8(f32::MIN_POSITIVE);
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
        let shape = across * across * reciprocal.abs() + simd.splat8(1.0);
        let z_error = simd.splat8(DEPTH_ERROR) * along * shape;
        let inexact = (simd.splat8(DISTANCE_TOLERANCE) * z.abs()).less(z_error);

        // A trusted distance is off by less than the tolerance: twice that beyond the limit is too far, whatever rounding did.
        let t = z * simd.splat8(ray.shear[2]);
        let far_enough = limit + 2.0 * DISTANCE_TOLERANCE * limit.abs();
        let accepted = simd.splat8(ray.t_min).less_or_equal(t)
            & t.less(simd.splat8(ray.t_max))
            & t.less_or_equal(simd.splat8(far_enough));
        let t_error = reach * shape * simd.splat8(2.0 * DEPTH_ERROR * ray.shear[2].abs());
        let beyond = ((t + t_error).less(simd.splat8(ray.t_min))
            | simd.splat8(far_enough).less(t - t_error))
            & reach.less(across * simd.splat8(1024.0))
            & inside;
        BlockHits {
            hit: inside & !inexact & accepted,
            doubtful: possible & !(inside & !inexact) & !beyond,
            t: t.to_array(),
            u: u.to_array(),
            v: v.to_array(),
        }
    }

    /// Tests the triangles in the given lanes by Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997: rays may slip between
    /// triangles that share an edge. No lane is doubtful, and a hit needs no look at the triangle's own box.
    #[inline(always)]
    pub(crate) fn intersect_fast<S: Simd>(
        &self,
        simd: S,
        ray: &PreparedRay,
        lanes: u32,
        limit: f32,
    ) -> BlockHits {
        let corner = |corner: usize| {
            let [x, y, z] = &self.corners[corner];
            [simd.load8(x), simd.load8(y), simd.load8(z)]
        };
        let ([a, b, c], d) = ([corner(0), corner(1), corner(2)], ray.direction);
        let d = [simd.splat8(d.x), simd.splat8(d.y), simd.splat8(d.z)];
        let o = ray.origin;
        let o = [simd.splat8(o.x), simd.splat8(o.y), simd.splat8(o.z)];

        let (e1, e2, s) = (sub(b, a), sub(c, a), sub(o, a));
        let (p, q) = (cross(d, e2), cross(s, e1));
        let reciprocal = simd.splat8(1.0) / dot(e1, p);
        let (u, v, t) = (dot(s, p) * reciprocal, dot(d, q) * reciprocal, dot(e2, q) * reciprocal);
        let zero = simd.splat8(0.0);
        let hit = zero.less_or_equal(u)
            & zero.less_or_equal(v)
            & (u + v).less_or_equal(simd.splat8(1.0))
            & simd.splat8(ray.t_min).less_or_equal(t)
            & t.less(simd.splat8(ray.t_max))
            & t.less_or_equal(simd.splat8(limit));
        BlockHits {
            hit: lanes & hit,
            doubtful: 0,
            t: t.to_array(),
            u: u.to_array(),
            v: v.to_array(),
        }
    }
}

/// The difference of vectors.
#[inline(always)]
fn sub<F: Float>([ax, ay, az]: [F; 3], [bx, by, bz]: [F; 3]) -> [F; 3] {
    [ax - bx, ay - by, az - bz]
}

/// The vector product.
#[inline(always)]
fn cross<F: Float>([ax, ay, az]: [F; 3], [bx, by, bz]: [F; 3]) -> [F; 3] {
    [
        az.negated_mul_add(by, ay * bz),
        ax.negated_mul_add(bz, az * bx),
        ay.negated_mul_add(bx, ax * by),
    ]
}

/// The scalar product.
#[inline(always)]
fn dot<F: Float>([ax, ay, az]: [F; 3], [bx, by, bz]: [F; 3]) -> F {
    ax.mul_add(bx, ay.mul_add(by, az * bz))
}
