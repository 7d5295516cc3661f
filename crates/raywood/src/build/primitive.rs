//! What top-down builders sort: a primitive's box with its number.

use super::PackedAabb;

/// The box of a primitive and, in the lane of the box that means nothing, its number. Builders move these 32 bytes instead of numbers that refer to boxes, so
/// that they read memory from one end to the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Primitive(PackedAabb);

impl Primitive {
    #[inline(always)]
    pub(super) fn new(number: u32, bounds: PackedAabb) -> Self {
        Self(bounds.with_tag(number))
    }

    /// Its number.
    #[inline(always)]
    pub(super) fn number(&self) -> u32 {
        self.0.tag()
    }

    /// Its box.
    #[inline(always)]
    pub(super) fn bounds(&self) -> &PackedAabb {
        &self.0
    }

    /// The centre of its box.
    #[inline(always)]
    pub(super) fn center(&self) -> [f32; 4] {
        self.0.center()
    }
}
