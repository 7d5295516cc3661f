//! From two children a node to sixteen: which nodes of the binary tree are kept, by the surface area heuristic. Ylitie, Karras and Laine,
//! "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017, section 3.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::division::{Division, Trees};
use super::node::{WIDTH, WideNode};
use super::parts::Parts;
use super::sharing::Sharing;
use crate::Bvh2;
use crate::build::{Cancelled, Work};
use crate::geometry::{LANES, TriangleBlock};
use crate::parallel::{self, join_if};

/// How many cache lines a node takes.
pub(super) const NODE_LINES: usize = size_of::<WideNode>() / 64;

/// How many cache lines a block takes.
pub(super) const BLOCK_LINES: usize = size_of::<TriangleBlock>() / 64;

/// What visiting a leaf costs, in visits to nodes.
const LEAF_COST: f32 = 1.0;

/// Subtrees with more nodes below them are looked at in parallel.
const PARALLEL_NODES: usize = 4096;

/// All references below a node of a binary tree.
pub(super) fn primitives(tree: &Bvh2, number: usize) -> &[u32] {
    // They lie side by side, from those of the leftmost leaf to those of the rightmost.
    let nodes = tree.nodes();
    let (mut first, mut last) = (&nodes[number], &nodes[number]);
    while !first.is_leaf() {
        first = tree.children(first)[0];
    }
    while !last.is_leaf() {
        last = tree.children(last)[1];
    }
    let range = first.left_first() as usize..(last.left_first() + last.count()) as usize;
    &tree.primitive_indices()[range]
}

/// What is best for each node of a binary tree.
pub(super) struct Plan {
    choices: Vec<Choice>,
    /// What the whole tree costs: visits to nodes and leaves of a ray that meets the box around everything.
    cost: f32,
    /// How many cache lines everything below the wide node takes that a node becomes, if it becomes one.
    lines_below: Vec<AtomicU32>,
}

/// What is best for one node.
#[derive(Clone, Copy)]
struct Choice {
    /// How its trees are divided among its children. First stands whether the node becomes a leaf when its subtree is to be one tree.
    trees: Division,
}

impl Choice {
    const NONE: Self = Self { trees: [0; WIDTH] };
}

/// What a subtree is as so many separate trees.
struct Subtree {
    trees: Trees,
    /// How many primitives it has.
    primitives: u32,
}

impl Plan {
    /// Finds what costs least. O(nodes), in parallel.
    pub(super) fn new(tree: &Bvh2, parts: &Parts, work: Work<'_>) -> Result<Self, Cancelled> {
        let [making_room, searching, counting] = work.shares([1.0, 10.0, 1.0]);
        let mut choices = making_room.copies(Choice::NONE, tree.nodes().len())?;
        let mut cost = 0.0;
        if let Some((root, below)) = choices.split_first_mut() {
            let root_area = tree.bounds().half_area();
            cost = Search { tree, root_area, work: searching }.best(0, root, below).trees.costs[0];
        }
        work.check()?;
        let lines_below = tree.nodes().iter().map(|_| AtomicU32::new(0)).collect();
        let plan = Self { choices, cost, lines_below };
        if !tree.nodes().is_empty() && !plan.is_leaf(0) {
            let counter = LineCounter { plan: &plan, tree, parts, work: counting };
            counter.count(0, true);
        }
        counting.done()?;
        Ok(plan)
    }

    /// How those of some children that become leaves share blocks.
    pub(super) fn sharing(&self, tree: &Bvh2, parts: &Parts, children: &Children) -> Sharing {
        let mut counts = [0; WIDTH];
        for (count, child) in counts.iter_mut().zip(children.numbers()) {
            if self.is_leaf(child) {
                *count = parts.distinct(primitives(tree, child)).count();
            }
        }
        Sharing::of(&counts)
    }

    /// What the whole tree costs by the surface area heuristic: visits to nodes and leaves of a ray that meets the box around everything.
    pub(super) fn cost(&self) -> f32 {
        self.cost
    }

    /// How much memory it takes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.choices[..]) + size_of_val(&self.lines_below[..])
    }

    /// Whether the node of the binary tree becomes a leaf, given that it becomes one tree.
    pub(super) fn is_leaf(&self, number: usize) -> bool {
        self.choices[number].trees[0] == 1
    }

    /// How many cache lines everything below a node takes, given that it becomes one tree and no leaf.
    pub(super) fn lines_below(&self, number: usize) -> usize {
        self.lines_below[number].load(Relaxed) as usize
    }

    /// The nodes of the binary tree that become the children of the wide node in the place of one of them, which is no leaf: first those that become nodes.
    ///
    /// Rays that ask for any hit visit the last of the children that they meet first, and leaves are where hits are found.
    pub(super) fn children(&self, tree: &Bvh2, number: usize) -> Children {
        let mut children = Children { numbers: [0; WIDTH], count: 0 };
        self.collect(tree, (number, WIDTH), true, &mut children);
        children.numbers[..children.count].sort_by_key(|&child| self.is_leaf(child as usize));
        children
    }

    /// Adds the trees that a subtree becomes, at most so many.
    fn collect(
        &self,
        tree: &Bvh2,
        (number, mut trees): (usize, usize),
        must_divide: bool,
        children: &mut Children,
    ) {
        let choice = &self.choices[number].trees;
        while !must_divide && trees > 1 && choice[trees - 1] == 0 {
            trees -= 1;
        }
        if trees == 1 {
            children.numbers[children.count] = number as u32;
            children.count += 1;
            return;
        }
        let to_left = usize::from(choice[trees - 1]);
        let left = tree.nodes()[number].left_first() as usize;
        self.collect(tree, (left, to_left), false, children);
        self.collect(tree, (left + 1, trees - to_left), false, children);
    }
}

