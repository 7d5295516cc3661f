//! The binary tree along the curve, down to where its nodes have at most sixteen leaves: what is below these needs no tree, for one wide node holds it.

use std::ops::Range;

use crate::Geometry;
use crate::build::{Cancelled, PackedAabb, Stretch, Work};
use crate::geometry::LANES;
use crate::parallel::join_if;
use crate::structures::wide::division::Division;
use crate::structures::wide::node::WIDTH;
use crate::structures::wide::sharing::Sharing;

/// Stretches of more primitives are divided in parallel.
const PARALLEL: usize = 4096;

/// So many leaves are a group at most: one node. Groups of eight make trees better by 1 to 6%, but slower to build and larger by 7%.
const MAX_GROUP: usize = WIDTH;

/// A tree, or a part of one.
pub(super) enum Tree {
    /// A small one, made by one thread.
    Piece(Piece),
    /// Two of them.
    Pair(Box<Pair>),
}

/// Two trees.
pub(super) struct Pair {
    pub(super) children: [Tree; 2],
    sizes: Sizes,
    /// How its trees are divided among its children, as soon as that is known.
    pub(super) division: Division,
}

/// A small tree.
pub(super) struct Piece {
    /// Where the leaves start, in order, and where the last one ends.
    pub(super) starts: Vec<u32>,
    /// The boxes of the leaves, and the references to them, as soon as these are known.
    pub(super) leaves: Vec<PackedAabb>,
    /// The nodes with more than sixteen leaves, children first.
    pub(super) branches: Vec<Branch>,
    pub(super) root: Bough,
    sizes: Sizes,
}

/// A node with more than sixteen leaves.
#[derive(Clone, Copy)]
pub(super) struct Branch {
    pub(super) children: [Bough; 2],
    /// How its trees are divided among its children, as soon as that is known.
    pub(super) division: Division,
}

/// A node of a piece.
#[derive(Clone, Copy)]
pub(super) enum Bough {
    /// One with more than sixteen leaves, by its number.
    Branch(u32),
    /// A group of up to sixteen leaves side by side, from the one of the first number on.
    Group { first: u32, count: u32 },
}

/// What grows a tree.
pub(super) struct Planter<'a, G> {
    pub(super) geometry: &'a G,
    /// How many primitives a leaf has at most.
    pub(super) most: usize,
}

impl<G: Geometry> Planter<'_, G> {
    /// Divides a stretch, in which there is something. O(n), in parallel, the same for any number of threads.
    pub(super) fn grow(&self, mut stretch: Stretch<'_>, work: Work<'_>) -> Result<Tree, Cancelled> {
        let count = stretch.len();
        work.check()?;
        if count <= PARALLEL {
            let end = (stretch.first() + count) as u32;
            let mut piece = Piece {
                starts: Vec::new(),
                leaves: Vec::new(),
                branches: Vec::new(),
                root: Bough::Group { first: 0, count: 0 },
                sizes: Sizes::default(),
            };
            piece.root = self.divide(stretch.reborrowed(), &mut piece);
            piece.starts.push(end);
            piece.measure();
            work.done()?;
            return Ok(Tree::Piece(piece));
        }
        let (left, right) = stretch.split(self.geometry, work);
        work.check()?;
        let [left_work, right_work] = work.shares([left.len() as f64, right.len() as f64]);
        let (left, right) =
            join_if(true, || self.grow(left, left_work), || self.grow(right, right_work));
        let children = [left?, right?];
        let [left, right] = [children[0].sizes(), children[1].sizes()];
        let sizes = Sizes { blocks: left.blocks + right.blocks, nodes: left.nodes + right.nodes };
        Ok(Tree::Pair(Box::new(Pair { children, sizes, division: Division::default() })))
    }

    /// Adds a stretch to a piece.
    fn divide(&self, stretch: Stretch<'_>, piece: &mut Piece) -> Bough {
        if stretch.len() <= self.most {
            piece.starts.push(stretch.first() as u32);
            return Bough::Group { first: piece.starts.len() as u32 - 1, count: 1 };
        }
        let (left, right) = stretch.split(self.geometry, Work::UNWATCHED);
        let children = [self.divide(left, piece), self.divide(right, piece)];
        if let [Bough::Group { first, count: left }, Bough::Group { count: right, .. }] = children
            && (left + right) as usize <= MAX_GROUP
        {
            return Bough::Group { first, count: left + right };
        }
        piece.branches.push(Branch { children, division: Division::default() });
        Bough::Branch(piece.branches.len() as u32 - 1)
    }
}

/// How large a tree is.
#[derive(Clone, Copy, Default)]
pub(super) struct Sizes {
    /// How many blocks its leaves take, the leaves of a group sharing them.
    pub(super) blocks: usize,
    /// About how many nodes a wide tree over it has: some more than there are groups. Twice as many are the limit.
    pub(super) nodes: usize,
}

impl Tree {
    pub(super) fn sizes(&self) -> Sizes {
        match self {
            Self::Piece(piece) => piece.sizes,
            Self::Pair(pair) => pair.sizes,
        }
    }

    /// How much memory it takes with the boxes of its leaves.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Piece(Piece { starts, branches, .. }) => {
                let leaves = starts.len() * size_of::<PackedAabb>();
                size_of_val(&starts[..]) + leaves + size_of_val(&branches[..])
            }
            Self::Pair(pair) => pair.children.iter().map(Self::bytes).sum(),
        }
    }
}

impl Piece {
    /// Its primitives, on the curve.
    pub(super) fn span(&self) -> Range<usize> {
        let [first, .., end] = self.starts[..] else { return 0..0 };
        first as usize..end as usize
    }

    /// The primitives of a leaf.
    pub(super) fn leaf(&self, number: usize) -> Range<usize> {
        self.starts[number] as usize..self.starts[number + 1] as usize
    }

    /// How many primitives the leaves of a group have.
    pub(super) fn leaf_sizes(&self, first: u32, count: u32) -> [usize; WIDTH] {
        let mut sizes = [0; WIDTH];
        for (size, number) in sizes.iter_mut().zip(first as usize..(first + count) as usize) {
            *size = self.leaf(number).len();
        }
        sizes
    }

    /// Measures it, which is complete.
    fn measure(&mut self) {
        let boughs = self.branches.iter().flat_map(|branch| &branch.children).chain([&self.root]);
        let mut sizes = Sizes::default();
        let mut groups = 0;
        for &bough in boughs {
            if let Bough::Group { first, count } = bough {
                let mut leaves = [0; LANES + 1];
                let group = self.leaf_sizes(first, count);
                group.iter().for_each(|&size| leaves[size] += 1);
                sizes.blocks += Sharing::blocks(leaves);
                groups += 1;
            }
        }
        sizes.nodes = groups + groups / 8 + 1;
        self.sizes = sizes;
    }
}
