//! One walk through the wide tree for every question about space: what is near, what overlaps, what is touched first.
//!
//! What a question looks for is told by a [`Query`]: which children of a node it looks into and in which order, what it does with the primitives
//! of a leaf, and how far it still looks.

use std::ops::ControlFlow;

use super::WideBvh;
use super::node::{Reference, WideNode};
use super::single::SmallStack;
use crate::Aabb;
use crate::geometry::TriangleBlock;
use crate::simd::{Float, Simd};

/// The boxes of sixteen [children](planes), by axis and side: first the smallest, then the largest coordinates. A child that is not there has an inverted infinite
/// box.
pub(crate) type Planes = [[[f32; 16]; 2]; 3];

/// The boxes of a node's children.
#[inline(always)]
pub(crate) fn planes(node: &WideNode) -> &Planes {
    &node.planes
}

/// The primitives of a leaf.
#[derive(Clone, Copy)]
pub(crate) struct Leaf<'t> {
    /// Their numbers, and the corners of those that are triangles.
    pub(crate) block: &'t TriangleBlock,
    /// The lanes that hold triangles.
    pub(crate) triangles: u32,
    /// The lanes that hold other primitives.
    pub(crate) others: u32,
}

impl Leaf<'_> {
    /// The primitives that are no triangles.
    #[inline(always)]
    pub(crate) fn others(&self) -> impl Iterator<Item = u32> {
        lanes(self.others).map(|lane| self.block.primitives[lane])
    }
}

/// What a walk through the tree looks for.
pub(crate) trait Query<'t> {
    /// The children to look into, as a set of lanes, and the key of each: those with small keys come first. Must be `#[inline(always)]`.
    fn children<S: Simd>(&mut self, simd: S, node: &WideNode) -> (u32, S::F16);

    /// What was put aside with a larger key need no longer be looked into. Not NaN.
    fn limit(&self) -> f32;

    /// Looks at the primitives of a leaf, and ends the walk with a break. Must be `#[inline(always)]`.
    fn leaf<S: Simd>(&mut self, simd: S, leaf: Leaf<'t>) -> ControlFlow<()>;
}

impl WideBvh {
    /// Walks through the tree for a query. Keys are finite.
    #[inline(always)]
    pub(crate) fn search<'t, S: Simd, Q: Query<'t>>(
        &'t self,
        simd: S,
        stack: &mut SearchStack,
        query: &mut Q,
    ) -> ControlFlow<()> {
        let (keys, items) = stack.0.parts();
        let (mut top, mut current) = (1, self.root);
        loop {
            if current == Reference::NOTHING {
                return ControlFlow::Continue(());
            }
            if current.is_leaf() {
                let block = self.block(current);
                let others = super::step::others(block, current);
                let leaf = Leaf { block, triangles: current.lanes() & !others, others };
                query.leaf(simd, leaf)?;
            } else {
                let node = self.node(current);
                let (chosen, near) = query.children(simd, node);
                top += push_in_order(simd, chosen, near, &node.children, (keys, items), top);
            }

            // On to the next that may still matter.
            let end = end_of_keys(query.limit());
            current = loop {
                top -= 1;
                if keys[top] <= end {
                    break Reference(items[top]);
                }
            };
            simd.prefetch(self.address(current));
        }
    }

    /// How far the boxes reach from zero along any axis.
    pub(crate) fn reach(&self) -> f32 {
        self.reach
    }
}

/// Puts the chosen children onto the stack, the smallest key last, and returns how many they are. While little is known of the answer many are chosen,
/// and which comes first decides how soon more is known: so that all are put in order, not each four as [`Simd::push_sorted`] does.
#[inline(always)]
fn push_in_order<S: Simd>(
    simd: S,
    chosen: u32,
    near: S::F16,
    children: &[u32; 16],
    (keys, items): (&mut [f32], &mut [u32]),
    top: usize,
) -> usize {
    let count = chosen.count_ones() as usize;
    if count <= 4 {
        return simd.push_sorted(chosen, near, children, (keys, items), top).0;
    }
    let (keys, items) = (&mut keys[top..top + 16], &mut items[top..top + 16]);
    let numbers = near.to_array();
    for lane in lanes(chosen) {
        // Below those that are larger, and below equal ones of earlier lanes.
        let key = simd.splat16(numbers[lane]);
        let larger = key.less(near);
        let equal = key.less_or_equal(near) & !larger;
        let place = (chosen & (larger | equal & ((1 << lane) - 1))).count_ones() as usize & 15;
        (keys[place], items[place]) = (numbers[lane], children[lane]);
    }
    count
}

/// What waits during a search: can be used again for the next one.
pub(crate) struct SearchStack(SmallStack);

impl SearchStack {
    /// One with room for searches of the tree.
    pub(crate) fn new(tree: &WideBvh) -> Self {
        Self(SmallStack::new(tree))
    }
}

/// The key on the stack up to which something must be looked into: keys lose their lowest four bits there, and bounds that they stand for are told with
/// roundings of their own.
#[inline(always)]
fn end_of_keys(limit: f32) -> f32 {
    limit + limit.abs() * (32.0 * f32::EPSILON) + f32::MIN_POSITIVE
}

/// The boxes that touch another one, which is finite, as a set of lanes.
#[inline(always)]
pub(crate) fn boxes_touching<S: Simd>(simd: S, planes: &Planes, bounds: &Aabb) -> u32 {
    let mut touching = u32::MAX;
    for (axis, [least, greatest]) in planes.iter().enumerate() {
        let (min, max) = (simd.splat16(bounds.min[axis]), simd.splat16(bounds.max[axis]));
        touching &=
            simd.load16(least).less_or_equal(max) & min.less_or_equal(simd.load16(greatest));
    }
    touching
}

/// The lanes of a set.
#[inline(always)]
pub(crate) fn lanes(set: u32) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (lane < u32::BITS).then_some(lane as usize)
    })
}

impl WideBvh {
    /// Walks through the tree for [`Bvh::visit`](crate::Bvh::visit).
    pub(crate) fn visit_primitives(
        &self,
        mut bound: impl FnMut(&Aabb) -> Option<f32>,
        mut visit: impl FnMut(u32) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let mut limit = f32::INFINITY;
        let mut told = self.told();
        let mut waiting: Vec<(f32, Reference)> = Vec::new();
        if self.root != Reference::NOTHING
            && let Some(bound) = bound(&self.bounds)
        {
            waiting.push((bound, self.root));
        }
        while let Some((key, reference)) = waiting.pop() {
            if key > limit {
                continue;
            }
            if reference.is_leaf() {
                for (_, primitive) in self.primitives_of(reference) {
                    if told.is_new(primitive) {
                        limit = visit(primitive)?;
                    }
                }
                continue;
            }
            let first = waiting.len();
            for (bounds, child) in self.node(reference).children() {
                match bound(&bounds) {
                    Some(key) if key > limit => {}
                    Some(key) => waiting.push((key, child)),
                    None => {}
                }
            }
            // The smallest is taken first.
            waiting[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        ControlFlow::Continue(())
    }
}
