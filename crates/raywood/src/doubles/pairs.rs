//! Which triangles of two meshes of double precision touch each other.

use std::ops::ControlFlow;

use super::Bvh64;
use crate::double::sub;
use crate::geometry::triangles_touch_in_double;
use crate::simd::dispatch_on;
use crate::structures::wide::pairs::Pairs;

impl Bvh64 {
    /// Tells `visit` all pairs of a triangle of this mesh and one of another that touch, each once, in no particular order, until it breaks. Both lie in the same
    /// space as they are.
    ///
    /// Triangles touch if they have a point in common, within `2^-40` of the largest coordinate as both are seen from a corner of the first: of their sizes, however far from zero they lie. In about
    /// the time of the pairs whose boxes touch.
    ///
    /// ```
    /// use raywood::{Bvh64, TriangleMesh64};
    ///
    /// // Two triangles of some micrometres, a million metres away: one stands on the other.
    /// let [x, e] = [1e6, 1e-6];
    /// let flat = vec![[x, 0.0, 0.0], [x + 4.0 * e, 0.0, 0.0], [x, 4.0 * e, 0.0]];
    /// let upright = vec![[x + e, e, -e], [x + e, e, e], [x + 3.0 * e, 3.0 * e, 0.0]];
    /// let build = |corners| Ok::<_, Box<dyn std::error::Error>>(Bvh64::build(TriangleMesh64::new(corners, vec![[0, 1, 2]])?)?);
    /// assert!(build(flat)?.overlaps_any_of(&build(upright)?));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overlapping_pairs(
        &self,
        other: &Self,
        mut visit: impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let visit = |first: u32, second: u32| {
            let (own, others) = (self.mesh.corners(first), other.mesh.corners(second));
            let seen = |triangle: [[f64; 3]; 3]| triangle.map(|corner| sub(corner, own[0]));
            match triangles_touch_in_double(seen(own), seen(others)) {
                true => visit(first, second),
                false => ControlFlow::Continue(()),
            }
        };
        let place = self.frame.place_of(&other.frame);
        let pairs = Pairs { first: &self.tree, second: &other.tree, place, visit };
        dispatch_on(self.tree.level(), pairs)
    }

    /// Whether anything of this mesh touches anything of another: [`overlapping_pairs`](Self::overlapping_pairs) up to the first.
    pub fn overlaps_any_of(&self, other: &Self) -> bool {
        self.overlapping_pairs(other, |_, _| ControlFlow::Break(())).is_break()
    }
}
