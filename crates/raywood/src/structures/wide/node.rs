//! The node of sixteen children, and what refers to nodes and leaves.

use crate::{Aabb, BuildError, Vec3};

/// Children of a node.
pub(super) const WIDTH: usize = 16;

/// A node: the boxes of up to sixteen children, and where these are. Seven cache lines.
///
/// | bytes      | content                                                                             |
/// | ---------- | ----------------------------------------------------------------------------------- |
/// | 0 to 383   | six planes a child: smallest x of all children, largest x, smallest y, ..., largest z |
/// | 384 to 447 | a [`Reference`] a child                                                             |
///
/// A child that is not there has an inverted box, which no ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    /// By axis and side: first the smallest, then the largest coordinates.
    pub(super) planes: [[[f32; WIDTH]; 2]; 3],
    pub(super) children: [u32; WIDTH],
}

const _: () = assert!(size_of::<WideNode>() == 448);

impl WideNode {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [Reference::NOTHING.0; WIDTH],
    };

    /// Puts a child into a lane.
    pub(super) fn set(&mut self, lane: usize, bounds: &Aabb, child: Reference) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = bounds.min[axis];
            self.planes[axis][1][lane] = bounds.max[axis];
        }
        self.children[lane] = child.0;
    }

    /// The children that are there, with their boxes.
    pub(super) fn children(&self) -> impl Iterator<Item = (Aabb, Reference)> {
        (0..WIDTH)
            .map(|lane| (self.bounds(lane), Reference(self.children[lane])))
            .filter(|(_, child)| *child != Reference::NOTHING)
    }

    /// The boxes of the children by their lanes.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = (usize, Aabb)> {
        let is_there = |&lane: &usize| self.children[lane] != Reference::NOTHING.0;
        (0..WIDTH).filter(is_there).map(|lane| (lane, self.bounds(lane)))
    }

    /// The box around all children.
    pub(super) fn around(&self) -> Aabb {
        self.children().map(|(bounds, _)| bounds).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The box of the child in a lane.
    #[inline(always)]
    pub(super) fn bounds(&self, lane: usize) -> Aabb {
        let [x, y, z] = &self.planes;
        let min = Vec3::new(x[0][lane], y[0][lane], z[0][lane]);
        let max = Vec3::new(x[1][lane], y[1][lane], z[1][lane]);
        Aabb { min, max }
    }
}

/// Where a node or leaf is, in 32 bits.
///
/// | bits    | node        | leaf                                                   |
/// | ------- | ----------- | ------------------------------------------------------ |
/// | 0       | 0           | 1                                                      |
/// | 1 to 3  | 0           | the number of its primitives, less one                 |
/// | 4       | 0           | whether there are primitives in it that are no triangles |
/// | 5       | 0           | whether it ends with the last lane of its block instead of beginning with the first |
/// | 6 to 31 | the number of the node's or block's first cache line, for both        |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reference(pub(super) u32);

impl Reference {
    /// Nothing: of a tree without primitives, of a child that is not there, and the end of a stack.
    pub(super) const NOTHING: Self = Self(u32::MAX);

    /// Numbers of cache lines lie below this.
    pub(super) const LINES: usize = BuildError::MAX_TREE_BYTES / 64;

    pub(super) fn node(line: usize) -> Self {
        Self((line as u32) << 6)
    }

    pub(super) fn leaf(line: usize, count: usize, mixed: bool, at_end: bool) -> Self {
        let flags = u32::from(at_end) << 5 | u32::from(mixed) << 4;
        Self((line as u32) << 6 | flags | (count as u32 - 1) << 1 | 1)
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & 1 == 1
    }

    /// The number of the first line of the node or leaf.
    #[inline(always)]
    pub(super) fn line(self) -> usize {
        (self.0 >> 6) as usize
    }

    /// How many primitives a leaf has.
    #[inline(always)]
    pub(super) fn count(self) -> usize {
        (self.0 >> 1 & 7) as usize + 1
    }

    /// How many primitives a leaf refers to, and a node none.
    #[inline(always)]
    pub(super) fn references(self) -> usize {
        if self.is_leaf() { self.count() } else { 0 }
    }

    /// The lanes of a leaf's block that hold primitives.
    #[inline(always)]
    pub(super) fn lanes(self) -> u32 {
        let less_one = self.0 >> 1 & 7;
        let first = (7 - less_one) & (0u32.wrapping_sub(self.0 >> 5 & 1));
        ((2 << less_one) - 1) << first
    }

    /// The same leaf in the block from another line on.
    pub(super) fn at(self, line: usize) -> Self {
        Self(self.0 & 63 | (line as u32) << 6)
    }

    /// The same leaf, with primitives that are no triangles or without.
    pub(super) fn mixed_if(self, mixed: bool) -> Self {
        Self(self.0 & !(1 << 4) | u32::from(mixed) << 4)
    }

    /// Whether a leaf has primitives that are no triangles.
    #[inline(always)]
    pub(super) fn is_mixed(self) -> bool {
        self.0 >> 4 & 1 == 1
    }
}
