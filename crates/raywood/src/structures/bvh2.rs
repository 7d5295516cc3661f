//! The textbook's tree: a binary bounding volume hierarchy of 32-byte nodes in one pool.

use super::AccelerationStructure;
use crate::build::Builder;
use crate::traverse::{closest::closest, occluded::occluded};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Hit, Probe, Ray};
use crate::{NodeView, ValidationError, Vec3};

/// A node of 32 bytes, `{ bounds.min, left_first, bounds.max, count }`: half a cache line, so that two children, which lie side by
/// side, are 64 bytes.
///
/// `count` tells what it is. An interior node has `count == 0` and its children are the nodes `left_first` and
/// `left_first + 1`; a leaf holds the `count` primitives whose numbers stand in
/// `primitive_indices[left_first..left_first + count]`.
///
/// An earlier form with separate `left`, `right`, `first`, `count` and a leaf flag takes 44 bytes: the children's
/// adjacency saves one index, and `count` the flag and the second meaning of `left_first` another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Node {
    /// The smallest coordinates with `left_first`, the largest with `count`: an array, so that a ray picks the corner it meets
    /// first by its direction's sign without a branch.
    corners: [Corner; 2],
}

/// A corner of a node's box and the number that shares its 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
struct Corner {
    point: Vec3,
    number: u32,
}

const _: () = assert!(size_of::<Node>() == 32);

impl Node {
    /// A leaf over `count` primitives from place `first` on.
    #[inline]
    pub(crate) const fn leaf(bounds: Aabb, first: u32, count: u32) -> Self {
        let corners = [
            Corner { point: bounds.min, number: first },
            Corner { point: bounds.max, number: count },
        ];
        Self { corners }
    }

    /// An interior node with children `left` and `left + 1`.
    #[inline]
    pub(crate) fn interior(bounds: Aabb, left: u32) -> Self {
        Self::leaf(bounds, left, 0)
    }

    /// The same node with another box.
    pub(crate) fn with_bounds(self, bounds: Aabb) -> Self {
        Self::leaf(bounds, self.left_first(), self.count())
    }

    /// The same interior node with its children elsewhere.
    pub(crate) fn with_children_at(self, left: u32) -> Self {
        Self::interior(self.bounds(), left)
    }

    /// The left child's number, or the leaf's first place in the primitive indices.
    #[inline]
    pub fn left_first(&self) -> u32 {
        self.corners[0].number
    }

    /// The number of primitives of a leaf; 0 in an interior node.
    #[inline]
    pub fn count(&self) -> u32 {
        self.corners[1].number
    }

    /// Whether this is a leaf.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.count() > 0
    }

    /// The node's box.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.corners[0].point, max: self.corners[1].point }
    }

    /// The box's corner with the smallest (0) or largest (1) coordinates.
    #[inline]
    pub(crate) fn corner(&self, which: usize) -> &Vec3 {
        &self.corners[which & 1].point
    }
}

/// A binary bounding volume hierarchy: nodes in one pool, children side by side, primitives through an index array.
///
/// It knows boxes and primitive numbers, not the geometry, which every query is given: see [`Bvh`](crate::Bvh) for the two
/// together. Node 0 is the root; the tree of an empty geometry has no node. At most `2N-1` nodes, at most 64 levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh2 {
    nodes: Vec<Node>,
    primitive_indices: Vec<u32>,
}

impl Bvh2 {
    /// Builds the tree with the binned surface area heuristic: see [`build_by`](Self::build_by). O(N log N).
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_by(Builder::SahBinned, geometry, options)
    }

    /// A tree from nodes and indices that a builder made.
    pub(crate) fn from_parts(nodes: Vec<Node>, primitive_indices: Vec<u32>) -> Self {
        Self { nodes, primitive_indices }
    }

    /// Nodes and indices, to be changed.
    pub(crate) fn into_parts(self) -> (Vec<Node>, Vec<u32>) {
        (self.nodes, self.primitive_indices)
    }

    /// Nodes, of which boxes may be changed, and indices.
    pub(crate) fn nodes_mut(&mut self) -> (&mut [Node], &[u32]) {
        (&mut self.nodes, &self.primitive_indices)
    }

    /// All nodes; the first is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The primitives' numbers in the order of the leaves.
    pub fn primitive_indices(&self) -> &[u32] {
        &self.primitive_indices
    }

    /// The box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, Node::bounds)
    }

    /// The primitives' numbers of a leaf.
    #[inline]
    pub(crate) fn leaf_primitives(&self, leaf: &Node) -> &[u32] {
        &self.primitive_indices[leaf.left_first() as usize..][..leaf.count() as usize]
    }

    /// The two children of an interior node.
    #[inline]
    pub(crate) fn children(&self, interior: &Node) -> [&Node; 2] {
        let pair = &self.nodes[interior.left_first() as usize..][..2];
        [&pair[0], &pair[1]]
    }
}

impl AccelerationStructure for Bvh2 {
    #[inline]
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        closest(self, geometry, ray, probe)
    }

    #[inline]
    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        occluded(self, geometry, ray, probe)
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        let mut pending = Vec::new();
        pending.extend(self.nodes.first().map(|root| (root, 0)));
        while let Some((node, level)) = pending.pop() {
            let references = node.is_leaf().then_some(node.count() as usize);
            visit(NodeView { bounds: node.bounds(), level, references });
            if !node.is_leaf() {
                pending.extend(self.children(node).map(|child| (child, level + 1)));
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.nodes()) + size_of_val(self.primitive_indices())
    }

    fn primitives(&self) -> usize {
        self.primitive_indices.len()
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        self.check(geometry)
    }
}
