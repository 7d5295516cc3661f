//! The two steps of a traversal: a ray against the children of a node, and against the primitives of a leaf.

use super::WideBvh;
use super::balls::balls_met;
use super::node::Reference;
use crate::geometry::{BlockHits, LANES, TriangleBlock};
use crate::simd::Simd;
use crate::traverse::nearest::{Nearest, blocks};
use crate::{Geometry, PreparedRay};

/// What the vector test says of the primitives of a leaf: triangles that are certainly hit no further than `limit`, and in
/// [`doubtful`](BlockHits::doubtful) all that must be tested one by one.
#[inline(always)]
pub(super) fn leaf_hits<S: Simd, const FAST: bool>(
    simd: S,
    tree: &WideBvh,
    leaf: Reference,
    ray: &PreparedRay,
    limit: f32,
) -> BlockHits {
    let block = tree.block(leaf);
    let others = others(block, leaf);
    let triangles = leaf.lanes() & !others;
    let mut hits = if FAST {
        block.intersect_fast(simd, ray, triangles, limit)
    } else {
        block.intersect(simd, ray, triangles, limit)
    };
    if others != 0 {
        hits.doubtful |= balls_met(simd, block, others, ray);
    }
    hits
}

/// Takes the closest hit of a leaf that the vector test found, and tells whether there was one closer than all before.
#[inline(always)]
pub(super) fn take_closest<S: Simd, const FAST: bool>(
    simd: S,
    tree: &WideBvh,
    geometry: &dyn Geometry,
    leaf: Reference,
    hits: &BlockHits,
    ray: &PreparedRay,
    nearest: &mut Nearest,
) -> bool {
    let block = tree.block(leaf);
    let before = nearest.t_max();
    let (inside, t) = if FAST {
        (hits.hit, TriangleBlock::distances(simd, hits))
    } else {
        block.inside_own_bounds(simd, ray, hits)
    };
    let (least, at) = simd.least8(inside, t);
    for lane in lanes(at) {
        nearest.offer(block.primitives[lane], hits.get(lane, least));
    }
    if hits.doubtful != 0 {
        test_doubtful(geometry, ray, &block.primitives, hits.doubtful, nearest);
    }
    nearest.t_max() < before
}

/// Tests the doubtful lanes of a block one by one.
#[cold]
#[inline(never)]
fn test_doubtful(
    geometry: &dyn Geometry,
    ray: &PreparedRay,
    primitives: &[u32; LANES],
    doubtful: u32,
    nearest: &mut Nearest,
) {
    for lane in lanes(doubtful) {
        nearest.test(geometry, ray, primitives[lane]);
    }
}

/// Whether any of the hits of a leaf that the vector test found blocks the ray.
#[inline(always)]
pub(super) fn any_blocks<S: Simd, const FAST: bool>(
    simd: S,
    tree: &WideBvh,
    geometry: &dyn Geometry,
    leaf: Reference,
    hits: &BlockHits,
    ray: &PreparedRay,
) -> bool {
    let block = tree.block(leaf);
    let inside = if FAST { hits.hit } else { block.inside_own_bounds(simd, ray, hits).0 };
    inside != 0
        || hits.doubtful != 0 && doubtful_blocks(geometry, ray, &block.primitives, hits.doubtful)
}

/// Whether one of the doubtful lanes of a block blocks the ray.
#[cold]
#[inline(never)]
fn doubtful_blocks(
    geometry: &dyn Geometry,
    ray: &PreparedRay,
    primitives: &[u32; LANES],
    doubtful: u32,
) -> bool {
    lanes(doubtful).any(|lane| blocks(geometry, ray, primitives[lane]))
}

/// The lanes of a leaf that hold primitives which are no triangles.
#[inline(always)]
pub(super) fn others(block: &TriangleBlock, leaf: Reference) -> u32 {
    if leaf.is_mixed() { block.others() & leaf.lanes() } else { 0 }
}

/// The lanes of a set.
#[inline(always)]
pub(super) fn lanes(set: u32) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (lane < u32::BITS).then_some(lane as usize)
    })
}
