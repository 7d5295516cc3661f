//! One ray through the wide tree, with a say in which hits count.

use super::WideBvh;
use super::crossings::as_hit;
use super::node::Reference;
use super::single::SmallStack;
use super::step::{lanes, leaf_hits};
use crate::geometry::TriangleBlock;
use crate::simd::{Float, Kernel, Simd};
use crate::traverse::nearest::{Nearest, hit};
use crate::traverse::slab::inside_own_bounds;
use crate::{Geometry, Hit, PreparedRay};

/// Who says which hits count.
pub(crate) trait Chooser<H = Hit> {
    /// Whether a hit counts. Asked only of hits that would be an answer.
    fn counts(&mut self, hit: &H) -> bool;
}

/// Looks for the closest hit that counts; with `ANY`, for any.
pub(super) struct Chosen<'a, C, const ANY: bool, const FAST: bool> {
    pub(super) tree: &'a WideBvh,
    pub(super) geometry: &'a dyn Geometry,
    pub(super) ray: &'a PreparedRay,
    pub(super) limit: f32,
    pub(super) chooser: &'a mut C,
}

impl<C: Chooser, const ANY: bool, const FAST: bool> Kernel for Chosen<'_, C, ANY, FAST> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Hit> {
        let Self { tree, geometry, ray, limit, chooser } = self;
        let mut nearest = Nearest::within(ray, limit);
        let slabs = tree.slabs(ray);
        let mut stack = SmallStack::new(tree);
        let (keys, items) = stack.parts();
        let (mut top, mut current) = (1, tree.root);
        loop {
            if current == Reference::NOTHING || ANY && nearest.found() {
                return nearest.into_hit();
            }
            if current.is_leaf() {
                let block = tree.block(current);
                let limit = nearest.t_max();
                let hits = leaf_hits::<S, FAST>(simd, tree, current, ray, limit);
                let (inside, t) = if FAST {
                    (hits.hit, TriangleBlock::distances(simd, &hits))
                } else {
                    block.inside_own_bounds(simd, ray, &hits)
                };
                let t = t.to_array();
                for lane in lanes(inside) {
                    let found = as_hit(block.primitives[lane], hits.get(lane, t[lane]));
                    choose(&mut nearest, found, chooser);
                }
                for lane in lanes(hits.doubtful) {
                    choose_of(geometry, block.primitives[lane], ray, &mut nearest, chooser);
                }
            } else {
                let node = tree.node(current);
                let (met, near) = slabs.children_met(simd, node, nearest.t_max());
                top += simd.push_sorted(met, near, &node.children, (keys, items), top).0;
            }

            // On to the next that begins before the closest hit.
            let end = slabs.end_of_keys(nearest.t_max());
            current = loop {
                top -= 1;
                if keys[top] <= end {
                    break Reference(items[top]);
                }
            };
        }
    }
}

/// Takes a hit that is closer than all before, if it counts.
#[inline(always)]
fn choose<C: Chooser>(nearest: &mut Nearest, found: Hit, chooser: &mut C) {
    if nearest.is_beaten_by(found.primitive, found.t) && chooser.counts(&found) {
        nearest.take(found);
    }
}

/// Chooses among the hits with a primitive that must be tested by itself. One that is no triangle may be hit again where its closest hit does not count.
#[cold]
#[inline(never)]
fn choose_of<C: Chooser>(
    geometry: &dyn Geometry,
    primitive: u32,
    ray: &PreparedRay,
    nearest: &mut Nearest,
    chooser: &mut C,
) {
    if geometry.triangle(primitive).is_some() {
        if let Some(found) = hit(geometry, ray, primitive) {
            choose(nearest, as_hit(primitive, found), chooser);
        }
        return;
    }
    let bounds = geometry.bounds(primitive);
    geometry.intersect_all(primitive, ray, &mut |found| {
        if let Some(found) = inside_own_bounds(ray, found, &bounds) {
            choose(nearest, as_hit(primitive, found), chooser);
        }
    });
}
