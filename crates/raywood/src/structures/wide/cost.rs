//! What nodes cost by the surface area heuristic, added up subtree by subtree: `Q` as [`StructureStats`](crate::StructureStats) has it, Goldsmith and Salmon 1987.

use crate::Aabb;

/// The cost of some nodes together, as of rays that meet the box around them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cost {
    /// Half areas times what a visit costs.
    by_area: f64,
    /// What visits cost together: all of them where the box around everything has no area.
    by_number: f64,
}

impl Cost {
    /// Adds a node with a box of half such a surface and so many primitives, none in an interior node. A box test costs one, and so does a primitive test.
    #[inline(always)]
    pub(crate) fn add(&mut self, half_area: f64, primitives: usize) {
        let visit = 1.0 + primitives as f64;
        self.by_area += half_area * visit;
        self.by_number += visit;
    }

    /// Adds other nodes.
    #[inline(always)]
    pub(crate) fn add_all(&mut self, other: &Self) {
        self.by_area += other.by_area;
        self.by_number += other.by_number;
    }

    /// The expected cost of a ray that meets a box around all these nodes.
    pub(crate) fn within(&self, bounds: &Aabb) -> f64 {
        let area = bounds.half_area();
        if area > 0.0 { self.by_area / area } else { self.by_number }
    }
}
