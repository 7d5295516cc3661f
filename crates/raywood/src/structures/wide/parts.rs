//! Primitives that lie in several leaves, each of which knows the box of a part: what spatial splits make of large triangles.
//!
//! Closest and any hits, closest points and moving spheres do not care how often they see a primitive. Who tells of primitives one by one must not tell of one twice.

use crate::build::part_margin;
use crate::{Bvh2, Vec3};

/// Which primitives lie in several leaves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parts {
    /// A bit each; empty if there are none.
    bits: Vec<u64>,
    /// The middle of the tree's box.
    pub(super) center: Vec3,
    /// How far the box reaches from there along any axis.
    half: f32,
}

impl Parts {
    /// Those that the leaves of a binary tree name more than once.
    pub(super) fn of(tree: &Bvh2, primitives: usize) -> Self {
        let bounds = tree.bounds();
        let references = tree.primitive_indices();
        if references.len() == primitives {
            return Self { bits: Vec::new(), center: Vec3::ZERO, half: 0.0 };
        }
        let words = primitives.div_ceil(64);
        let (mut once, mut several) = (vec![0u64; words], vec![0u64; words]);
        for &reference in references {
            let (word, bit) = (reference as usize / 64, 1 << (reference % 64));
            several[word] |= once[word] & bit;
            once[word] |= bit;
        }
        let (center, half) = part_margin::center_and_half(&bounds);
        Self { bits: several, center, half }
    }

    /// By how much boxes count as larger for a ray that starts at `origin`: nothing where the [margin](part_margin) that the boxes of parts already have is enough.
    #[inline(always)]
    pub(super) fn margin(&self, origin: Vec3) -> f32 {
        if !self.exist() {
            return 0.0;
        }
        self.margin_at((origin - self.center).abs().max_element())
    }

    /// The same for all that starts so far from the [`center`](Self::center) along any axis.
    #[inline(always)]
    pub(super) fn margin_at(&self, distance: f32) -> f32 {
        if !self.exist() || distance <= part_margin::USUAL_DISTANCE * self.half {
            return 0.0;
        }
        part_margin::PER_DISTANCE * (distance + self.half)
    }

    /// Whether there are any.
    #[inline(always)]
    pub(super) fn exist(&self) -> bool {
        !self.bits.is_empty()
    }

    /// Whether the primitive is one of them.
    #[inline(always)]
    pub(super) fn contain(&self, primitive: u32) -> bool {
        self.exist() && self.bits[primitive as usize / 64] >> (primitive % 64) & 1 == 1
    }

    /// How much memory they take.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.bits[..])
    }
}

/// Which primitives have been told of. Only those that lie in several leaves are remembered.
pub(crate) struct Told<'t> {
    parts: &'t Parts,
    /// In order of their numbers.
    numbers: Vec<u32>,
}

impl<'t> Told<'t> {
    pub(super) fn nothing(parts: &'t Parts) -> Self {
        Self { parts, numbers: Vec::new() }
    }

    /// Whether this is the first time that it is asked about the primitive.
    #[inline(always)]
    pub(crate) fn is_new(&mut self, primitive: u32) -> bool {
        !self.parts.contain(primitive) || self.remember(primitive)
    }

    #[inline(never)]
    fn remember(&mut self, primitive: u32) -> bool {
        match self.numbers.binary_search(&primitive) {
            Ok(_) => false,
            Err(place) => {
                self.numbers.insert(place, primitive);
                true
            }
        }
    }
}
