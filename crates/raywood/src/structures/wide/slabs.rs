//! The boxes of a node against a ray by slabs (Kay and Kajiya 1986), in six fused operations: what is near to the ray's canonical box test in
//! `traverse/slab.rs`, and never narrower.
//!
//! The canonical distance of a plane is `fl(fl(plane - origin) * r)` with `r = fl(1 / direction)`; here it is `fl(plane * r - fl(origin * r))`, made
//! smaller for planes of entry and larger for those of exit. `docs/numerics.md` derives by how much, so that a box that holds the winning hit is never
//! skipped. Which hit wins is decided by the canonical test of the primitive's own box alone.

use super::node::WideNode;
use crate::build::part_margin::DISTANCE_ERROR;
use crate::geometry::{Side, Sides, TriangleBlock};
use crate::minmax::larger;
use crate::simd::{Float, Simd};
use crate::{PreparedRay, Vec3};

/// By how much of itself the product of origin and reciprocal is moved away from the box. It covers two roundings, and a third where nothing is fused.
const PRODUCT_ERROR: f32 = 4.0 * f32::EPSILON;

/// By how much of itself the far distance is lengthened: the canonical test's 16 roundings, and 16 for the relative part of the difference to it.
const SLACK: f32 = 1.0 / (1 << 19) as f32;

/// Reciprocals and sizes up to this are usual: their products neither overflow nor come near to it.
const USUAL: f32 = (1u64 << 60) as f32;

/// Products of sizes and reciprocals up to this are finite with all that is added to them.
const FINITE: f32 = f32::MAX / 128.0;

/// A ray as the test of boxes needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slabs {
    reciprocal: [f32; 3],
    /// What is added to the product of a plane of entry.
    entry: [f32; 3],
    /// What is added to the product of a plane of exit.
    exit: [f32; 3],
    t_min: f32,
    /// By how much of itself the far distance is lengthened.
    slack: f32,
    /// On which side the ray enters boxes.
    sides: Sides,
}

impl Slabs {
    /// Those of no ray.
    pub(super) const NONE: Self = Self {
        reciprocal: [0.0; 3],
        entry: [f32::MAX; 3],
        exit: [f32::MIN; 3],
        t_min: f32::NAN,
        slack: SLACK,
        sides: Sides([Side::Smallest; 3]),
    };

    /// Those of a ray among boxes that reach no further from zero than `reach` along any axis.
    #[inline(always)]
    pub(super) fn new(ray: &PreparedRay, reach: f32) -> Self {
        let mut slabs = Self::with(ray, ray.reciprocal, [0.0; 3]);
        slabs.widen_if_unusual(ray, reach);
        slabs
    }

    /// Those of another ray, written in place: a copy would have to wait for them.
    #[inline(always)]
    pub(super) fn replace(&mut self, ray: &PreparedRay, reach: f32) {
        *self = Self::with(ray, ray.reciprocal, [0.0; 3]);
        self.widen_if_unusual(ray, reach);
    }

    #[inline(always)]
    fn widen_if_unusual(&mut self, ray: &PreparedRay, reach: f32) {
        let steepest = largest(ray.reciprocal.abs());
        let farthest = largest(ray.origin.abs());
        if larger(larger(steepest, farthest), reach) > USUAL {
            self.widen(ray, reach);
        }
    }

    #[inline(always)]
    fn with(ray: &PreparedRay, reciprocal: Vec3, errors: [f32; 3]) -> Self {
        let origin = ray.origin;
        let (x, y, z) = (
            offsets(origin.x, reciprocal.x, errors[0]),
            offsets(origin.y, reciprocal.y, errors[1]),
            offsets(origin.z, reciprocal.z, errors[2]),
        );
        Self {
            reciprocal: reciprocal.to_array(),
            entry: [x.0, y.0, z.0],
            exit: [x.1, y.1, z.1],
            t_min: ray.t_min,
            slack: SLACK,
            sides: ray.entry_sides,
        }
    }

    /// Makes them right for a ray that hardly moves along an axis, or whose distances may overflow.
    #[cold]
    #[inline(never)]
    fn widen(&mut self, ray: &PreparedRay, reach: f32) {
        let reciprocal = ray.reciprocal.to_array();
        let size = ray.origin.abs().max_element().max(reach);
        // No hit is further away than this, in either direction.
        let farthest = 4.0 * size * reciprocal[ray.direction.abs().max_axis()].abs();
        let usual = size <= USUAL && farthest <= USUAL;

        // Too steep: as steep as is usual, and around the slab in which the origin lies no distance is outside.
        let steep = |r: f32| r.abs() > USUAL;
        let bounded = reciprocal.map(|r| if steep(r) { USUAL.copysign(r) } else { r });
        let errors = reciprocal.map(|r| if steep(r) { 2.0 * farthest } else { 0.0 });
        *self = Self::with(ray, bounded.into(), errors);
        for (axis, r) in reciprocal.into_iter().enumerate() {
            if !usual && (steep(r) || size * r.abs() > FINITE) {
                // Nothing can be said along this axis: every box is met, but not the inverted one of a child that is not there.
                self.reciprocal[axis] = f32::MIN_POSITIVE.copysign(r);
                (self.entry[axis], self.exit[axis]) = (f32::MIN, f32::MAX);
            }
        }
    }