/// Some nodes of the binary tree.
pub(super) struct Children {
    numbers: [u32; WIDTH],
    count: usize,
}

impl Children {
    pub(super) fn numbers(&self) -> impl Iterator<Item = usize> {
        self.numbers[..self.count].iter().map(|&number| number as usize)
    }
}

/// Counts cache lines.
struct LineCounter<'a> {
    plan: &'a Plan,
    tree: &'a Bvh2,
    parts: &'a Parts,
    work: Work<'a>,
}

impl LineCounter<'_> {
    /// Counts those below the wide node that a node becomes; in parallel if it is large.
    fn count(&self, number: usize, is_large: bool) -> usize {
        let Self { plan, tree, parts, work } = *self;
        if is_large && work.without_progress().ask().is_err() {
            return 0;
        }
        let children = plan.children(tree, number);
        let nodes = children.numbers().filter(|&child| !plan.is_leaf(child));
        let below: usize = match is_large {
            true => parallel::map_tasks(nodes.collect(), |child| {
                let is_large = primitives(tree, child).len() > PARALLEL_NODES;
                NODE_LINES + self.count(child, is_large)
            })
            .into_iter()
            .sum(),
            false => nodes.map(|child| NODE_LINES + self.count(child, false)).sum(),
        };
        let lines = below + BLOCK_LINES * plan.sharing(tree, parts, &children).blocks;
        plan.lines_below[number].store(u32::try_from(lines).unwrap_or(u32::MAX), Relaxed);
        lines
    }
}

/// The search for the best plan.
struct Search<'a> {
    tree: &'a Bvh2,
    root_area: f64,
    work: Work<'a>,
}

impl Search<'_> {
    /// The same of a child of a large node; if it is not large itself, it is reported.
    fn best_of_large(&self, number: usize, choice: &mut Choice, below: &mut [Choice]) -> Subtree {
        let nodes = 1 + below.len();
        let best = self.best(number, choice, below);
        if nodes <= PARALLEL_NODES {
            // If the build is stopped, the next large node sees it.
            let _ = self.work.part(nodes, self.tree.nodes().len()).done();
        }
        best
    }

    /// Finds what is best for a node and all nodes below it, whose choices lie side by side.
    fn best(&self, number: usize, choice: &mut Choice, below: &mut [Choice]) -> Subtree {
        let node = &self.tree.nodes()[number];
        // Relative to the root's, which neither overflows nor vanishes; of a line every part is met as often as the whole.
        let area = match self.root_area > 0.0 {
            true => (node.bounds().half_area() / self.root_area) as f32,
            false => 1.0,
        };
        if node.is_leaf() {
            choice.trees[0] = 1;
            let trees = Trees::one(area * LEAF_COST);
            return Subtree { trees, primitives: node.count() };
        }

        // The nodes of a tree lie depth first, pair by pair: below the pair first what is below its left node.
        let first = node.left_first() as usize;
        let (pair, below) = below.split_at_mut(2);
        let parallel = below.len() > PARALLEL_NODES;
        if parallel && self.work.check().is_err() {
            return Subtree { trees: Trees::one(0.0), primitives: 0 };
        }
        let right_node = &self.tree.nodes()[first + 1];
        let below_left = match right_node.is_leaf() {
            true => below.len(),
            false => right_node.left_first() as usize - (first + 2),
        };
        let (below_left, below_right) = below.split_at_mut(below_left);
        let [left, right] = pair else { unreachable!("two children") };
        let (left, right) = match parallel {
            true => join_if(
                true,
                || self.best_of_large(first, left, below_left),
                || self.best_of_large(first + 1, right, below_right),
            ),
            false => (self.best(first, left, below_left), self.best(first + 1, right, below_right)),
        };
        let primitives = left.primitives.saturating_add(right.primitives);

        // One tree: a leaf, or a node over sixteen.
        let as_leaf = match primitives as usize <= LANES {
            true => area * LEAF_COST,
            false => f32::INFINITY,
        };
        let mut is_leaf = false;
        let (trees, division) = Trees::of_node(&left.trees, &right.trees, |below| {
            let as_node = area + below;
            is_leaf = as_leaf <= as_node && as_leaf.is_finite();
            as_leaf.min(as_node)
        });
        choice.trees = division;
        choice.trees[0] = u8::from(is_leaf);
        Subtree { trees, primitives }
    }
}
