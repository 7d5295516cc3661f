//! The recursion that every top-down builder shares: in place like quicksort, over an array of primitive numbers that
//! is permuted while the primitives themselves stay where they are.

use super::PackedAabb;
use crate::structures::{Bvh2, MAX_DEPTH, Node};
use crate::{Aabb, BuildError, Geometry};

/// Sets larger than this build their two halves in parallel.
const PARALLEL_SUBTREES: usize = 2048;

/// Chooses how a set of primitives is divided: the part in which top-down builders differ.
pub(crate) trait Splitter: Sync {
    /// Permutes `indices` so that the left child's primitives come first and tells how many these are and the bounds of
    /// both children, or says by `None` that the set should be a leaf.
    ///
    /// The answer must depend on the arguments alone, never on timing or threads.
    fn split(
        &self,
        bounds: &[PackedAabb],
        indices: &mut [u32],
        node_bounds: &PackedAabb,
    ) -> Option<Split>;
}

/// A set of primitives divided in two.
pub(crate) struct Split {
    /// How many primitives go left; neither none nor all.
    pub(crate) left_count: usize,
    /// The box around them.
    pub(crate) left: PackedAabb,
    /// The box around the others.
    pub(crate) right: PackedAabb,
}

impl Split {
    /// The set divided as it stands, its first `left_count` primitives to the left.
    pub(super) fn at(bounds: &[PackedAabb], indices: &[u32], left_count: usize) -> Self {
        let (left, right) = indices.split_at(left_count);
        let around = |part: &[u32]| {
            part.iter().fold(PackedAabb::EMPTY, |all, &i| all.union(bounds[i as usize]))
        };
        Self { left_count, left: around(left), right: around(right) }
    }
}

/// The bounds of every primitive, checked.
pub(crate) fn primitive_bounds<G: Geometry>(geometry: &G) -> Result<Vec<PackedAabb>, BuildError> {
    let primitives = geometry.len();
    if primitives > BuildError::MAX_PRIMITIVES {
        return Err(BuildError::TooManyPrimitives { primitives });
    }
    let is_bad = |bounds: &Aabb| bounds.is_empty() || !bounds.is_finite();
    let bounds = crate::parallel::map(primitives, |primitive| {
        let bounds = geometry.bounds(primitive as u32);
        if is_bad(&bounds) {
            Err(BuildError::BadBounds { primitive: primitive as u32, bounds })
        } else {
            Ok(bounds.into())
        }
    });
    bounds.into_iter().collect()
}

/// Builds the tree over primitives with the given (checked) bounds. The same for any number of threads.
pub(crate) fn build<S: Splitter>(bounds: &[PackedAabb], splitter: &S) -> Bvh2 {
    let n = bounds.len();
    let mut indices: Vec<u32> = (0..n as u32).collect();
    if n == 0 {
        return Bvh2::from_parts(Vec::new(), indices);
    }

    // A set of n primitives has at most 2n-1 nodes. Each subtree gets its own stretch of the pool of that size, so that
    // where a node lies follows from the counts and not from which thread came first.
    let root_bounds =
        crate::parallel::fold(bounds, PackedAabb::EMPTY, PackedAabb::grow, PackedAabb::grow);
    let mut pool = vec![Node::leaf(root_bounds.into(), 0, n as u32); 2 * n - 1];
    let (root, descendants) = pool.split_at_mut(1);
    subdivide(
        bounds,
        splitter,
        &mut root[0],
        Subtree { descendants, first_node: 1, indices: &mut indices, first: 0 },
        1,
    );
    Bvh2::from_parts(close_gaps(&pool), indices)
}

/// What belongs to one subtree while it is built.
struct Subtree<'a> {
    /// Room for all nodes below its root.
    descendants: &'a mut [Node],
    /// The number of the first of them in the pool.
    first_node: usize,
    /// The numbers of its primitives.
    indices: &'a mut [u32],
    /// Where these start in the array of all.
    first: usize,
}

