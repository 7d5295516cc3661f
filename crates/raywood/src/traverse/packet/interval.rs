//! The box test of a whole packet by interval arithmetic: Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005;
//! conservative as in Wald, Boulos and Shirley, TOG 2007.

use crate::traverse::slab::lengthened;
use crate::{Aabb, PreparedRay};

/// Between what the numbers of a packet's rays lie.
pub(super) struct Interval {
    origins: Aabb,
    reciprocals: Aabb,
    /// Per axis, which corner of a box all rays enter by; `None` if they go both ways, or one of them not at all, so that its reciprocal is
    /// infinite: then the axis bounds nothing.
    entry_corners: [Option<usize>; 3],
    t_min: f32,
}

impl Interval {
    /// Around some rays.
    pub(super) fn of<'a>(rays: impl Iterator<Item = &'a PreparedRay>) -> Self {
        let (mut origins, mut reciprocals, mut t_min) = (Aabb::EMPTY, Aabb::EMPTY, f32::INFINITY);
        for ray in rays {
            origins = origins.including(ray.origin);
            reciprocals = reciprocals.including(ray.reciprocal);
            t_min = t_min.min(ray.t_min);
        }
        let entry_corners = [0, 1, 2].map(|axis| {
            let (least, most) = (reciprocals.min[axis], reciprocals.max[axis]);
            let bounded = least.is_finite() && most.is_finite() && (least > 0.0) == (most > 0.0);
            bounded.then_some(usize::from(least < 0.0))
        });
        Self { origins, reciprocals, entry_corners, t_min }
    }

    /// Whether no ray that ends at `t_max` or sooner can enter the box. Never true if the slab test of one of them finds that it does: this is
    /// the slab test with every operand at that end of its interval that makes a hit likelier, and rounding is monotone.
    #[inline]
    pub(super) fn misses(&self, t_max: f32, bounds: &Aabb) -> bool {
        let (mut near, mut far) = (self.t_min, t_max);
        for axis in 0..3 {
            let Some(entry_corner) = self.entry_corners[axis] else { continue };
            let corners = [bounds.min[axis], bounds.max[axis]];
            near = near.max(self.to_plane(axis, corners[entry_corner])[0]);
            far = far.min(self.to_plane(axis, corners[1 - entry_corner])[1]);
        }
        // NaN, where all rays end before they begin, is a miss.
        let enters = near <= lengthened(far);
        !enters
    }

    /// Between which distances the rays reach a plane across an axis that bounds them. Infinite where a difference overflows, but never NaN:
    /// these reciprocals are neither zero nor infinite.
    #[inline]
    fn to_plane(&self, axis: usize, plane: f32) -> [f32; 2] {
        let [least, most] = [self.reciprocals.min[axis], self.reciprocals.max[axis]];
        let [near, far] = [plane - self.origins.max[axis], plane - self.origins.min[axis]];
        let (a, b, c, d) = (near * least, near * most, far * least, far * most);
        [a.min(b).min(c.min(d)), a.max(b).max(c.max(d))]
    }
}
