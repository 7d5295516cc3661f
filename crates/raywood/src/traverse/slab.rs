//! The ray-box test by slabs: Kay and Kajiya 1986, made conservative after Ize, "Robust BVH Ray Traversal", JCGT 2013.

use crate::structures::Node;
use crate::{Aabb, PreparedRay, PrimitiveHit, Vec3};

/// By how much of itself the far distance is lengthened, so that rounding never makes a ray miss a box whose content it hits,
/// and so that an equally near hit in another box is still found. 2^-20, eight units in the last place; Ize needs two.
pub(crate) const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// The distance up to which boxes must be looked into when hits count up to `far`.
#[inline]
pub(crate) fn lengthened(far: f32) -> f32 {
    far + far.abs() * SLACK
}

/// The distance at which the ray enters the node's box, or `None` if it misses it or comes there only after `t_max`.
#[inline]
pub(crate) fn entry(ray: &PreparedRay, t_max: f32, node: &Node) -> Option<f32> {
    let (near, far) = overlap(ray, t_max, |which| node.corner(which));
    (near <= lengthened(far)).then_some(near)
}

/// The hit with a primitive as every traversal sees it: `None` if the ray misses the primitive's own box, else with the
/// distance brought into the interval over which the ray is inside that box.
///
/// This makes the answer independent of the tree. Rounding may put a hit on a large triangle before the box that holds it, and
/// whether such a hit is found would depend on what else was found earlier; after this no hit lies before any box around its
/// primitive, for the slab test never enters an outer box later than an inner one.
#[inline]
pub(crate) fn inside_own_bounds(
    ray: &PreparedRay,
    hit: PrimitiveHit,
    bounds: &Aabb,
) -> Option<PrimitiveHit> {
    let (near, far) =
        overlap(ray, ray.t_max, |which| if which == 0 { &bounds.min } else { &bounds.max });
    let t = hit.t.min(far).max(near);
    (near <= lengthened(far) && ray.accepts(t)).then_some(PrimitiveHit { t, ..hit })
}

/// The part of the interval from `t_min` to `t_max` inside a box, given by its corners of smallest (0) and largest (1)
/// coordinates; empty (near beyond far) if there is none.
#[inline]
pub(crate) fn overlap<'a>(
    ray: &PreparedRay,
    t_max: f32,
    corner: impl Fn(usize) -> &'a Vec3,
) -> (f32, f32) {
    // A ray that runs along a slab's face gives NaN (zero times infinity); comparing so that NaN loses lets the other axes
    // decide, which keeps the face part of the box.
    let max = |x: f32, acc: f32| if x > acc { x } else { acc };
    let min = |x: f32, acc: f32| if x < acc { x } else { acc };
    let (mut near, mut far) = (ray.t_min, t_max);
    for axis in 0..3 {
        let entry_corner = ray.entry_corner(axis);
        let to_plane =
            |which: usize| (corner(which)[axis] - ray.origin[axis]) * ray.reciprocal[axis];
        near = max(to_plane(entry_corner), near);
        far = min(to_plane(1 - entry_corner), far);
    }
    (near, far)
}
