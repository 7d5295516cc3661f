//! Trees that keep their shape while primitives move: every box is made anew, from the leaves to the root. Wald, Boulos and Shirley, "Ray Tracing Deformable Scenes Using Dynamic
//! Bounding Volume Hierarchies", 2007.

use super::RefitError;
use crate::build::Work;
use crate::{Bvh, Geometry, WideBvh, parallel};

impl<G: Geometry> Bvh<G> {
    /// Puts the geometry in the place of another in which the same primitives have moved, and makes all boxes of the tree anew. Returns the expected cost
    /// [`Q`](crate::StructureStats::q) of the tree as it is then: the more primitives have left their neighbours, the higher it is, and the longer rays take, however right
    /// their hits are. [`DynamicBvh`](crate::DynamicBvh) looks after that.
    ///
    /// O(N), in parallel in the caller's rayon pool, with the same tree for any number of threads; some twenty times as fast as building. The tree is changed in place, but if clones of it
    /// share its memory, or if that is a loaded file's, it is copied first. As nothing else can use the tree meanwhile, all rays of a batch see the same.
    ///
    /// Primitives that spatial splits had cut count as whole from then on.
    ///
    /// ```
    /// use raywood::{Bvh, Ray, TriangleMesh};
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let mut bvh = Bvh::build(mesh)?;
    /// let moved = bvh.geometry().with_positions(vec![[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]])?;
    /// bvh.refit(moved)?;
    /// assert!(bvh.occluded(&Ray::new([5.2, 0.2, 1.0], [0.0, 0.0, -1.0])));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Another number of primitives, or (from a geometry of your own) one whose box is empty or not finite; a forged tree. Geometry and tree then stay as they were.
    pub fn refit(&mut self, moved: G) -> Result<f64, RefitError> {
        let cost = self.tree.refit(&moved)?;
        self.geometry = moved;
        Ok(cost)
    }
}

impl WideBvh {
    /// Makes all boxes anew for a geometry in which the same primitives have moved, as [`Bvh::refit`], and returns the expected cost `Q`.
    ///
    /// # Errors
    ///
    /// As [`Bvh::refit`].
    pub fn refit<G: Geometry>(&mut self, geometry: &G) -> Result<f64, RefitError> {
        Ok(self.refit_measured(geometry)?.cost)
    }
}

/// Refuses what cannot be the primitives of a tree over so many.
pub(crate) fn check_primitives<G: Geometry>(geometry: &G, tree: usize) -> Result<(), RefitError> {
    if geometry.len() != tree {
        return Err(RefitError::PrimitiveCount { tree, geometry: geometry.len() });
    }
    if geometry.has_sound_bounds() {
        return Ok(());
    }
    let is_bad = |primitive: usize| {
        let bounds = geometry.bounds(primitive as u32);
        bounds.is_empty() || !bounds.is_finite()
    };
    let step = |first: &mut usize, primitive: usize| {
        if is_bad(primitive) {
            *first = primitive.min(*first);
        }
    };
    let merge = |first: &mut usize, other: &usize| *first = *other.min(first);
    match parallel::fold_numbers(tree, Work::UNWATCHED, usize::MAX, step, merge) {
        // Unwatched, it is never cancelled.
        Err(_) | Ok(usize::MAX) => Ok(()),
        Ok(primitive) => {
            let primitive = primitive as u32;
            Err(RefitError::BadBounds { primitive, bounds: geometry.bounds(primitive) })
        }
    }
}
