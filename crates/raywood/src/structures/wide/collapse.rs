//! From two children a node to sixteen: which nodes of the binary tree are kept, by the surface area heuristic. Ylitie, Karras and Laine,
//! "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.

use super::node::WIDTH;
use crate::Bvh2;
use crate::geometry::LANES;

/// What visiting a leaf costs, in visits to nodes.
const LEAF_COST: f32 = 1.0;

/// The costs of a subtree as at most so many separate trees, from one to sixteen, by number less one.
type Costs = [f32; WIDTH];

/// What is best for each node of a binary tree.
pub(super) struct Plan {
    /// How many trees the left child becomes when the node's subtree becomes at most so many, from two to sixteen, by number less one; 0 where fewer
    /// trees are better. First stands whether the node becomes a leaf when its subtree is to be one tree.
    choices: Vec<[u8; WIDTH]>,
}

impl Plan {
    /// Finds what costs least. O(nodes).
    pub(super) fn new(tree: &Bvh2) -> Self {
        let nodes = tree.nodes();
        let root_area = tree.bounds().half_area();
        let mut costs: Vec<Costs> = vec![[f32::INFINITY; WIDTH]; nodes.len()];
        let mut counts = vec![0u32; nodes.len()];
        // Into how many trees a subtree can be divided: as many as it has leaves.
        let mut most = vec![1u8; nodes.len()];
        let mut choices = vec![[0u8; WIDTH]; nodes.len()];

        // Children come after their parents.
        for (number, node) in nodes.iter().enumerate().rev() {
            // Relative to the root's, which neither overflows nor vanishes; of a line every part is met as often as the whole.
            let area = if root_area > 0.0 { node.bounds().half_area() / root_area } else { 1.0 };
            let area = area as f32;
            if node.is_leaf() {
                counts[number] = node.count();
                costs[number][0] = area * LEAF_COST;
                choices[number][0] = 1;
                continue;
            }
            let (left, right) = (node.left_first() as usize, node.left_first() as usize + 1);
            counts[number] = counts[left].saturating_add(counts[right]);

            // Divide so many trees among both children in the best way.
            let mut divided = [f32::INFINITY; WIDTH];
            let (most_left, most_right) = (usize::from(most[left]), usize::from(most[right]));
            let most_here = (most_left + most_right).min(WIDTH);
            most[number] = most_here as u8;
            for trees in 2..=most_here {
                let fewest_left = trees.saturating_sub(most_right).max(1);
                for to_left in fewest_left..=most_left.min(trees - 1) {
                    let cost = costs[left][to_left - 1] + costs[right][trees - to_left - 1];
                    if cost < divided[trees - 1] {
                        divided[trees - 1] = cost;
                        choices[number][trees - 1] = to_left as u8;
                    }
                }
            }

            // One tree: a leaf, or a node over sixteen.
            let as_node = area + divided[most_here - 1];
            choices[number][WIDTH - 1] = choices[number][most_here - 1];
            let as_leaf = match counts[number] as usize <= LANES {
                true => area * LEAF_COST,
                false => f32::INFINITY,
            };
            costs[number][0] = as_leaf.min(as_node);
            choices[number][0] = u8::from(as_leaf <= as_node && as_leaf.is_finite());
            for trees in 2..=most_here {
                let fewer = costs[number][trees - 2];
                if fewer <= divided[trees - 1] {
                    // Sixteen are asked for only when there must be a node here.
                    if trees < WIDTH {
                        choices[number][trees - 1] = 0;
                    }
                    costs[number][trees - 1] = fewer;
                } else {
                    costs[number][trees - 1] = divided[trees - 1];
                }
            }
        }
        Self { choices }
    }

    /// Whether the node of the binary tree becomes a leaf, given that it becomes one tree.
    pub(super) fn is_leaf(&self, number: usize) -> bool {
        self.choices[number][0] == 1
    }

    /// The nodes of the binary tree that become the children of the wide node in the place of one of them, which is no leaf.
    pub(super) fn children(&self, tree: &Bvh2, number: usize) -> Vec<usize> {
        let mut children = Vec::with_capacity(WIDTH);
        let mut pending = vec![(number, WIDTH, true)];
        while let Some((number, mut trees, must_divide)) = pending.pop() {
            if !must_divide {
                while trees > 1 && self.takes_fewer(number, trees) {
                    trees -= 1;
                }
            }
            if trees == 1 {
                children.push(number);
                continue;
            }
            let to_left = usize::from(self.choices[number][trees - 1]);
            let left = tree.nodes()[number].left_first() as usize;
            pending.push((left + 1, trees - to_left, false));
            pending.push((left, to_left, false));
        }
        children
    }

    /// Whether fewer trees than so many are at least as good.
    fn takes_fewer(&self, number: usize, trees: usize) -> bool {
        self.choices[number][trees - 1] == 0
    }
}
