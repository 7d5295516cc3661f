//! Which primitives of two geometries touch each other.

use std::ops::ControlFlow;

use crate::geometry::{triangle_overlaps, triangles_touch};
use crate::simd::dispatch_on;
use crate::structures::wide::pairs::{AsItIs, Pairs};
use crate::{Aabb, Bvh, Geometry};

impl<G: Geometry> Bvh<G> {
    /// Tells `visit` all pairs of a primitive of this geometry and one of another that touch, each once, in no particular order, until it breaks. Both lie in the same
    /// space as they are.
    ///
    /// Triangles touch if they have a point in common, within `2^-40` of the largest coordinate; of other primitives it is told whether they may, as far as boxes and [`Geometry::overlaps`] tell. In about
    /// the time of the pairs whose boxes touch.
    ///
    /// ```
    /// use raywood::{Bvh, TriangleMesh};
    ///
    /// let flat = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]])?;
    /// let upright = TriangleMesh::new(vec![[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [3.0, 3.0, 0.0]], vec![[0, 1, 2]])?;
    /// let (flat, upright) = (Bvh::build(flat)?, Bvh::build(upright)?);
    /// assert!(flat.overlaps_any_of(&upright));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overlapping_pairs<H: Geometry>(
        &self,
        other: &Bvh<H>,
        mut visit: impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let visit = |first: u32, second: u32| {
            let touch = match (self.geometry.triangle(first), other.geometry.triangle(second)) {
                (Some(first), Some(second)) => triangles_touch(first, second),
                (Some(corners), None) => triangle_touches(corners, &other.geometry, second),
                (None, Some(corners)) => triangle_touches(corners, &self.geometry, first),
                (None, None) => {
                    let bounds = self.geometry.bounds(first);
                    !bounds.intersection(&other.geometry.bounds(second)).is_empty()
                }
            };
            if touch { visit(first, second) } else { ControlFlow::Continue(()) }
        };
        let pairs = Pairs { first: &self.tree, second: &other.tree, place: AsItIs, visit };
        dispatch_on(self.tree.level(), pairs)
    }

    /// Whether anything of this geometry touches anything of another: [`overlapping_pairs`](Self::overlapping_pairs) up to the first.
    pub fn overlaps_any_of<H: Geometry>(&self, other: &Bvh<H>) -> bool {
        self.overlapping_pairs(other, |_, _| ControlFlow::Break(())).is_break()
    }
}

/// Whether a triangle may touch a primitive that is none.
fn triangle_touches<G: Geometry>(corners: [crate::Vec3; 3], geometry: &G, primitive: u32) -> bool {
    triangle_overlaps(corners, &geometry.bounds(primitive))
        && geometry.overlaps(primitive, &Aabb::of_points(corners))
}
