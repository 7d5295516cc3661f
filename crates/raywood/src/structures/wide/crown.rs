//! A wide tree as a crown and boughs: the nodes near the root, and the subtrees below them: pieces of work for threads, and what can be cut off where a part of the tree
//! became bad. Which these are depends on the tree alone.

use std::collections::VecDeque;
use std::ops::Range;

use super::WideBvh;
use super::node::Reference;

/// So many boughs are enough for dozens of threads, and small enough that little besides is built anew where a part became bad.
const BOUGHS: usize = 256;

/// Where a node is referred to: the place of the limb that does, and the lane in it.
pub(super) type Parent = (usize, usize);

/// The nodes near the root, and the subtrees below.
pub(super) struct Crown {
    /// Parents before their children; empty if the root is no node.
    pub(super) limbs: Vec<Limb>,
    /// In the order in which they were come to.
    pub(super) boughs: Vec<Bough>,
    /// The leaves that are children of limbs, limb by limb.
    pub(super) twigs: Vec<Parent>,
}

/// A node near the root.
pub(super) struct Limb {
    /// Its first line.
    pub(super) line: usize,
    /// `None` of the root.
    pub(super) parent: Option<Parent>,
    /// Where its leaves stand among the twigs.
    pub(super) twigs: Range<usize>,
}

impl Limb {
    /// The reference to it.
    pub(super) fn reference(&self) -> Reference {
        Reference::node(self.line)
    }
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
        let (mut limbs, mut twigs) = (Vec::new(), Vec::new());
        let mut open = VecDeque::new();
        if tree.root != Reference::NOTHING && !tree.root.is_leaf() {
            open.push_back((tree.root.line(), None, 0));
        }
        while open.len() < BOUGHS
            && let Some((line, parent, depth)) = open.pop_front()
        {
            let children = tree.node(Reference::node(line)).children.map(Reference);
            let first_twig = twigs.len();
            for (lane, child) in children.into_iter().enumerate() {
                let own = (limbs.len(), lane);
                match child {
                    Reference::NOTHING => {}
                    leaf if leaf.is_leaf() => twigs.push(own),
                    node => open.push_back((node.line(), Some(own), depth + 1)),
                }
            }
            limbs.push(Limb { line, parent, twigs: first_twig..twigs.len() });
        }
        // The root is opened first, so that all that is left has a parent.
        let bough = |(line, parent, depth): (usize, Option<Parent>, usize)| {
            parent.map(|parent| Bough { line, parent, depth })
        };
        let boughs = open.into_iter().filter_map(bough).collect();
        Self { limbs, boughs, twigs }
    }

    /// Where the subtrees that can be cut off are referred to: the boughs, then the twigs.
    pub(super) fn cuttings(&self) -> impl Iterator<Item = Parent> {
        self.boughs.iter().map(|bough| bough.parent).chain(self.twigs.iter().copied())
    }
}
