//! The wide tree: sixteen children a node and eight triangles a leaf, so that one vector instruction tests them all.

mod balls;
mod batch;
mod build;
mod check;
mod chosen;
mod collapse;
mod cost;
mod crossings;
mod crown;
mod division;
mod double;
mod double_hits;
mod entries;
mod flight;
mod gathered;
mod graft;
pub(crate) mod linear;
mod measure;
mod node;
mod node_steps;
mod packet;
pub(crate) mod pairs;
pub(crate) mod parts;
mod pruned;
mod ray_search;
mod refit;
mod repair;
mod saved;
pub(crate) mod search;
mod sharing;
mod single;
mod sink;
mod slabs;
mod sound;
mod source;
mod step;
pub(crate) mod sweep;
#[cfg(test)]
mod tests;
pub(crate) mod top;
pub(crate) mod top_many;
pub(crate) mod winding;

use std::ops::ControlFlow;

use super::AccelerationStructure;
use crate::build::{Work, watched};
use crate::geometry::TriangleBlock;
use crate::simd::{Arena, SimdLevel, dispatch_on};
use crate::{
    Aabb, BuildError, BuildOptions, Geometry, Hit, NodeView, PreparedRay, Probe, Ray, TriangleTest,
    ValidationError,
};
use crate::{HitColumnsMut, Vec3};
pub(crate) use build::binary_options;
pub(crate) use chosen::Chooser;
pub(crate) use cost::Cost;
pub(crate) use crossings::HitVisitor;
pub(crate) use double::DoubleScene;
pub(crate) use measure::Measured;
use node::Reference;
pub(crate) use node::WideNode;
use parts::{Parts, Told};
pub(crate) use saved::SavedWide;
use slabs::Slabs;
pub(crate) use sound::Unsound;
use source::{FromPoint, Towards};

/// A bounding volume hierarchy of sixteen children a node, over triangles in blocks of eight, traced by vector instructions: see
/// [`SimdLevel`].
///
/// It is made from a [binary tree](BuildOptions::wide_builder), by default one whose neighbours were merged from the bottom up, if asked for improved by [reinsertion](BuildOptions::reinsertion_passes), by the collapse that the heuristic finds best (Ylitie, Karras and Laine, "Efficient
/// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017). Batches are traced many rays at a time.
/// Primitives that are no [triangles](Geometry::triangle) are tested one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct WideBvh {
    bounds: Aabb,
    primitives: u32,
    triangle_test: TriangleTest,
    /// How far the boxes reach from zero along any axis.
    reach: f32,
    /// The primitives that lie in several leaves.
    parts: Parts,
    /// How many nodes lie on the longest way from the root to a leaf.
    depth: usize,
    /// The node or leaf that holds everything; [`Reference::NOTHING`] if there is nothing.
    root: Reference,
    /// Nodes and blocks of leaves, depth first, the children of a node side by side.
    arena: Arena,
    /// The instructions that trace it.
    level: SimdLevel,
}

impl WideBvh {
    /// Builds the tree. The same for any number of threads and any level of instructions.
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Self, BuildError> {
        build::build(geometry, options, Work::UNWATCHED)
    }

