//! The kD-tree's node of 8 bytes, after Wald, "Realtime Ray Tracing and Interactive Global Illumination", 2004.

/// A node of 8 bytes: eight to a cache line, and two children, which lie side by side, mostly in the same one.
///
/// | bits      | interior node                  | leaf                                                       |
/// | --------- | ------------------------------ | ---------------------------------------------------------- |
/// | 0 to 31   | the plane's position, as `f32` | the first of its places in the primitive indices           |
/// | 32 and 33 | the plane's axis, 0 to 2       | 3                                                          |
/// | 34 to 63  | the left child's number        | the number of its primitives, which may be 0               |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct KdNode {
    position_or_first: u32,
    kind_and_number: u32,
}

const _: () = assert!(size_of::<KdNode>() == 8);

/// The lowest two bits of the second half in a leaf.
const LEAF: u32 = 3;

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Content {
    /// A plane and, by number, the child on its lower side; the other child follows it.
    Plane { axis: usize, position: f32, left: usize },
    /// A stretch of the primitive indices.
    Leaf { first: usize, count: usize },
}

impl KdNode {
    /// Numbers of nodes and counts of primitives lie below this.
    pub(super) const NUMBERS: usize = 1 << 30;

    pub(super) fn leaf(first: usize, count: usize) -> Self {
        debug_assert!(count < Self::NUMBERS);
        Self { position_or_first: first as u32, kind_and_number: (count as u32) << 2 | LEAF }
    }

    pub(super) fn plane(axis: usize, position: f32, left: usize) -> Self {
        debug_assert!(axis < 3 && left < Self::NUMBERS);
        Self {
            position_or_first: position.to_bits(),
            kind_and_number: (left as u32) << 2 | axis as u32,
        }
    }

    /// The node unpacked.
    #[inline(always)]
    pub(super) fn content(self) -> Content {
        let number = (self.kind_and_number >> 2) as usize;
        match self.kind_and_number & 3 {
            LEAF => Content::Leaf { first: self.position_or_first as usize, count: number },
            axis => Content::Plane {
                axis: axis as usize,
                position: f32::from_bits(self.position_or_first),
                left: number,
            },
        }
    }

    /// The same node where its primitives start `places` later and its children lie `nodes` further on.
    pub(super) fn moved(self, nodes: usize, places: usize) -> Self {
        match self.content() {
            Content::Leaf { first, count } => Self::leaf(first + places, count),
            Content::Plane { axis, position, left } => Self::plane(axis, position, left + nodes),
        }
    }
}
