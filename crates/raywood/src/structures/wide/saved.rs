//! The wide tree as it is saved: its memory as it is, and what else cannot be found out from that.

use super::WideBvh;
use super::node::Reference;
use super::parts::Parts;
use super::sound::{Unsound, check};
use crate::simd::{Arena, SimdLevel};
use crate::{Aabb, TriangleTest};

/// What is saved of a wide tree. How far its boxes reach and how deep it is follow from these.
pub(crate) struct SavedWide {
    pub(crate) bounds: Aabb,
    pub(crate) primitives: u32,
    pub(crate) triangle_test: TriangleTest,
    /// The bits of the reference to the root.
    pub(crate) root: u32,
    /// Nodes and blocks.
    pub(crate) arena: Arena,
    /// A bit for each primitive that lies in several leaves; empty if none does.
    pub(crate) parts: Vec<u64>,
}

impl WideBvh {
    /// What is saved of the tree but its memory and parts.
    pub(crate) fn saved_root(&self) -> (Aabb, u32, TriangleTest, u32) {
        (self.bounds, self.primitives, self.triangle_test, self.root.0)
    }

    /// Its nodes and blocks, as they lie in memory.
    pub(crate) fn saved_lines(&self) -> &[u8] {
        self.arena.as_bytes()
    }

    /// Bits of the primitives that lie in several leaves; none if none does.
    pub(crate) fn saved_parts(&self) -> &[u64] {
        self.parts.bits()
    }

    /// A tree that was saved, over so many primitives of which the first `triangles` are triangles and all others are not.
    ///
    /// Whatever it holds, no query of the tree that comes out panics, reads what it must not, or takes longer than one of some tree as large. That boxes and triangles are those
    /// of the geometry is not known: see [`validate`](crate::AccelerationStructure::validate).
    ///
    /// Besides it tells the checksum of the memory, which is read only once for both.
    pub(crate) fn from_saved(saved: SavedWide, triangles: u32) -> Result<(Self, u32), Unsound> {
        let SavedWide { bounds, primitives, triangle_test, root, arena, parts } = saved;
        let parts = Parts::from_bits(parts, &bounds);
        let mut tree = Self {
            bounds,
            primitives,
            triangle_test,
            reach: bounds.min.abs().max(bounds.max.abs()).max_element(),
            parts,
            depth: 0,
            root: Reference(root),
            arena,
            level: SimdLevel::active(),
        };
        let checked = check(&tree, triangles)?;
        tree.depth = checked.depth;
        Ok((tree, checked.checksum))
    }
}
