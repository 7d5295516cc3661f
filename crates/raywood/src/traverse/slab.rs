//! The ray-box test by slabs: Kay and Kajiya 1986, made conservative after Ize, "Robust BVH Ray Traversal", JCGT 2013.

use crate::PreparedRay;
use crate::structures::Node;

/// By how much of itself the far distance is lengthened, so that rounding never makes a ray miss a box whose content it hits,
/// and so that an equally near hit in another box is still found. 2^-20, eight units in the last place; Ize needs two.
const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// The distance up to which boxes must be looked into when hits count up to `far`.
#[inline]
pub(super) fn lengthened(far: f32) -> f32 {
    far + far.abs() * SLACK
}

/// The distance at which the ray enters the node's box, or `None` if it misses it or comes only after the ray's end.
#[inline]
pub(super) fn entry(ray: &PreparedRay, node: &Node) -> Option<f32> {
    // A ray that runs along a slab's face gives NaN (zero times infinity); comparing so that NaN loses lets the other axes
    // decide, which keeps the face part of the box.
    let max = |x: f32, acc: f32| if x > acc { x } else { acc };
    let min = |x: f32, acc: f32| if x < acc { x } else { acc };
    let (mut near, mut far) = (ray.t_min, ray.t_max);
    for axis in 0..3 {
        let reciprocal = ray.reciprocal[axis];
        let to_min = (node.min[axis] - ray.origin[axis]) * reciprocal;
        let to_max = (node.max[axis] - ray.origin[axis]) * reciprocal;
        let backwards = reciprocal < 0.0;
        near = max(if backwards { to_max } else { to_min }, near);
        far = min(if backwards { to_min } else { to_max }, far);
    }
    (near <= lengthened(far)).then_some(near)
}