    /// As [`build`](Self::build), watched: see [`Bvh::build_watched`](crate::Bvh::build_watched).
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build), and [`BuildError::Cancelled`].
    pub fn build_watched<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        watcher: impl FnMut(f64) -> ControlFlow<()> + Send,
    ) -> Result<Self, BuildError> {
        watched(watcher, |work| build::build(geometry, options, work))
    }

    /// Builds the tree as a part of some work.
    pub(crate) fn build_in<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        build::build(geometry, options, work)
    }

    /// The box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Remembers which primitives have been told of, for those who tell of each.
    pub(crate) fn told(&self) -> Told<'_> {
        Told::nothing(&self.parts)
    }

    /// A ray as the boxes of this tree are tested against it.
    #[inline(always)]
    fn slabs(&self, ray: &PreparedRay) -> Slabs {
        let slabs = Slabs::new(ray, self.reach);
        match self.parts.exist() {
            true => slabs.among_parts(self.parts.margin(ray.origin)),
            false => slabs,
        }
    }

    /// The vector instructions that trace it.
    pub(crate) fn level(&self) -> SimdLevel {
        self.level
    }

    /// The node that a reference to a node means.
    #[inline(always)]
    fn node(&self, reference: Reference) -> &WideNode {
        self.arena.get(reference.line())
    }

    /// The block in which the leaf lies that a reference means.
    #[inline(always)]
    fn block(&self, reference: Reference) -> &TriangleBlock {
        self.arena.get(reference.line())
    }

    /// The primitives of a leaf, and in which lanes of its block they are.
    fn primitives_of(&self, leaf: Reference) -> impl Iterator<Item = (usize, u32)> {
        let block = self.block(leaf);
        step::lanes(leaf.lanes()).map(|lane| (lane, block.primitives[lane]))
    }

    /// Where a node or leaf lies in memory, to be fetched. Of nothing it means nothing.
    #[inline(always)]
    fn address(&self, reference: Reference) -> *const u8 {
        self.arena.address(reference.line())
    }

    /// Tells a visitor of every hit of a ray, each crossing of a closed surface once, in any order; until it has enough. Always by the watertight test.
    pub(crate) fn visit_crossings<V: HitVisitor>(
        &self,
        geometry: &dyn Geometry,
        ray: &PreparedRay,
        visitor: &mut V,
    ) -> ControlFlow<()> {
        dispatch_on(self.level, crossings::Crossings { tree: self, geometry, ray, visitor })
    }

    /// The closest of the hits that count, unless it lies beyond the limit: then it may be found or not. With `ANY`, any of them.
    pub(crate) fn choose_hit<C: Chooser, const ANY: bool>(
        &self,
        geometry: &dyn Geometry,
        ray: &PreparedRay,
        limit: f32,
        chooser: &mut C,
    ) -> Option<Hit> {
        match self.triangle_test {
            TriangleTest::Watertight => dispatch_on(
                self.level,
                chosen::Chosen::<_, ANY, false> { tree: self, geometry, ray, limit, chooser },
            ),
            TriangleTest::Fast => dispatch_on(
                self.level,
                chosen::Chosen::<_, ANY, true> { tree: self, geometry, ray, limit, chooser },
            ),
        }
    }

    /// How many items the stack of a traversal has room for: of each node on the way all children but one stay behind, below them lies the mark of
    /// the end, and sixteen are stored before it is known how many count. A multiple of sixteen.
    fn stack_size(&self) -> usize {
        (self.depth + 2) * node::WIDTH
    }
}

impl AccelerationStructure for WideBvh {
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        match P::IS_BLIND {
            true => self.closest_hit(geometry, ray),
            false => self.probed_closest_hit(geometry, ray, probe),
        }
    }

    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        match P::IS_BLIND {
            true => self.any_hit(geometry, ray),
            false => self.probed_any_hit(geometry, ray, probe),
        }
    }

    fn intersect_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.closest_hits(geometry, rays, hits);
    }

    fn occluded_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], occluded: &mut [bool]) {
        self.any_hits(geometry, rays, occluded);
    }

    fn intersect_from<G: Geometry>(
        &self,
        geometry: &G,
        origin: Vec3,
        directions: &[Vec3],
        hits: HitColumnsMut<'_>,
    ) {
        self.closest_hits_from(geometry, FromPoint { origin, directions }, hits);
    }

    fn occluded_towards<G: Geometry>(
        &self,
        geometry: &G,
        (target, end): (Vec3, f32),
        (points, beside): (&[Vec3], &[u32]),
        occluded: &mut [bool],
    ) {
        self.any_hits_towards(geometry, Towards { target, points, beside, end }, occluded);
    }

    fn simd_level(&self) -> Option<SimdLevel> {
        Some(self.level)
    }

    fn set_simd_level(&mut self, level: SimdLevel) {
        self.level = if level.is_available() { level } else { SimdLevel::Portable };
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        let mut pending = vec![(self.root, self.bounds, 0)];
        while let Some((reference, bounds, level)) = pending.pop() {
            if reference == Reference::NOTHING {
                continue;
            }
            let references = reference.is_leaf().then(|| reference.count());
            visit(NodeView { bounds, level, references });
            if !reference.is_leaf() {
                let node = self.node(reference);
                pending.extend(node.children().map(|(bounds, child)| (child, bounds, level + 1)));
            }
        }
    }

    fn bytes(&self) -> usize {
        64 * self.arena.len() + self.parts.bytes()
    }

    fn primitives(&self) -> usize {
        self.primitives as usize
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        check::check(self, geometry)
    }
}
