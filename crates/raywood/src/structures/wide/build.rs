//! Building the wide tree from a binary one.

use super::WideBvh;
use super::collapse::Plan;
use super::node::{Reference, WideNode};
use crate::geometry::{LANES, TriangleBlock};
use crate::simd::Arena;
use crate::{BuildError, BuildOptions, Bvh2, Geometry, SimdLevel};

/// The most primitives in a leaf of the binary tree: half of what a leaf of the wide tree holds, so that reinsertion can tell apart what lies in it. Single
/// primitives gain little more and take twice as many nodes.
const BINARY_LEAF_SIZE: usize = LANES / 2;

/// How often the binary tree is improved by reinsertion unless the options say it.
const REINSERTION_PASSES: usize = 4;

/// Builds the tree.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
) -> Result<WideBvh, BuildError> {
    let options = BuildOptions {
        max_leaf_size: options.max_leaf_size.min(BINARY_LEAF_SIZE),
        reinsertion_passes: Some(options.reinsertion_passes.unwrap_or(REINSERTION_PASSES)),
        ..options.clone()
    };
    let tree = Bvh2::build(geometry, &options)?;
    let plan = Plan::new(&tree);
    let mut builder =
        Wide { geometry, tree: &tree, plan: &plan, depth: 0, arena: Arena::default() };
    let root = match tree.nodes() {
        [] => Reference::NOTHING,
        _ if plan.is_leaf(0) => builder.leaf(0),
        _ => {
            let root = builder.arena.push(WideNode::EMPTY);
            builder.fill(root, 0, 1);
            Reference::node(root)
        }
    };
    let Wide { depth, arena, .. } = builder;
    if arena.len() > Reference::LINES {
        return Err(BuildError::TooManyPrimitives { primitives: geometry.len() });
    }
    let (bounds, primitives) = (tree.bounds(), geometry.len() as u32);
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    let triangle_test = options.triangle_test;
    Ok(WideBvh {
        bounds,
        primitives,
        triangle_test,
        reach,
        depth,
        root,
        arena,
        level: SimdLevel::active(),
    })
}

/// A wide tree that is being made.
struct Wide<'a, G> {
    geometry: &'a G,
    tree: &'a Bvh2,
    plan: &'a Plan,
    depth: usize,
    arena: Arena,
}

impl<G: Geometry> Wide<'_, G> {
    /// Fills the node at a line, which takes the place of node `number` of the binary tree, and everything below it. The children lie side by side.
    fn fill(&mut self, line: usize, number: usize, depth: usize) {
        self.depth = self.depth.max(depth);
        let children = self.plan.children(self.tree, number);
        let mut nodes = Vec::new();
        for (lane, number) in children.into_iter().enumerate() {
            let child = if self.plan.is_leaf(number) {
                self.leaf(number)
            } else {
                let line = self.arena.push(WideNode::EMPTY);
                nodes.push((line, number));
                Reference::node(line)
            };
            let bounds = self.tree.nodes()[number].bounds();
            self.arena.get_mut::<WideNode>(line).set(lane, &bounds, child);
        }
        for (line, number) in nodes {
            self.fill(line, number, depth + 1);
        }
    }

    /// A leaf of all primitives below node `number` of the binary tree.
    fn leaf(&mut self, number: usize) -> Reference {
        // Their numbers lie side by side, from those of the leftmost leaf to those of the rightmost.
        let nodes = self.tree.nodes();
        let (mut first, mut last) = (&nodes[number], &nodes[number]);
        while !first.is_leaf() {
            first = self.tree.children(first)[0];
        }
        while !last.is_leaf() {
            last = self.tree.children(last)[1];
        }
        let range = first.left_first() as usize..(last.left_first() + last.count()) as usize;
        let primitives = &self.tree.primitive_indices()[range];

        let mut block = TriangleBlock::default();
        let mut mixed = false;
        for (lane, &primitive) in primitives.iter().enumerate() {
            let triangle = self.geometry.triangle(primitive);
            mixed |= triangle.is_none();
            block.set(lane, primitive, triangle.unwrap_or_default());
        }
        Reference::leaf(self.arena.push(block), primitives.len(), mixed)
    }
}
