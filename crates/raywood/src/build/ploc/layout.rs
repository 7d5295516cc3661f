//! From merges to the nodes of a binary tree, depth first.

use super::clusters::Id;
use super::merges::Merges;
use crate::build::driver::{PARALLEL_SUBTREES, Subtree, must_halve};
use crate::build::{Cancelled, PackedAabb, Work};
use crate::structures::{Bvh2, Node};
use crate::{Aabb, BuildOptions, Geometry, parallel};

/// All merges over the primitives of a geometry.
pub(super) struct Layout<'a, G> {
    pub(super) geometry: &'a G,
    /// The numbers of the primitives along the curve.
    pub(super) order: &'a [u32],
    pub(super) merges: &'a Merges,
    pub(super) options: &'a BuildOptions,
}

/// What a subtree is laid out from, and where.
struct Place<'a> {
    id: Id,
    /// Where the numbers of its primitives go.
    indices: &'a mut [u32],
    /// Where these start in the array of all.
    first: usize,
    /// The level of its root, from 1.
    depth: usize,
}

/// Some nodes that lie depth first, pair by pair, and what is still to be looked at of a leaf.
struct Piece {
    nodes: Vec<Node>,
    waiting: Vec<Id>,
}

/// A node that is still to be made.
const UNKNOWN: Node = Node::leaf(Aabb::EMPTY, 0, 0);

impl<G: Geometry> Layout<'_, G> {
    /// The tree of all.
    pub(super) fn tree(&self, work: Work<'_>) -> Result<Bvh2, Cancelled> {
        let [growing, copying] = work.shares([4.0, 1.0]);
        let mut indices = vec![0; self.order.len()];
        let place = Place { id: self.merges.last(), indices: &mut indices, first: 0, depth: 1 };
        let nodes = self.grow(place, growing)?.into_nodes(copying)?;
        Ok(Bvh2::from_parts(nodes, indices))
    }

    /// Lays out a subtree, in parallel if it is large.
    fn grow(&self, place: Place<'_>, work: Work<'_>) -> Result<Subtree, Cancelled> {
        work.check()?;
        let count = place.indices.len();
        let is_piece = count <= PARALLEL_SUBTREES.max(self.options.max_leaf_size)
            || must_halve(count, place.depth);
        let number = match self.merges.number(place.id) {
            Some(number) if !is_piece => number,
            _ => {
                let nodes = Vec::with_capacity(count);
                let mut piece = Piece { nodes, waiting: Vec::new() };
                piece.nodes.push(UNKNOWN);
                self.subdivide(place, 0, &mut piece);
                work.part(count, self.order.len()).done()?;
                return Ok(Subtree::Piece(piece.nodes));
            }
        };
        let [left, right] = self.children(number, place);
        let (left, right) =
            parallel::join_if(true, || self.grow(left, work), || self.grow(right, work));
        Ok(Subtree::Pair(*self.merges.bounds(number), Box::new([left?, right?])))
    }

    /// Puts a subtree into the place of a node and behind the last one, pair by pair.
    fn subdivide(&self, place: Place<'_>, node: usize, piece: &mut Piece) {
        let (first, count) = (place.first as u32, place.indices.len());
        let Some(number) = self.merges.number(place.id) else {
            let primitive = self.order[place.id as usize];
            place.indices[0] = primitive;
            piece.nodes[node] = Node::leaf(self.geometry.bounds(primitive), first, 1);
            return;
        };
        let bounds = *self.merges.bounds(number);
        if count <= self.options.max_leaf_size && self.is_leaf(number, &bounds, count) {
            self.collect(place.id, place.indices, &mut piece.waiting);
            piece.nodes[node] = Node::leaf(bounds.into(), first, count as u32);
            return;
        }
        if must_halve(count, place.depth) {
            self.collect(place.id, place.indices, &mut piece.waiting);
            self.halve(place.indices, place.first, node, &mut piece.nodes);
            return;
        }
        let child = piece.nodes.len();
        piece.nodes[node] = Node::interior(bounds.into(), child as u32);
        piece.nodes.extend_from_slice(&[UNKNOWN; 2]);
        let [left, right] = self.children(number, place);
        self.subdivide(left, child, piece);
        self.subdivide(right, child + 1, piece);
    }

    /// Whether the primitives of a merge had better be a leaf.
    fn is_leaf(&self, number: usize, bounds: &PackedAabb, count: usize) -> bool {
        let BuildOptions { node_cost, primitive_cost, .. } = *self.options;
        // Visiting two nodes alone would cost more: then their boxes need not be looked at.
        if 2.0 * node_cost >= primitive_cost * count as f32 {
            return true;
        }
        let costs = self.merges.children(number).map(|child| {
            let bounds = match self.merges.number(child) {
                Some(number) => *self.merges.bounds(number),
                None => self.geometry.bounds(self.order[child as usize]).into(),
            };
            self.merges.size(child) as f64 * bounds.half_area()
        });
        !self.options.split_is_cheaper(count, bounds, costs[0] + costs[1])
    }

    /// The places of both children of a node.
    #[inline(always)]
    fn children<'a>(&self, number: usize, place: Place<'a>) -> [Place<'a>; 2] {
        let [left, right] = self.merges.children(number);
        let left_count = self.merges.size(left);
        let (left_indices, right_indices) = place.indices.split_at_mut(left_count);
        let depth = place.depth + 1;
        [
            Place { id: left, indices: left_indices, first: place.first, depth },
            Place { id: right, indices: right_indices, first: place.first + left_count, depth },
        ]
    }

    /// Writes down the primitives of a cluster. It may be deeper than any stack, so what waits is kept in a list.
    fn collect(&self, id: Id, indices: &mut [u32], waiting: &mut Vec<Id>) {
        waiting.push(id);
        let mut places = indices.iter_mut();
        while let Some(id) = waiting.pop() {
            match self.merges.number(id) {
                Some(number) => {
                    let [left, right] = self.merges.children(number);
                    waiting.extend([right, left]);
                }
                None => {
                    if let Some(place) = places.next() {
                        *place = self.order[id as usize];
                    }
                }
            }
        }
    }

    /// A subtree over primitives in their order, halved again and again: for those that would become too deep.
    fn halve(&self, indices: &[u32], first: usize, node: usize, nodes: &mut Vec<Node>) -> Aabb {
        if let [primitive] = *indices {
            let bounds = self.geometry.bounds(primitive);
            nodes[node] = Node::leaf(bounds, first as u32, 1);
            return bounds;
        }
        let child = nodes.len();
        nodes.extend_from_slice(&[UNKNOWN; 2]);
        let (left, right) = indices.split_at(indices.len() / 2);
        let bounds = self.halve(left, first, child, nodes);
        let bounds = bounds.union(self.halve(right, first + left.len(), child + 1, nodes));
        nodes[node] = Node::interior(bounds, child as u32);
        bounds
    }
}
