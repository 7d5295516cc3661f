//! A sphere that moves through the wide tree.

use std::ops::ControlFlow;

use super::node::WideNode;
use super::search::{Leaf, Query, lanes};
use super::slabs::Slabs;
use crate::PreparedRay;
use crate::simd::Simd;

/// A search for what a moving sphere, or an ellipsoid, touches first. Boxes are larger by its radius along each axis, and it is a point.
pub(crate) struct Sweep<F> {
    slabs: Slabs,
    limit: f32,
    test: F,
}

impl<F> Sweep<F> {
    /// That of one whose centre moves along a ray. `test` is told of a leaf and a lane that may be touched, and returns how far to look from then on.
    pub(crate) fn new<'t>(ray: &PreparedRay, radii: [f32; 3], reach: f32, test: F) -> Self
    where
        F: FnMut(&Leaf<'t>, usize) -> f32,
    {
        let largest = radii[0].max(radii[1]).max(radii[2]);
        let slabs = Slabs::new(ray, reach + largest).around_each(radii);
        Self { slabs, limit: ray.t_max, test }
    }
}

impl<'t, F: FnMut(&Leaf<'t>, usize) -> f32> Query<'t> for Sweep<F> {
    #[inline(always)]
    fn children<S: Simd>(&mut self, simd: S, node: &WideNode) -> (u32, S::F16) {
        self.slabs.children_met(simd, node, self.limit)
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, simd: S, leaf: Leaf<'t>) -> ControlFlow<()> {
        let met = self.slabs.triangles_met(simd, leaf.block, self.limit);
        for lane in lanes(leaf.triangles & met | leaf.others) {
            self.limit = (self.test)(&leaf, lane);
        }
        ControlFlow::Continue(())
    }
}
