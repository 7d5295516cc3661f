//! Which triangles of a block a ray may hit, where ray and triangles are rounded from double precision, which decides.

use super::watertight::EDGE_ERROR;
use super::{LANES, PreparedRay, TriangleBlock};
use crate::simd::{Float, Simd};

/// The triangles of a block that a ray may hit.
#[derive(Clone, Copy)]
pub(crate) struct Candidates {
    /// Their lanes.
    pub(crate) lanes: u32,
    /// At which distance the ray hits them at the earliest, if it does.
    pub(crate) near: [f32; LANES],
}

impl Candidates {
    /// None.
    pub(crate) const NONE: Self = Self { lanes: 0, near: [0.0; LANES] };
}

/// An edge function's error by rounding, that of the direction's counted.
const ROUNDING_ERROR: f32 = 1.5 * EDGE_ERROR;

/// By how much of itself a depth is off besides, for its last roundings and those of the distance.
const LAST_ROUNDINGS: f32 = 8.0 * f32::EPSILON;

impl TriangleBlock {
    /// The triangles in the given lanes that a ray may hit from its start up to `limit`, where a point of the ray and one of a triangle that lie at the same place in truth
    /// may be apart by `displacement` along each axis. `docs/numerics.md`, "Double precision", derives the bounds.
    #[inline(always)]
    pub(crate) fn candidates<S: Simd>(
        &self,
        simd: S,
        ray: &PreparedRay,
        displacement: f32,
        lanes: u32,
        limit: f32,
    ) -> Candidates {
        let (a, b, c) =
            (self.sheared(simd, ray, 0), self.sheared(simd, ray, 1), self.sheared(simd, ray, 2));

        // No edge may be certain to have the ray on the other side than another edge has.
        let e0 = c[0] * b[1] - c[1] * b[0];
        let e1 = a[0] * c[1] - a[1] * c[0];
        let e2 = b[0] * a[1] - b[1] * a[0];
        let least = e0.smaller(e1).smaller(e2);
        let greatest = e0.larger(e1).larger(e2);
        let moved = simd.splat8(4.0 * displacement);
        let across = a[0].larger_magnitude(a[1]).larger_magnitude(b[0].larger_magnitude(b[1]));
        let across = across.larger_magnitude(c[0].larger_magnitude(c[1])) + moved;
        let along = a[2].larger_magnitude(b[2]).larger_magnitude(c[2]) + moved;
        let roundings = simd.splat8(ROUNDING_ERROR) * (across + along) + moved + moved;
        let edge_error = roundings * across + simd.splat8(f32::MIN_POSITIVE);
        let below = least.less(simd.splat8(0.0) - edge_error);
        let above = edge_error.less(greatest);

        // Where the plane is crossed, as far as that is known, and in any case between the nearest and the farthest corner.
        let determinant = e0 + e1 + e2;
        let reciprocal = simd.splat8(1.0) / determinant;
        let z = (e0 * a[2] + e1 * b[2] + e2 * c[2]) * reciprocal;
        let nearest = a[2].smaller(b[2]).smaller(c[2]) - moved;
        let farthest = a[2].larger(b[2]).larger(c[2]) + moved;
        let share = edge_error * reciprocal.abs();
        let z_error = simd.splat8(4.0) * share * (farthest - nearest)
            + along * simd.splat8(LAST_ROUNDINGS)
            + moved;
        // Where the errors are as large as the triangle, or that is NaN, only the corners count.
        let known = share.less(simd.splat8(1.0 / 16.0));
        let first = nearest.replaced(known, nearest.larger(z - z_error));
        let last = farthest.replaced(known, farthest.smaller(z + z_error));

        // Depth may run against the ray.
        let scale = simd.splat8(ray.shear[2]);
        let (one, other) = (first * scale, last * scale);
        let (near, far) = (one.smaller(other), one.larger(other));
        let near = near - near.abs() * simd.splat8(LAST_ROUNDINGS);
        let far = far + far.abs() * simd.splat8(LAST_ROUNDINGS);
        let here =
            simd.splat8(ray.t_min).less_or_equal(far) & near.less_or_equal(simd.splat8(limit));
        Candidates { lanes: lanes & here & !(below & above), near: near.to_array() }
    }
}
