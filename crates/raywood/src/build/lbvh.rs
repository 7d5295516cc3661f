//! The linear BVH: primitives sorted along a space-filling curve, divided where the curve turns. Lauterbach et al., "Fast BVH Construction on GPUs", Eurographics 2009.

use super::curve::{Precision, SortedKeys, sorted_keys};
use super::driver::{PARALLEL_SUBTREES, Subtree};
use super::morton::KeyBits;
use super::{Cancelled, PackedAabb, Stretch, Work};
use crate::structures::{Bvh2, Node};
use crate::{Aabb, BuildError, BuildOptions, Geometry, parallel};

/// Builds the tree. The same for any number of threads. O(N) but where many primitives lie close together, or in one place.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    let [ordering, growing, copying] = work.shares([4.5, 5.0, 1.0]);
    let sorted = sorted_keys(geometry, Precision::Coarse, ordering)?;
    let SortedKeys { mut keys, bits, .. } = sorted;
    let n = keys.len();
    if n == 0 {
        return Ok(Bvh2::from_parts(Vec::new(), Vec::new()));
    }
    let builder = Lbvh { geometry, bits, max_leaf_size: options.clamped().max_leaf_size };
    let nodes = builder.grow(Stretch::all(&mut keys, bits), growing)?.into_nodes(copying)?;
    let number = |place: usize| bits.number(keys[place]);
    let indices = parallel::map_watched(n, work.without_progress(), number)?;
    Ok(Bvh2::from_parts(nodes, indices))
}

/// A node that is still to be made.
const UNKNOWN: Node = Node::leaf(Aabb::EMPTY, 0, 0);

/// A tree that is being built.
struct Lbvh<'a, G> {
    geometry: &'a G,
    bits: KeyBits,
    max_leaf_size: usize,
}

impl<G: Geometry> Lbvh<'_, G> {
    /// Builds a subtree, in parallel if it is large.
    fn grow(&self, mut stretch: Stretch<'_>, work: Work<'_>) -> Result<Subtree, Cancelled> {
        let count = stretch.len();
        work.check()?;
        if count <= PARALLEL_SUBTREES || count <= self.max_leaf_size {
            // Twice as many nodes as leaves.
            let mut nodes = Vec::with_capacity(count.max(2 * count / self.max_leaf_size));
            nodes.push(UNKNOWN);
            self.subdivide(stretch.reborrowed(), 0, &mut nodes);
            self.measure(&mut nodes, stretch.keys(), stretch.first());
            work.done()?;
            return Ok(Subtree::Piece(nodes));
        }
        let (left, right) = stretch.split(self.geometry, work);
        work.check()?;
        let [left_work, right_work] = work.shares([left.len() as f64, right.len() as f64]);
        let (left, right) =
            parallel::join_if(true, || self.grow(left, left_work), || self.grow(right, right_work));
        let children = [left?, right?];
        let bounds = children[0].bounds().union(children[1].bounds());
        Ok(Subtree::Pair(bounds, Box::new(children)))
    }

    /// Puts a subtree, still without boxes, into the place of a node and behind the last one, pair by pair.
    fn subdivide(&self, stretch: Stretch<'_>, place: usize, nodes: &mut Vec<Node>) {
        let count = stretch.len();
        if count <= self.max_leaf_size {
            nodes[place] = Node::leaf(Aabb::EMPTY, stretch.first() as u32, count as u32);
            return;
        }
        let (left, right) = stretch.split(self.geometry, Work::UNWATCHED);
        let child = nodes.len();
        nodes[place] = Node::interior(Aabb::EMPTY, child as u32);
        nodes.extend_from_slice(&[UNKNOWN; 2]);
        self.subdivide(left, child, nodes);
        self.subdivide(right, child + 1, nodes);
    }

    /// Gives all nodes of a subtree their boxes, those of its primitives from `first` on.
    fn measure(&self, nodes: &mut [Node], keys: &[u64], first: usize) {
        // A loop of nothing but reading what lies all over the memory, so that the processor waits for many things at a time.
        let primitive = |key: &u64| PackedAabb::from(self.geometry.bounds(self.bits.number(*key)));
        let primitives: Vec<_> = keys.iter().map(primitive).collect();
        for place in (0..nodes.len()).rev() {
            // Children come after their parents.
            let node = nodes[place];
            let (start, count) = (node.left_first() as usize, node.count() as usize);
            nodes[place] = if node.is_leaf() {
                let mut bounds = PackedAabb::EMPTY;
                primitives[start - first..][..count].iter().for_each(|p| bounds.grow(p));
                Node::leaf(bounds.into(), start as u32, count as u32)
            } else {
                let [left, right] = [nodes[start].bounds(), nodes[start + 1].bounds()];
                Node::interior(left.union(right), start as u32)
            };
        }
    }
}
