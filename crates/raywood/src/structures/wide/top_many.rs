//! Many rays together through a tree over boxes: what several of them reach is looked into once for all of these.
//!
//! Each node hands on to its children lists of the rays that meet them, as in streams of rays (Barringer and Akenine-Moeller, "Dynamic Ray Stream Traversal", SIGGRAPH 2014). Coherent rays so
//! arrive at the entries as large groups; where only few are left each goes on alone, in its own order.

use std::ops::ControlFlow;

use super::node::WIDTH;
use super::slabs::{Slabs, end_of_keys};
use super::top::{TopTree, walk_below};
use crate::PreparedRay;
use crate::simd::{Float, Kernel, Simd, SimdLevel, dispatch_on};

/// Fewer rays than this go on one by one.
const FEWEST: usize = 8;

/// Looks into entries. Limits are the distances beyond which nothing counts any more; of rays that are done it is [`DONE`].
pub(crate) trait Visitor {
    /// Has a ray look into an entry; returns its limit from there on.
    fn one(&mut self, entry: u32, ray: u32, limit: f32) -> f32;

    /// Has several rays, at least [`FEWEST`], look into an entry, and lowers their limits.
    fn several(&mut self, entry: u32, rays: &[u32], limits: &mut [f32]);
}

/// The limit of a ray for which nothing counts any more.
pub(crate) const DONE: f32 = f32::NEG_INFINITY;

/// What waits to be looked into: by which rays is in the list from `start` on.
struct Waiting {
    item: u32,
    start: usize,
}

/// A ray on the way to a box, and where it enters that at the earliest.
#[derive(Clone, Copy)]
struct Rider {
    ray: u32,
    near: f32,
}

impl TopTree {
    /// Has `visitor` look into every entry that rays may meet before their limits when all boxes are larger by their margins, those that begin first mostly first. Rays that are `None` meet
    /// nothing.
    pub(crate) fn walk_many<V: Visitor>(
        &self,
        level: SimdLevel,
        rays: &[Option<(PreparedRay, f32)>],
        visitor: V,
    ) {
        if self.depth() > 0 {
            dispatch_on(level, WalkMany { tree: self, rays, visitor });
        }
    }
}

struct WalkMany<'a, V> {
    tree: &'a TopTree,
    rays: &'a [Option<(PreparedRay, f32)>],
    visitor: V,
}

impl<V: Visitor> Kernel for WalkMany<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, rays, mut visitor } = self;
        let mut slabs = Vec::with_capacity(rays.len());
        let mut limits = Vec::with_capacity(rays.len());
        let mut riders = Vec::with_capacity(2 * rays.len());
        for (ray, prepared) in (0..).zip(rays) {
            let Some((prepared, margin)) = prepared else {
                // In its place, so that numbers stay those of rays.
                slabs.push(Slabs::NONE);
                limits.push(DONE);
                continue;
            };
            slabs.push(tree.slabs(prepared, *margin));
            limits.push(prepared.t_max);
            riders.push(Rider { ray, near: prepared.t_min });
        }

        let mut stack = vec![Waiting { item: 0, start: 0 }];
        let mut active = Vec::with_capacity(riders.len());
        let mut lanes: [Vec<Rider>; WIDTH] = Default::default();
        while let Some(Waiting { item, start }) = stack.pop() {
            // Those for which it still counts. What is compared to the limit of a ray that is done is NaN.
            active.clear();
            let counts = |rider: &&Rider| rider.near <= end_of_keys(limits[rider.ray as usize]);
            active.extend(riders[start..].iter().filter(counts).map(|rider| rider.ray));
            riders.truncate(start);

            if active.len() < FEWEST {
                for &ray in &active {
                    let place = ray as usize;
                    let mut left = limits[place];
                    let _ = walk_below(simd, tree, &slabs[place], item, left, |entry, limit| {
                        left = visitor.one(entry, ray, limit);
                        if left == DONE {
                            ControlFlow::Break(())
                        } else {
                            ControlFlow::Continue(left)
                        }
                    });
                    limits[place] = left;
                }
                continue;
            }
            if item & 1 == 1 {
                visitor.several(item >> 1, &active, &mut limits);
                continue;
            }

            let node = tree.node(item >> 1);
            lanes.iter_mut().for_each(Vec::clear);
            let mut nearest = [f32::INFINITY; WIDTH];
            for &ray in &active {
                let (mut met, near) =
                    slabs[ray as usize].children_met(simd, node, limits[ray as usize]);
                let near = near.to_array();
                while met != 0 {
                    let lane = met.trailing_zeros() as usize % WIDTH;
                    met &= met - 1;
                    lanes[lane].push(Rider { ray, near: near[lane] });
                    nearest[lane] = nearest[lane].min(near[lane]);
                }
            }

            // Those that begin last lie deepest.
            let mut order = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
            order.sort_unstable_by(|&a, &b| nearest[b].total_cmp(&nearest[a]));
            for lane in order {
                if !lanes[lane].is_empty() {
                    stack.push(Waiting { item: node.children[lane], start: riders.len() });
                    riders.extend_from_slice(&lanes[lane]);
                }
            }
        }
    }
}
