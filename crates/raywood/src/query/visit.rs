//! A walk through the tree for questions of one's own.

use std::ops::ControlFlow;

use crate::{Aabb, Bvh, Geometry};

impl<G: Geometry> Bvh<G> {
    /// Walks through the tree, the most promising boxes first: for questions that the library does not know.
    ///
    /// `bound` is asked for a lower bound, of whatever is to be small, over all that lies in a box; `None` leaves the box out. `visit` is given the number of each
    /// primitive in the boxes that remain, once, and returns the limit from there on: boxes of larger bounds are left out. With a
    /// break the walk ends. Boxes inside the same box are entered in the order of their bounds. With a bound that is NaN
    /// the box is entered.
    ///
    /// The boxes hold the bounds of what is below them, so a bound never falls on the way down if it is one of the box. O(nodes visited), by plain code: the queries
    /// that the library knows are faster.
    ///
    /// ```
    /// use raywood::{Aabb, Bvh, Spheres, Vec3};
    /// use std::ops::ControlFlow;
    ///
    /// // The highest of some spheres, in the part of space where x is positive.
    /// let spheres = Spheres::new((0..100).map(|i| (Vec3::new(i as f32 - 50.0, (i * 37 % 100) as f32, 0.0), 0.5)).collect())?;
    /// let bvh = Bvh::build(&spheres)?;
    /// let (mut highest, mut height) = (None, f32::NEG_INFINITY);
    /// let bound = |bounds: &Aabb| (bounds.max.x > 0.0).then_some(-bounds.max.y);
    /// let _ = bvh.visit(bound, |primitive| {
    ///     let (center, _) = spheres.as_slice()[primitive as usize];
    ///     if center.x > 0.0 && center.y > height {
    ///         (highest, height) = (Some(primitive), center.y);
    ///     }
    ///     ControlFlow::Continue(-height)
    /// });
    /// assert_eq!((highest, height), (Some(54), 98.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn visit(
        &self,
        bound: impl FnMut(&Aabb) -> Option<f32>,
        visit: impl FnMut(u32) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        self.tree.visit_primitives(bound, visit)
    }
}
