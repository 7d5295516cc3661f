//! A binary tree with links to parents, so that subtrees can be moved.

use crate::Aabb;
use crate::build::{Cancelled, PackedAabb, Work};
use crate::structures::{Bvh2, MAX_DEPTH, Node};

/// After so many nodes are copied the build asks whether to go on.
const STRETCH: usize = 1 << 16;

/// A tree whose nodes know their parents and heights.
///
/// As in [`Bvh2`] the two children of a node lie side by side, at `2k + 1` and `2k + 2` for pair `k`, which makes siblings findable without a link. But
/// children may come before their parents, and the primitives of a subtree may be strewn about.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LinkedTree {
    nodes: Vec<Node>,
    /// The parent of each pair of nodes.
    parents: Vec<u32>,
    /// How many levels lie below each node.
    heights: Vec<u8>,
    primitive_indices: Vec<u32>,
}

impl LinkedTree {
    /// Links the nodes of a tree in which children come after their parents, as all builders make it.
    pub(super) fn new(tree: Bvh2, work: Work<'_>) -> Result<Self, Cancelled> {
        let (nodes, primitive_indices) = tree.into_parts();
        let mut parents = vec![0; nodes.len() / 2];
        let mut heights = vec![0u8; nodes.len()];
        // From the last to the first.
        let last = nodes.len().wrapping_sub(1);
        work.in_stretches(nodes.len(), |stretch| {
            for number in stretch.map(|place| last - place) {
                let node = &nodes[number];
                if !node.is_leaf() {
                    let left = node.left_first() as usize;
                    debug_assert!(left > number && left % 2 == 1);
                    parents[left / 2] = number as u32;
                    heights[number] = 1 + heights[left].max(heights[left + 1]);
                }
            }
        })?;
        Ok(Self { nodes, parents, heights, primitive_indices })
    }

    /// The tree as it is to be traversed: depth first, the primitives of every subtree side by side.
    pub(super) fn into_bvh2(self, work: Work<'_>) -> Result<Bvh2, Cancelled> {
        let mut nodes = Vec::with_capacity(self.nodes.len());
        let mut primitive_indices = Vec::with_capacity(self.primitive_indices.len());
        nodes.push(self.nodes[0]);
        // Nodes whose content is still to be copied, by their new number.
        let mut pending = vec![0usize];
        let stretch = work.part(STRETCH, self.nodes.len());
        let mut copied = 0;
        while let Some(number) = pending.pop() {
            copied += 1;
            if copied % STRETCH == 0 {
                stretch.done()?;
            }
            let node = nodes[number];
            let (first, count) = (node.left_first() as usize, node.count() as usize);
            if node.is_leaf() {
                nodes[number] =
                    Node::leaf(node.bounds(), primitive_indices.len() as u32, node.count());
                primitive_indices.extend_from_slice(&self.primitive_indices[first..first + count]);
            } else {
                let left = nodes.len();
                nodes[number] = node.with_children_at(left as u32);
                nodes.extend_from_slice(&self.nodes[first..first + 2]);
                pending.push(left + 1);
                pending.push(left);
            }
        }
        Ok(Bvh2::from_parts(nodes, primitive_indices))
    }

    /// How many nodes there are; the root is number 0.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// A node's box.
    #[inline]
    pub(super) fn bounds(&self, node: usize) -> PackedAabb {
        self.nodes[node].bounds().into()
    }

    /// The left child of an interior node, beside which lies the right one.
    #[inline]
    pub(super) fn left_child(&self, node: usize) -> Option<usize> {
        let node = &self.nodes[node];
        (!node.is_leaf()).then(|| node.left_first() as usize)
    }

    /// The parent of a node that is not the root.
    #[inline]
    pub(super) fn parent(&self, node: usize) -> usize {
        self.parents[(node - 1) / 2] as usize
    }

    /// The other child of a node's parent.
    #[inline]
    pub(super) fn sibling(&self, node: usize) -> usize {
        ((node - 1) ^ 1) + 1
    }

