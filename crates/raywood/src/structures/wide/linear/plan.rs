//! Which nodes of the binary tree along the curve become nodes of the wide tree.

use super::tree::{Bough, Pair, Piece, Tree};
use crate::build::PackedAabb;
use crate::parallel;
use crate::structures::wide::division::Division;
use crate::structures::wide::node::WIDTH;

/// The plan for a node and everything below it.
pub(super) enum Planned<'t> {
    /// A large one.
    Large(Box<Large<'t>>),
    /// One that lies in one piece of the binary tree.
    Small(Small<'t>),
}

/// A node that is filled by several threads.
pub(super) struct Large<'t> {
    pub(super) children: Children<'t>,
    /// The plans for those children that are nodes.
    pub(super) nodes: Vec<Planned<'t>>,
    nodes_below: usize,
}

/// A node that is filled by one thread.
pub(super) struct Small<'t> {
    pub(super) root: Node<'t>,
    nodes_below: usize,
}

/// A node of the binary tree.
#[derive(Clone, Copy)]
pub(super) enum Node<'t> {
    /// A leaf, with the reference to it.
    Leaf(&'t PackedAabb),
    /// Up to sixteen leaves.
    Group(&'t [PackedAabb]),
    /// One with more leaves, in a piece.
    Branch(&'t Piece, u32),
    /// Two trees.
    Pair(&'t Pair),
}

/// The children of a node of the wide tree.
#[derive(Clone, Copy)]
pub(super) struct Children<'t> {
    nodes: [Node<'t>; WIDTH],
    count: usize,
}

impl<'t> Planned<'t> {
    /// The plan for a node. O(n), in parallel, the same for any number of threads.
    pub(super) fn of(root: Node<'t>) -> Self {
        if !matches!(root, Node::Pair(_)) {
            return Self::Small(Small { root, nodes_below: nodes_below(root) });
        }
        let children = Children::of(root);
        let nodes = children.node_lanes().map(|lane| children.all()[lane]).collect();
        let nodes = parallel::map_tasks(nodes, Self::of);
        let nodes_below = nodes.iter().map(|node| 1 + node.nodes_below()).sum();
        Self::Large(Box::new(Large { children, nodes, nodes_below }))
    }

    /// How many nodes lie below the node.
    pub(super) fn nodes_below(&self) -> usize {
        match self {
            Self::Large(large) => large.nodes_below,
            Self::Small(small) => small.nodes_below,
        }
    }
}

/// How many nodes lie below a node.
fn nodes_below(node: Node<'_>) -> usize {
    if let Node::Group(_) = node {
        return 0;
    }
    let children = Children::of(node);
    children.node_lanes().map(|lane| 1 + nodes_below(children.all()[lane])).sum()
}

impl<'t> Node<'t> {
    /// The root of a tree.
    pub(super) fn of(tree: &'t Tree) -> Self {
        match tree {
            Tree::Piece(piece) => Self::in_piece(piece, piece.root),
            Tree::Pair(pair) => Self::Pair(pair),
        }
    }

    fn in_piece(piece: &'t Piece, bough: Bough) -> Self {
        match bough {
            Bough::Branch(number) => Self::Branch(piece, number),
            Bough::Group { first, count } => {
                match &piece.leaves[first as usize..][..count as usize] {
                    [leaf] => Self::Leaf(leaf),
                    leaves => Self::Group(leaves),
                }
            }
        }
    }

    /// What lies below a node that has more than sixteen leaves, and how its trees are divided among both; else all its leaves.
    fn open(self) -> Result<([Self; 2], &'t Division), &'t [PackedAabb]> {
        match self {
            Self::Leaf(leaf) => Err(std::slice::from_ref(leaf)),
            Self::Group(leaves) => Err(leaves),
            Self::Branch(piece, number) => {
                let branch = &piece.branches[number as usize];
                Ok((branch.children.map(|child| Self::in_piece(piece, child)), &branch.division))
            }
            Self::Pair(pair) => {
                let [left, right] = &pair.children;
                Ok(([Self::of(left), Self::of(right)], &pair.division))
            }
        }
    }
}

impl<'t> Children<'t> {
    /// The best children of a node: first those that are nodes, as in every wide tree.
    pub(super) fn of(node: Node<'t>) -> Self {
        let mut children = Self { nodes: [node; WIDTH], count: 0 };
        children.collect(node, WIDTH, true);
        children.nodes[..children.count].sort_by_key(|child| matches!(child, Node::Leaf(_)));
        children
    }

    /// Adds the trees that a subtree becomes, at most so many.
    fn collect(&mut self, node: Node<'t>, mut trees: usize, must_divide: bool) {
        match node.open() {
            Err(leaves) if must_divide || leaves.len() <= trees => {
                leaves.iter().for_each(|leaf| self.push(Node::Leaf(leaf)));
            }
            Err(_) => self.push(node),
            Ok(([left, right], division)) => {
                while !must_divide && trees > 1 && division[trees - 1] == 0 {
                    trees -= 1;
                }
                if trees == 1 {
                    return self.push(node);
                }
                let to_left = usize::from(division[trees - 1]);
                self.collect(left, to_left, false);
                self.collect(right, trees - to_left, false);
            }
        }
    }

    fn push(&mut self, child: Node<'t>) {
        self.nodes[self.count] = child;
        self.count += 1;
    }

    pub(super) fn all(&self) -> &[Node<'t>] {
        &self.nodes[..self.count]
    }

    /// The lanes of those that are nodes.
    pub(super) fn node_lanes(&self) -> impl Iterator<Item = usize> + Clone {
        (0..self.count).filter(|&lane| !matches!(self.nodes[lane], Node::Leaf(_)))
    }
}
