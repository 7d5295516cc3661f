//! The linear BVH: primitives sorted along a space-filling curve, sets split where the curve turns. Lauterbach et al., "Fast BVH Construction on GPUs", Eurographics 2009;
//! Karras, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", HPG 2012. Where codes cannot tell primitives apart, they get codes of their own.

use super::curve::{key, sorted_keys};
use super::driver::{PARALLEL_SUBTREES, Subtree, must_halve};
use super::morton::{Morton, NUMBER_BITS, number, same_code};
use super::radix_sort::sort_above;
use super::{Cancelled, PackedAabb, Work};
use crate::structures::{Bvh2, Node};
use crate::{Aabb, BuildError, BuildOptions, Geometry, parallel};

/// Builds the tree. The same for any number of threads. O(N) but where many primitives lie close together, or in one place.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    build_with_leaves(geometry, options.clamped().max_leaf_size, work)
}

/// The same, with leaves of at most so many primitives.
pub(super) fn build_with_leaves<G: Geometry>(
    geometry: &G,
    max_leaf_size: usize,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    let [ordering, growing, copying] = work.shares([4.5, 5.0, 1.0]);
    let (mut keys, _) = sorted_keys(geometry, ordering)?;
    let n = keys.len();
    if n == 0 {
        return Ok(Bvh2::from_parts(Vec::new(), Vec::new()));
    }
    let builder = Lbvh { geometry, max_leaf_size };
    let set = Set { keys: &mut keys, first: 0, depth: 1, alike: false, work: growing };
    let nodes = builder.grow(set)?.into_nodes(copying)?;
    let indices = parallel::map_watched(n, work.without_progress(), |place| number(keys[place]))?;
    Ok(Bvh2::from_parts(nodes, indices))
}

/// A node that is still to be made.
const UNKNOWN: Node = Node::leaf(Aabb::EMPTY, 0, 0);

/// A tree that is being built.
struct Lbvh<'a, G> {
    geometry: &'a G,
    max_leaf_size: usize,
}

/// Some primitives side by side on the curve.
struct Set<'a> {
    /// Their codes and numbers, in ascending order.
    keys: &'a mut [u64],
    /// Where they start in the array of all.
    first: usize,
    /// The level of their node, from 1.
    depth: usize,
    /// Whether no code can tell them apart: their centres are in one place.
    alike: bool,
    /// What building their subtree is of the whole build.
    work: Work<'a>,
}

impl<G: Geometry> Lbvh<'_, G> {
    /// Builds a subtree, in parallel if it is large.
    fn grow(&self, mut set: Set<'_>) -> Result<Subtree, Cancelled> {
        let (count, work) = (set.keys.len(), set.work);
        work.check()?;
        if count <= PARALLEL_SUBTREES || count <= self.max_leaf_size {
            let (first, keys) = (set.first, &mut *set.keys);
            let mut nodes = Vec::with_capacity(count);
            nodes.push(UNKNOWN);
            let below = Set { keys: &mut *keys, work: Work::UNWATCHED, ..set };
            self.subdivide(below, 0, &mut nodes);
            self.measure(&mut nodes, keys, first);
            work.done()?;
            return Ok(Subtree::Piece(nodes));
        }
        let (left, right) = set.split(self);
        work.check()?;
        let (left, right) = parallel::join_if(true, || self.grow(left), || self.grow(right));
        let children = [left?, right?];
        let bounds = children[0].bounds().union(children[1].bounds());
        Ok(Subtree::Pair(bounds, Box::new(children)))
    }

    /// Puts a subtree, still without boxes, into the place of a node and behind the last one, pair by pair.
    fn subdivide(&self, mut set: Set<'_>, place: usize, nodes: &mut Vec<Node>) {
        let count = set.keys.len();
        if count <= self.max_leaf_size {
            nodes[place] = Node::leaf(Aabb::EMPTY, set.first as u32, count as u32);
            return;
        }
        let (left, right) = set.split(self);
        let child = nodes.len();
        nodes[place] = Node::interior(Aabb::EMPTY, child as u32);
        nodes.extend_from_slice(&[UNKNOWN; 2]);
        self.subdivide(left, child, nodes);
        self.subdivide(right, child + 1, nodes);
    }

    /// Gives all nodes of a subtree their boxes, those of its primitives from `first` on.
    fn measure(&self, nodes: &mut [Node], keys: &[u64], first: usize) {
        // A loop of nothing but reading what lies all over the memory, so that the processor waits for many things at a time.
        let primitive = |key: &u64| PackedAabb::from(self.geometry.bounds(number(*key)));
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

    /// Gives primitives whose codes are the same new ones, which tell them apart, and sorts them. Says whether that can be done.
    fn encode_anew(&self, keys: &mut [u64], work: Work<'_>) -> Result<bool, Cancelled> {
        let around = |centers: &mut PackedAabb, place: usize| {
            let bounds = PackedAabb::from(self.geometry.bounds(number(keys[place])));
            *centers = centers.including(bounds.center());
        };
        let (count, work) = (keys.len(), work.without_progress());
        let nothing = PackedAabb::EMPTY;
        let centers = parallel::fold_numbers(count, work, nothing, around, PackedAabb::grow)?;
        let morton = Morton::new(&centers);
        let key = |place: usize| key(self.geometry, &morton, number(keys[place]));
        let mut sorted = parallel::map_watched(count, work, key)?;
        sort_above(NUMBER_BITS, &mut sorted, work)?;
        keys.copy_from_slice(&sorted);
        Ok(!same_code(keys[0], keys[count - 1]))
    }
}

impl<'a> Set<'a> {
    /// Divides the set where the highest bit changes in which codes differ; in the middle where the tree might else become too deep, or where no code can tell the
    /// primitives apart.
    fn split<G: Geometry>(&mut self, builder: &Lbvh<'_, G>) -> (Set<'a>, Set<'a>) {
        let keys = std::mem::take(&mut self.keys);
        let count = keys.len();
        let halve = self.alike || must_halve(count, self.depth);
        if !halve && same_code(keys[0], keys[count - 1]) {
            // Of a build that is stopped it does not matter.
            self.alike = !builder.encode_anew(keys, self.work).unwrap_or(false);
        }
        let left_count = match halve || self.alike {
            true => count / 2,
            false => {
                let differing = keys[0] ^ keys[count - 1];
                let prefix = keys[count - 1] & !(u64::MAX >> 1 >> differing.leading_zeros());
                keys.partition_point(|key| *key < prefix)
            }
        };
        let (left, right) = keys.split_at_mut(left_count);
        let (depth, alike) = (self.depth + 1, self.alike);
        let [left_work, right_work] = self.work.shares([left.len() as f64, right.len() as f64]);
        let behind = self.first + left_count;
        (
            Set { keys: left, first: self.first, depth, alike, work: left_work },
            Set { keys: right, first: behind, depth, alike, work: right_work },
        )
    }
}
