//! What a node of a binary tree costs as one tree of wide nodes, as two, and so on: the step of the search for the best wide tree. Ylitie, Karras and Laine,
//! "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.

use super::node::WIDTH;
use crate::simd::{Float, Kernel, Simd, SimdLevel, dispatch_on};

/// What a subtree costs as at most so many separate trees, from one to sixteen, by number less one; infinitely much beyond [`most`](Self::most).
#[derive(Clone, Copy)]
pub(super) struct Trees {
    pub(super) costs: [f32; WIDTH],
    /// Into how many trees it can be divided: as many as it has leaves.
    pub(super) most: usize,
}

/// How many trees the left child becomes when a node's subtree becomes at most so many, from two to sixteen, by number less one; 0 where fewer trees are better.
pub(super) type Division = [u8; WIDTH];

impl Trees {
    /// Of a subtree that can be one tree only.
    pub(super) fn one(cost: f32) -> Self {
        let mut costs = [f32::INFINITY; WIDTH];
        costs[0] = cost;
        Self { costs, most: 1 }
    }

    /// Of two children together, divided in the best way; what one tree costs is told by `as_one`, of what as many as possible do.
    pub(super) fn of_node(
        left: &Self,
        right: &Self,
        as_one: impl FnOnce(f32) -> f32,
    ) -> (Self, Division) {
        let most = (left.most + right.most).min(WIDTH);
        let (mut costs, to_left) = dispatch_on(SimdLevel::active(), Divide { left, right });
        let mut division = to_left.map(|trees| trees as u8);

        costs[0] = as_one(costs[most - 1]);
        // Sixteen are asked for only when there must be a node here.
        division[WIDTH - 1] = division[most - 1];
        for trees in 2..=most {
            if costs[trees - 2] <= costs[trees - 1] {
                if trees < WIDTH {
                    division[trees - 1] = 0;
                }
                costs[trees - 1] = costs[trees - 2];
            }
        }
        (Self { costs, most }, division)
    }
}

/// The best ways to divide all numbers of trees among two children: what they cost, and how many go to the left, by number less one. One tree cannot be divided.
struct Divide<'a> {
    left: &'a Trees,
    right: &'a Trees,
}

impl Kernel for Divide<'_> {
    type Output = ([f32; WIDTH], [f32; WIDTH]);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        // What a child cannot be divided into costs infinitely much: so does less than one tree to the right, before the costs of one and more.
        let mut right = [f32::INFINITY; 2 * WIDTH];
        right[WIDTH..].copy_from_slice(&self.right.costs);
        let mut best = simd.splat16(f32::INFINITY);
        let mut to_left = simd.splat16(0.0);
        for trees in 1..=self.left.most.min(WIDTH - 1) {
            let others = &right[WIDTH - trees..][..WIDTH];
            let Some((others, _)) = others.split_first_chunk() else { break };
            let costs = simd.splat16(self.left.costs[trees - 1]) + simd.load16(others);
            let less = costs.less(best);
            best = best.replaced(less, costs);
            to_left = to_left.replaced(less, simd.splat16(trees as f32));
        }
        (best.to_array(), to_left.to_array())
    }
}
