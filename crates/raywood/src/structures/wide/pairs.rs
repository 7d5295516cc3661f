//! Two wide trees against each other.

use std::collections::HashSet;
use std::ops::ControlFlow;

use super::WideBvh;
use super::node::{Reference, WideNode};
use super::search::{boxes_touching, lanes};
use crate::simd::{Kernel, Simd};
use crate::{Aabb, Vec3};

/// Where a tree stands in the space of another one.
pub(crate) trait Place {
    /// Where a box of it lies: a finite one, and the larger the box the larger.
    fn place(&self, bounds: &Aabb) -> Aabb;

    /// The children of a node of it that touch a box of the other tree.
    fn touching<S: Simd>(&self, simd: S, node: &WideNode, bounds: &Aabb) -> u32;
}

/// In the same space as it is.
pub(crate) struct AsItIs;

impl Place for AsItIs {
    #[inline(always)]
    fn place(&self, bounds: &Aabb) -> Aabb {
        *bounds
    }

    #[inline(always)]
    fn touching<S: Simd>(&self, simd: S, node: &WideNode, bounds: &Aabb) -> u32 {
        boxes_touching(simd, &node.planes, bounds)
    }
}

impl<F: Fn(&Aabb) -> Aabb> Place for F {
    #[inline(always)]
    fn place(&self, bounds: &Aabb) -> Aabb {
        self(bounds)
    }

    #[inline(always)]
    fn touching<S: Simd>(&self, _: S, node: &WideNode, bounds: &Aabb) -> u32 {
        placed_boxes_touching(node, self, bounds)
    }
}

/// The children of a node that touch a box, after they were placed somewhere.
pub(crate) fn placed_boxes_touching(
    node: &WideNode,
    place: impl Fn(&Aabb) -> Aabb,
    bounds: &Aabb,
) -> u32 {
    node.boxes().fold(0, |touching, (lane, own)| {
        touching | u32::from(!place(&own).intersection(bounds).is_empty()) << lane
    })
}

/// Tells `visit` all pairs of primitives of two trees that lie in leaves whose boxes touch.
pub(crate) struct Pairs<'a, P, F> {
    pub(crate) first: &'a WideBvh,
    pub(crate) second: &'a WideBvh,
    /// Where the second tree stands in the space of the first.
    pub(crate) place: P,
    pub(crate) visit: F,
}

impl<P, F> Kernel for Pairs<'_, P, F>
where
    P: Place,
    F: FnMut(u32, u32) -> ControlFlow<()>,
{
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { first, second, place, mut visit } = self;
        let mut told = HashSet::new();
        let mut waiting = Vec::new();
        if first.root != Reference::NOTHING && second.root != Reference::NOTHING {
            let (bounds, others) = (first.bounds, place.place(&second.bounds));
            if !bounds.intersection(&others).is_empty() {
                waiting.push(((first.root, bounds), (second.root, others)));
            }
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
                for lane in lanes(place.touching(simd, second.node(b), &a_bounds)) {
                    let (child, bounds) = child(second, b, lane);
                    waiting.push(((a, a_bounds), (child, place.place(&bounds))));
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