    /// Those of the same ray among boxes of [parts](super::parts), which count as larger by `margin` besides.
    #[inline(always)]
    pub(super) fn among_parts(self, margin: f32) -> Self {
        let mut slabs = if margin > 0.0 { self.around(margin) } else { self };
        slabs.slack = DISTANCE_ERROR;
        slabs
    }

    /// Those of the same ray among boxes that are larger by `margin` on all sides.
    pub(super) fn around(self, margin: f32) -> Self {
        self.around_each([margin; 3])
    }

    /// Those of the same ray among boxes that are larger by so much on both sides along each axis.
    pub(super) fn around_each(mut self, margins: [f32; 3]) -> Self {
        for (axis, margin) in margins.into_iter().enumerate() {
            let margin = margin + margin * PRODUCT_ERROR * 8.0;
            let wider = margin * self.reciprocal[axis].abs();
            // Finite, so that no child that is not there is met.
            self.entry[axis] = (self.entry[axis] - wider).max(f32::MIN);
            self.exit[axis] = (self.exit[axis] + wider).min(f32::MAX);
        }
        self
    }

    /// The triangles of a block whose boxes the ray may meet up to `limit`, as a set of lanes.
    #[inline(always)]
    pub(super) fn triangles_met<S: Simd>(&self, simd: S, block: &TriangleBlock, limit: f32) -> u32 {
        let (mut near, mut far) = (simd.splat8(self.t_min), simd.splat8(limit));
        for axis in 0..3 {
            let reciprocal = simd.splat8(self.reciprocal[axis]);
            let a = simd.load8(block.coordinates(0, axis));
            let b = simd.load8(block.coordinates(1, axis));
            let c = simd.load8(block.coordinates(2, axis));
            let (least, greatest) = (a.smaller(b).smaller(c), a.larger(b).larger(c));
            let backwards = matches!(self.sides.0[axis], Side::Largest);
            let entry = greatest.where_else(backwards, least);
            let exit = least.where_else(backwards, greatest);
            near = entry.mul_add(reciprocal, simd.splat8(self.entry[axis])).larger(near);
            far = exit.mul_add(reciprocal, simd.splat8(self.exit[axis])).smaller(far);
        }
        near.less_or_equal(far.abs().mul_add(simd.splat8(self.slack), far))
    }

    /// The key up to which items of a stack must be looked into when hits count up to `far`: the keys of boxes that may hold them are at most so large. Half
    /// of the allowance is for what the keys lost on the stack.
    #[inline(always)]
    pub(super) fn end_of_keys(&self, far: f32) -> f32 {
        end_with_slack(far, self.slack)
    }

    /// The children that the ray may meet up to `limit`, as a set of lanes, and where it enters the box of each, at the earliest.
    #[inline(always)]
    pub(super) fn children_met<S: Simd>(
        &self,
        simd: S,
        node: &WideNode,
        limit: f32,
    ) -> (u32, S::F16) {
        let (mut near, mut far) = (simd.splat16(self.t_min), simd.splat16(limit));
        for axis in 0..3 {
            let reciprocal = simd.splat16(self.reciprocal[axis]);
            let planes = &node.planes[axis];
            let side = self.sides.0[axis] as usize;
            let entry = simd.load16(&planes[side]);
            let exit = simd.load16(&planes[side ^ 1]);
            // NaN, where products overflow, leaves the others to decide.
            near = entry.mul_add(reciprocal, simd.splat16(self.entry[axis])).larger(near);
            far = exit.mul_add(reciprocal, simd.splat16(self.exit[axis])).smaller(far);
        }
        let end = far.abs().mul_add(simd.splat16(self.slack), far);
        (near.less_or_equal(end), near)
    }
}

/// What is added to the products of planes of entry and of exit along an axis. (A function and no closure for an array's `map`, which became a call.)
#[inline(always)]
fn offsets(origin: f32, reciprocal: f32, error: f32) -> (f32, f32) {
    let product = -(origin * reciprocal);
    let error = product.abs() * PRODUCT_ERROR + f32::MIN_POSITIVE + error;
    (product - error, product + error)
}

/// The largest coordinate of a vector without NaN.
#[inline(always)]
fn largest(v: Vec3) -> f32 {
    larger(v.x, larger(v.y, v.z))
}

/// [`Slabs::end_of_keys`] where there are no parts.
#[inline(always)]
pub(super) fn end_of_keys(far: f32) -> f32 {
    end_with_slack(far, SLACK)
}

#[inline(always)]
fn end_with_slack(far: f32, slack: f32) -> f32 {
    // The lane in the last digits of a key makes zero a little more than zero.
    far + (far.abs() * (2.0 * slack) + f32::MIN_POSITIVE)
}
