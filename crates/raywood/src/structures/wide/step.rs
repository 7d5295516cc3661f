//! The two steps of a traversal: a ray against the children of a node, and against the primitives of a leaf.

use super::WideBvh;
use super::node::{Reference, WideNode};
use crate::geometry::BlockHits;
use crate::simd::{Float, Simd};
use crate::traverse::nearest::{Nearest, blocks};
use crate::traverse::slab::{SLACK, inside_own_bounds};
use crate::{Geometry, PreparedRay};

/// The children that the ray meets up to `limit`, as a set of lanes, and where it enters the box of each: the slab test of the binary tree, with the
/// same roundings.
#[inline(always)]
pub(super) fn children_met<S: Simd>(
    simd: S,
    node: &WideNode,
    ray: &PreparedRay,
    limit: f32,
) -> (u32, S::F16) {
    let (mut near, mut far) = (simd.splat16(ray.t_min), simd.splat16(limit));
    for axis in 0..3 {
        let (origin, reciprocal) =
            (simd.splat16(ray.origin[axis]), simd.splat16(ray.reciprocal[axis]));
        let side = ray.entry_corners[axis] & 1;
        let entry = (simd.load16(&node.planes[2 * axis + side]) - origin) * reciprocal;
        let exit = (simd.load16(&node.planes[2 * axis + 1 - side]) - origin) * reciprocal;
        // NaN, for a ray in the plane of a face, leaves the others to decide.
        near = entry.larger(near);
        far = exit.smaller(far);
    }
    let end = far + far.abs() * simd.splat16(SLACK);
    (near.less_or_equal(end), near)
}

/// What the vector test says of the primitives of a leaf: triangles that are certainly hit no further than `limit`, and in
/// [`doubtful`](BlockHits::doubtful) all that must be tested one by one.
#[inline(always)]
pub(super) fn leaf_hits<S: Simd, G: Geometry>(
    simd: S,
    tree: &WideBvh,
    geometry: &G,
    leaf: Reference,
    ray: &PreparedRay,
    limit: f32,
) -> BlockHits {
    let block = &tree.blocks[leaf.index()];
    let others = others(geometry, &block.primitives, leaf);
    let mut hits = block.intersect(simd, ray, leaf.lanes() & !others, limit);
    hits.doubtful |= others;
    hits
}

/// Takes the hits of a leaf that the vector test found.
#[inline(always)]
pub(super) fn take_closest<G: Geometry>(
    tree: &WideBvh,
    geometry: &G,
    leaf: Reference,
    hits: &BlockHits,
    ray: &PreparedRay,
    nearest: &mut Nearest,
) {
    let block = &tree.blocks[leaf.index()];
    for lane in lanes(hits.hit) {
        if let Some(hit) = inside_own_bounds(ray, hits.get(lane), &block.bounds(lane)) {
            nearest.offer(block.primitives[lane], hit);
        }
    }
    for lane in lanes(hits.doubtful) {
        nearest.test(geometry, ray, block.primitives[lane]);
    }
}

/// Whether any of the hits of a leaf that the vector test found blocks the ray.
#[inline(always)]
pub(super) fn any_blocks<G: Geometry>(
    tree: &WideBvh,
    geometry: &G,
    leaf: Reference,
    hits: &BlockHits,
    ray: &PreparedRay,
) -> bool {
    let block = &tree.blocks[leaf.index()];
    let inside = |lane| inside_own_bounds(ray, hits.get(lane), &block.bounds(lane)).is_some();
    lanes(hits.hit).any(inside)
        || lanes(hits.doubtful).any(|lane| blocks(geometry, ray, block.primitives[lane]))
}

/// The lanes of a leaf that hold primitives which are no triangles.
#[inline(always)]
fn others<G: Geometry>(geometry: &G, primitives: &[u32], leaf: Reference) -> u32 {
    if !leaf.is_mixed() {
        return 0;
    }
    let is_other = |lane: &usize| geometry.triangle(primitives[*lane]).is_none();
    lanes(leaf.lanes()).filter(is_other).fold(0, |set, lane| set | 1 << lane)
}

/// The lanes of a set.
#[inline(always)]
fn lanes(set: u32) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (lane < u32::BITS).then_some(lane as usize)
    })
}