    /// How many levels lie below a node.
    pub(super) fn height(&self, node: usize) -> usize {
        usize::from(self.heights[node])
    }

    /// The half areas of all interior nodes' boxes together: the part of the tree's cost that moving subtrees changes.
    pub(super) fn cost(&self) -> f64 {
        let interior = self.nodes.iter().filter(|node| !node.is_leaf());
        interior.map(|node| PackedAabb::from(node.bounds()).half_area()).sum()
    }

    /// Whether the subtree of one node can be taken out and put beside another: that node must not lie in it, and no leaf may come to lie too deep.
    pub(super) fn can_move(&self, from: usize, to: usize) -> bool {
        let mut above = to;
        let mut depth = 1;
        while above != 0 {
            if above == from {
                return false;
            }
            above = self.parent(above);
            depth += 1;
        }
        let height = self.heights[from].max(self.heights[to]);
        from != 0 && depth + 1 + usize::from(height) <= MAX_DEPTH
    }

    /// Takes out the subtree of one node and puts it beside another, and returns by how much the [`cost`](Self::cost) grows.
    ///
    /// The subtree stays at its place `from` in the pool, and so do the children of all nodes; but three nodes do not. The subtree's parent vanishes, and its
    /// sibling takes that place, `parent(from)`. The node at `to` becomes the subtree's new sibling and takes the place beside it. At `to` there is then the
    /// new parent of both. So moving `from` beside the node at its former parent's place restores the tree as it was.
    pub(super) fn move_beside(&mut self, from: usize, to: usize) -> f64 {
        let (sibling, parent) = (self.sibling(from), self.parent(from));
        debug_assert!(to != from && to != sibling && to != parent);
        let vanishing = self.bounds(parent).half_area();
        let (kept, kept_height) = (self.nodes[sibling], self.heights[sibling]);
        let (target, target_height) = (self.nodes[to], self.heights[to]);

        self.put(sibling, target, target_height);
        self.put(parent, kept, kept_height);
        let pair = from.min(sibling);
        self.nodes[to] = Node::interior(Aabb::EMPTY, pair as u32);
        self.parents[pair / 2] = to as u32;
        self.refit(to);

        let mut growth = self.bounds(to).half_area() - vanishing;
        growth += self.refit_above(parent);
        growth += self.refit_above(to);
        growth
    }

    /// Has the subtrees of two nodes change places, neither of which lies in the other, and returns by how much the [`cost`](Self::cost) grows.
    pub(super) fn swap(&mut self, a: usize, b: usize) -> f64 {
        let (node, height) = (self.nodes[a], self.heights[a]);
        self.put(a, self.nodes[b], self.heights[b]);
        self.put(b, node, height);
        self.refit_above(a) + self.refit_above(b)
    }

    /// Puts a node with all that is below it at a place in the pool.
    fn put(&mut self, place: usize, node: Node, height: u8) {
        self.nodes[place] = node;
        self.heights[place] = height;
        if !node.is_leaf() {
            self.parents[node.left_first() as usize / 2] = place as u32;
        }
    }

    /// Computes box and height of an interior node from its children's and tells whether they changed.
    fn refit(&mut self, node: usize) -> bool {
        let left = self.nodes[node].left_first() as usize;
        let bounds = Aabb::from(self.bounds(left).union(self.bounds(left + 1)));
        let height = 1 + self.heights[left].max(self.heights[left + 1]);
        let changed = bounds != self.nodes[node].bounds() || height != self.heights[node];
        self.nodes[node] = Node::interior(bounds, left as u32);
        self.heights[node] = height;
        changed
    }

    /// Refits what lies above a node as far as anything changes, and returns by how much the half areas grow.
    fn refit_above(&mut self, mut node: usize) -> f64 {
        let mut growth = 0.0;
        while node != 0 {
            node = self.parent(node);
            let before = self.bounds(node).half_area();
            if !self.refit(node) {
                break;
            }
            growth += self.bounds(node).half_area() - before;
        }
        growth
    }
}
