//! Watching a traversal: the source of test counts and heat maps.

use std::iter::Sum;
use std::ops::{Add, AddAssign};

/// Is told what a traversal does. The unit type `()` ignores it all and compiles to nothing.
pub trait Probe {
    /// Whether it makes nothing of what it is told, as `()`: then it need not be told anything.
    const IS_BLIND: bool = false;

    /// Some nodes of a tree, or cells of a grid, were entered.
    #[inline]
    fn nodes(&mut self, count: usize) {
        let _ = count;
    }

    /// Some boxes were tested against the ray. Steps over the planes of a grid or a kD-tree are not box tests: what they cost shows
    /// in the number of [`nodes`](Self::nodes).
    #[inline]
    fn boxes(&mut self, count: usize) {
        let _ = count;
    }

    /// Some primitives were tested against the ray.
    #[inline]
    fn primitives(&mut self, count: usize) {
        let _ = count;
    }

    /// Some references were met in the cells of a structure that divides space: as many primitives would be tested if a mailbox did not
    /// know some of them already.
    #[inline]
    fn references(&mut self, count: usize) {
        let _ = count;
    }

    /// A packet of so many rays entered a node, and so many of them hit it: a number that takes a test of every ray to find, and so is found
    /// only if asked for. [`nodes`](Self::nodes) is told of the node, too.
    #[inline]
    fn packet_node(&mut self, rays: usize, hitting: impl FnOnce() -> usize) {
        let _ = (rays, hitting);
    }
}

impl Probe for () {
    const IS_BLIND: bool = true;
}

/// A probe that counts, over as many rays as it is handed to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Nodes or cells entered.
    pub nodes: u64,
    /// Boxes tested.
    pub boxes: u64,
    /// Primitives tested.
    pub primitives: u64,
}

impl Probe for Counts {
    #[inline]
    fn nodes(&mut self, count: usize) {
        self.nodes += count as u64;
    }

    #[inline]
    fn boxes(&mut self, count: usize) {
        self.boxes += count as u64;
    }

    #[inline]
    fn primitives(&mut self, count: usize) {
        self.primitives += count as u64;
    }
}

impl Add for Counts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            nodes: self.nodes + other.nodes,
            boxes: self.boxes + other.boxes,
            primitives: self.primitives + other.primitives,
        }
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for Counts {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), Self::add)
    }
}
