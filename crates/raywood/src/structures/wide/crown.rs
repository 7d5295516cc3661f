//! A wide tree as a crown and boughs: the nodes near the root, and the subtrees below them, which are pieces of work for threads and what is built anew where a part of the tree
//! became bad. Which these are depends on the tree alone.

use std::collections::VecDeque;

use super::WideBvh;
use super::node::Reference;

/// So many boughs are enough for any number of threads that we care about, and small enough to be built anew one by one.
const BOUGHS: usize = 256;

/// Where a node is referred to: the place of the limb that does, and the lane in it.
pub(super) type Parent = (usize, usize);

/// The nodes near the root, and the subtrees below.
pub(super) struct Crown {
    /// Parents before their children; empty if the root is no node.
    pub(super) limbs: Vec<Limb>,
    /// In the order in which they were come to.
    pub(super) boughs: Vec<Bough>,
}

/// A node near the root.
pub(super) struct Limb {
    /// Its first line.
    pub(super) line: usize,
    /// `None` of the root.
    pub(super) parent: Option<Parent>,
}

/// A subtree.
#[derive(Clone, Copy)]
pub(super) struct Bough {
    /// The first line of the node on top of it.
    pub(super) line: usize,
    pub(super) parent: Parent,
    /// How many nodes lie above it.
    pub(super) depth: usize,
}

impl Crown {
    /// That of a tree: nodes are opened level by level until there are enough subtrees.
    pub(super) fn of(tree: &WideBvh) -> Self {
        let mut limbs = Vec::new();
        let mut open = VecDeque::new();
        if tree.root != Reference::NOTHING && !tree.root.is_leaf() {
            open.push_back((tree.root.line(), None, 0));
        }
        while open.len() < BOUGHS
            && let Some((line, parent, depth)) = open.pop_front()
        {
            let children = tree.node(Reference::node(line)).children.map(Reference);
            for (lane, child) in children.into_iter().enumerate() {
                if child != Reference::NOTHING && !child.is_leaf() {
                    open.push_back((child.line(), Some((limbs.len(), lane)), depth + 1));
                }
            }
            limbs.push(Limb { line, parent });
        }
        // The root is opened first, so that all that is left has a parent.
        let bough = |(line, parent, depth): (usize, Option<Parent>, usize)| {
            parent.map(|parent| Bough { line, parent, depth })
        };
        let boughs = open.into_iter().filter_map(bough).collect();
        Self { limbs, boughs }
    }
}
