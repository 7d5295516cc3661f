//! Every hit of one ray of double precision with the wide tree: what vectors cannot exclude is asked one by one.

use std::ops::ControlFlow;

use super::double::DoubleScene;
use super::node::Reference;
use super::single::SmallStack;
use super::step::lanes;
use super::{HitVisitor, WideBvh};
use crate::doubles::PreparedRay64;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::{Hit64, PreparedRay, Ray64};

/// Tells a visitor of hits within the ray's interval and up to the visitor's limit, in any order. With `ONCE` each crossing of a surface is hit once; else a ray through an edge hits all
/// triangles there, as it does for closest hits. The ray is valid.
struct HitsInDouble<'a, V, const ONCE: bool> {
    tree: &'a WideBvh,
    scene: DoubleScene<'a>,
    ray: &'a Ray64,
    visitor: &'a mut V,
}

impl<V: HitVisitor<Hit64>, const ONCE: bool> Kernel for HitsInDouble<'_, V, ONCE> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { tree, scene, ray, visitor } = self;
        let local = scene.frame.ray(ray);
        let single = PreparedRay::of_valid(simd, &local.ray);
        let exact = PreparedRay64::new(ray, scene.level);
        let slabs = tree.slabs(&single).around(local.displacement);
        let mut told = tree.told();
        let mut stack = SmallStack::new(tree);
        let (keys, items) = stack.parts();
        let (mut top, mut current) = (1, tree.root);
        loop {
            if current == Reference::NOTHING {
                return ControlFlow::Continue(());
            }
            let limit = local.limit(visitor.limit());
            if current.is_leaf() {
                let block = tree.block(current);
                let all = current.lanes();
                let found = block.candidates(simd, &single, local.displacement, all, limit);
                for lane in lanes(found.lanes) {
                    let primitive = block.primitives[lane];
                    let corners = scene.mesh.corners(primitive);
                    let t = match ONCE {
                        true => exact.crossing_distance(corners, visitor.limit()),
                        false => exact.hit_distance(corners, visitor.limit()),
                    };
                    // A triangle that was cut into parts lies in several leaves.
                    if let Some(t) = t
                        && told.is_new(primitive)
                    {
                        visitor.visit(exact.hit_at(t, primitive, corners))?;
                    }
                }
            } else {
                let node = tree.node(current);
                let (met, near) = slabs.children_met(simd, node, limit);
                // In order even where the limit stays as it is: that takes little beside what double precision is asked.
                top += simd.push_sorted(met, near, &node.children, (keys, items), top).0;
            }

            // On to the next that begins before the limit.
            let end = slabs.end_of_keys(local.limit(visitor.limit()));
            current = loop {
                top -= 1;
                if keys[top] <= end {
                    break Reference(items[top]);
                }
            };
        }
    }
}

impl WideBvh {
    /// Tells a visitor of every crossing of a ray of double precision with a surface within its interval and up to the visitor's limit, each once, in any order.
    pub(crate) fn visit_crossings_in_double<V: HitVisitor<Hit64>>(
        &self,
        scene: DoubleScene<'_>,
        ray: &Ray64,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        self.visit_in_double::<_, true>(scene, ray, visitor)
    }

    /// Tells a visitor of every triangle that counts for closest hits, within the ray's interval and up to the visitor's limit, in any order.
    pub(crate) fn visit_hits_in_double<V: HitVisitor<Hit64>>(
        &self,
        scene: DoubleScene<'_>,
        ray: &Ray64,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        self.visit_in_double::<_, false>(scene, ray, visitor)
    }

    fn visit_in_double<V: HitVisitor<Hit64>, const ONCE: bool>(
        &self,
        scene: DoubleScene<'_>,
        ray: &Ray64,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        if !ray.is_valid() {
            return ControlFlow::Continue(());
        }
        dispatch_on(self.level, HitsInDouble::<_, ONCE> { tree: self, scene, ray, visitor })
    }
}