/// Divides `node`, a leaf over all of the subtree's primitives, as long as the splitter wants to.
fn subdivide<S: Splitter>(
    bounds: &[PackedAabb],
    splitter: &S,
    node: &mut Node,
    subtree: Subtree<'_>,
    depth: usize,
) {
    let Subtree { descendants, first_node, indices, first } = subtree;
    let count = indices.len();
    if count == 1 {
        return;
    }

    // Keep the depth within the traversal's stack: from here on only halving can.
    let halvings = count.next_power_of_two().trailing_zeros() as usize;
    let split = if depth + halvings >= MAX_DEPTH {
        Some(split_at_median(bounds, indices))
    } else {
        splitter.split(bounds, indices, &node.bounds().into())
    };
    let Some(Split { left_count, left, right }) = split else { return };
    debug_assert!(0 < left_count && left_count < count);

    // The children lie side by side at the front of the subtree's room, the left one's descendants follow, then the right
    // one's.
    *node = Node::interior(node.bounds(), first_node as u32);
    let (children, rest) = descendants.split_at_mut(2);
    let (left_node, right_node) = children.split_at_mut(1);
    left_node[0] = Node::leaf(left.into(), first as u32, left_count as u32);
    right_node[0] =
        Node::leaf(right.into(), (first + left_count) as u32, (count - left_count) as u32);
    let (left_room, right_room) = rest.split_at_mut(2 * left_count - 2);
    let (left_indices, right_indices) = indices.split_at_mut(left_count);
    let below_left = Subtree {
        descendants: left_room,
        first_node: first_node + 2,
        indices: left_indices,
        first,
    };
    let below_right = Subtree {
        descendants: right_room,
        first_node: first_node + 2 * left_count,
        indices: right_indices,
        first: first + left_count,
    };
    crate::parallel::join_if(
        count > PARALLEL_SUBTREES,
        || subdivide(bounds, splitter, &mut left_node[0], below_left, depth + 1),
        || subdivide(bounds, splitter, &mut right_node[0], below_right, depth + 1),
    );
}

/// Halves a set by the order of its centroids along the axis on which these spread most. Always succeeds.
pub(crate) fn split_at_median(bounds: &[PackedAabb], indices: &mut [u32]) -> Split {
    let center = |&i: &u32| bounds[i as usize].center();
    let centers = indices.iter().fold(PackedAabb::EMPTY, |centers, i| centers.including(center(i)));
    let axis = Aabb::from(centers).extent().max_axis();
    let left_count = indices.len() / 2;
    indices.select_nth_unstable_by(left_count, |a, b| {
        center(a)[axis].total_cmp(&center(b)[axis]).then_with(|| a.cmp(b))
    });
    Split::at(bounds, indices, left_count)
}

/// Divides a set by a property of each primitive's box; `None` if all or none have it.
pub(super) fn partition_by(
    bounds: &[PackedAabb],
    indices: &mut [u32],
    goes_left: impl Fn(&PackedAabb) -> bool,
) -> Option<Split> {
    let left_count = partition(indices, |i| goes_left(&bounds[i as usize]));
    let divides = 0 < left_count && left_count < indices.len();
    divides.then(|| Split::at(bounds, indices, left_count))
}

/// Copies the reachable nodes of a pool in depth-first order, pair by pair, without the room that leaves of several
/// primitives left unused.
fn close_gaps(pool: &[Node]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(pool.len());
    nodes.push(pool[0]);
    // Parents whose children are still to be copied, by their new number.
    let mut pending = vec![0usize];
    while let Some(parent) = pending.pop() {
        if nodes[parent].is_leaf() {
            continue;
        }
        let (left, left_in_pool) = (nodes.len(), nodes[parent].left_first() as usize);
        nodes[parent] = nodes[parent].with_children_at(left as u32);
        nodes.extend_from_slice(&pool[left_in_pool..left_in_pool + 2]);
        pending.push(left + 1);
        pending.push(left);
    }
    nodes.shrink_to_fit();
    nodes
}

/// Moves the numbers for which `goes_left` holds to the front, in place, and tells how many they are.
pub(super) fn partition(indices: &mut [u32], goes_left: impl Fn(u32) -> bool) -> usize {
    let (mut left, mut right) = (0, indices.len());
    while left < right {
        if goes_left(indices[left]) {
            left += 1;
        } else {
            right -= 1;
            indices.swap(left, right);
        }
    }
    left
}
