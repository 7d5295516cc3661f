//! Which primitives touch a region of space. Each kind of region is told in a file of its own.

// Regions are sealed: how a search asks them is nobody else's business, although it is part of their trait.
#![allow(private_interfaces, private_bounds)]

mod ball;
mod cuboid;
mod frustum;
mod pairs;
mod triangle;

use std::ops::ControlFlow;

pub use ball::Ball;
pub use frustum::Frustum;
pub(crate) use frustum::Prepared as PreparedFrustum;
pub(crate) use private::Touch;

use crate::geometry::TriangleBlock;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::structures::WideNode;
use crate::structures::wide::parts::Told;
use crate::structures::wide::search::{Leaf, Planes, Query, SearchStack, lanes, planes};
use crate::{Bvh, Geometry, WideBvh, parallel};

/// A region of space that primitives can touch: an [`Aabb`](crate::Aabb), a [`Ball`], a [`Frustum`], or a
/// triangle, `[Vec3; 3]`. What each counts as touching is said with it.
///
/// Regions are solid: what lies inside touches them. A region that is empty, or not made of finite numbers where it says so, is touched by nothing.
pub trait Region: Sync + private::Prepare {}

pub(crate) mod private {
    use super::{Geometry, Planes, Simd, TriangleBlock};

    /// What makes a region ready for a search.
    pub trait Prepare {
        /// The region as the search asks it, in a tree that reaches so far from zero; `None` if nothing touches it.
        #[doc(hidden)]
        fn prepare(&self, reach: f32) -> Option<impl Touch>;
    }

    /// What a search asks of a region.
    pub trait Touch {
        /// The boxes that may touch it, as a set of lanes. Must be `#[inline(always)]`.
        fn boxes<S: Simd>(&self, simd: S, planes: &Planes) -> u32;

        /// Those of the given triangles of a block that touch it. Must be `#[inline(always)]`.
        fn triangles<S: Simd>(&self, simd: S, block: &TriangleBlock, chosen: u32) -> u32;

        /// Whether a primitive that is no triangle touches it.
        fn primitive<G: Geometry>(&self, geometry: &G, primitive: u32) -> bool;
    }
}

impl<G: Geometry> Bvh<G> {
    /// Tells `visit` the number of each primitive that touches a region, once, in no particular order, until it breaks. O(log N) and what it costs to look
    /// at those found and their neighbours. The same on all levels of instructions, but for the order.
    ///
    /// ```
    /// use raywood::{Aabb, Ball, Bvh, TriangleMesh};
    /// use std::ops::ControlFlow;
    ///
    /// let positions = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0]];
    /// let bvh = Bvh::build(TriangleMesh::new(positions, vec![[0, 1, 2], [1, 3, 2]])?)?;
    ///
    /// let mut found = Vec::new();
    /// let _ = bvh.overlapping(&Aabb::new([0.0, 0.0, -1.0], [1.0, 1.0, 1.0]), |primitive| {
    ///     found.push(primitive);
    ///     ControlFlow::Continue(())
    /// });
    /// assert_eq!(found, [0]);
    /// assert!(bvh.overlaps(&Ball::new([2.0, 2.0, 3.0], 3.0)));
    /// assert!(!bvh.overlaps(&Ball::new([2.0, 2.0, 3.0], 2.9)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overlapping<R: Region>(
        &self,
        region: &R,
        visit: impl FnMut(u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        match region.prepare(self.tree.reach()) {
            Some(touch) => self.touching(touch, visit),
            None => ControlFlow::Continue(()),
        }
    }

    /// The same of a region that is ready.
    pub(crate) fn touching(
        &self,
        touch: impl Touch,
        visit: impl FnMut(u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (tree, geometry) = (&self.tree, &self.geometry);
        dispatch_on(tree.level(), Overlapping { tree, geometry, touch, visit })
    }

    /// Whether anything touches a region: [`overlapping`](Self::overlapping) up to the first.
    pub fn overlaps<R: Region>(&self, region: &R) -> bool {
        self.overlapping(region, |_| ControlFlow::Break(())).is_break()
    }

    /// [`overlaps`](Self::overlaps) for many regions, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn overlaps_batch<R: Region>(&self, regions: &[R], answers: &mut [bool]) {
        assert_eq!(regions.len(), answers.len(), "as many answers as regions");
        parallel::fill(regions, answers, |region| self.overlaps(region));
    }
}

/// Finds what touches a region.
struct Overlapping<'a, G, T, F> {
    tree: &'a WideBvh,
    geometry: &'a G,
    touch: T,
    visit: F,
}

impl<G, T, F> Kernel for Overlapping<'_, G, T, F>
where
    G: Geometry,
    T: Touch,
    F: FnMut(u32) -> ControlFlow<()>,
{
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { tree, geometry, touch, visit } = self;
        let mut touching = Touching { geometry, touch, told: tree.told(), visit };
        tree.search(simd, &mut SearchStack::new(tree), &mut touching)
    }
}

/// A search for what touches a region.
struct Touching<'a, G, T, F> {
    geometry: &'a G,
    touch: T,
    told: Told<'a>,
    visit: F,
}

impl<'t, G, T, F> Query<'t> for Touching<'_, G, T, F>
where
    G: Geometry,
    T: Touch,
    F: FnMut(u32) -> ControlFlow<()>,
{
    #[inline(always)]
    fn children<S: Simd>(&mut self, simd: S, node: &WideNode) -> (u32, S::F16) {
        (self.touch.boxes(simd, planes(node)), simd.splat16(0.0))
    }

    fn limit(&self) -> f32 {
        0.0
    }

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, simd: S, leaf: Leaf<'t>) -> ControlFlow<()> {
        if leaf.triangles != 0 {
            for lane in lanes(self.touch.triangles(simd, leaf.block, leaf.triangles)) {
                let primitive = leaf.block.primitives[lane];
                if self.told.is_new(primitive) {
                    (self.visit)(primitive)?;
                }
            }
        }
        for primitive in leaf.others() {
            if self.touch.primitive(self.geometry, primitive) {
                (self.visit)(primitive)?;
            }
        }
        ControlFlow::Continue(())
    }
}
