//! Two wide trees against each other.

use std::collections::HashSet;
use std::ops::ControlFlow;

use super::WideBvh;
use super::node::Reference;
use super::search::{boxes_touching, lanes};
use crate::simd::{Kernel, Simd};
use crate::{Aabb, Vec3};

/// Tells `visit` all pairs of primitives of two trees that lie in leaves whose boxes touch.
pub(crate) struct Pairs<'a, F> {
    pub(crate) first: &'a WideBvh,
    pub(crate) second: &'a WideBvh,
    pub(crate) visit: F,
}

impl<F: FnMut(u32, u32) -> ControlFlow<()>> Kernel for Pairs<'_, F> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { first, second, mut visit } = self;
        let mut told = HashSet::new();
        let mut waiting = Vec::new();
        if first.root != Reference::NOTHING
            && second.root != Reference::NOTHING
            && !first.bounds.intersection(&second.bounds).is_empty()
        {
            waiting.push(((first.root, first.bounds), (second.root, second.bounds)));
        }
        while let Some(((a, a_bounds), (b, b_bounds))) = waiting.pop() {
            if a.is_leaf() && b.is_leaf() {
                for (_, primitive) in first.primitives_of(a) {
                    for (_, other) in second.primitives_of(b) {
                        let several = first.parts.contain(primitive) || second.parts.contain(other);
                        if !several || told.insert((primitive, other)) {
                            visit(primitive, other)?;
                        }
                    }
                }
                continue;
            }
            // Go down in the larger one.
            if b.is_leaf() || !a.is_leaf() && a_bounds.half_area() >= b_bounds.half_area() {
                for lane in lanes(boxes_touching(simd, &first.node(a).planes, &b_bounds)) {
                    waiting.push((child(first, a, lane), (b, b_bounds)));
                }
            } else {
                for lane in lanes(boxes_touching(simd, &second.node(b).planes, &a_bounds)) {
                    waiting.push(((a, a_bounds), child(second, b, lane)));
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The child in a lane of a node, and its box.
#[inline(always)]
fn child(tree: &WideBvh, node: Reference, lane: usize) -> (Reference, Aabb) {
    let node = tree.node(node);
    let [x, y, z] = &node.planes;
    let min = Vec3::new(x[0][lane], y[0][lane], z[0][lane]);
    let max = Vec3::new(x[1][lane], y[1][lane], z[1][lane]);
    (Reference(node.children[lane]), Aabb { min, max })
}
