//! Frustums in scenes of instances: taken into the space of each object, where planes are planes, whatever its transform.

use std::ops::ControlFlow;

use super::place::Placement;
use super::space::Affine;
use super::{Searchable, Tlas};
use crate::query::{PreparedFrustum, Touch};
use crate::simd::{Kernel, Simd, SimdLevel, dispatch_on};
use crate::structures::WideNode;
use crate::structures::wide::search::planes;
use crate::structures::wide::top::TopQuery;
use crate::{Bvh, Frustum, Geometry};

/// A search for what touches a frustum: what [`Searchable`]s hand on to each other.
pub struct FrustumSearch<'a> {
    pub(super) frustum: &'a Frustum,
    /// From the space of the object that is searched into the scene's.
    pub(super) placed: Affine,
    /// The number of the object's first instance.
    pub(super) first: u32,
    pub(super) visit: &'a mut dyn FnMut(u32, u32) -> ControlFlow<()>,
}

impl FrustumSearch<'_> {
    /// Goes through a scene.
    pub(super) fn through_scene<B: Searchable>(&mut self, scene: &Tlas<B>) -> ControlFlow<()> {
        let (placements, tree) = (&scene.built.placements[..], &scene.built.tree);
        match self.frustum.prepare_in(&self.placed.rows, tree.reach()) {
            Some(seen) => {
                tree.search(&mut Instances { placements, level: scene.level, seen, search: self })
            }
            None => ControlFlow::Continue(()),
        }
    }

    /// Goes through a tree.
    pub(super) fn through_tree<G: Geometry>(&mut self, bvh: &Bvh<G>) -> ControlFlow<()> {
        match self.frustum.prepare_in(&self.placed.rows, bvh.tree.reach()) {
            Some(seen) => bvh.touching(seen, |primitive| (self.visit)(self.first, primitive)),
            None => ControlFlow::Continue(()),
        }
    }
}

/// A search through the instances of a scene.
struct Instances<'s, 'a, B> {
    placements: &'s [Placement<B>],
    level: SimdLevel,
    seen: PreparedFrustum,
    search: &'s mut FrustumSearch<'a>,
}

/// Looks at the children of a node.
struct Children<'a> {
    seen: &'a PreparedFrustum,
    node: &'a WideNode,
}

impl Kernel for Children<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u32 {
        self.seen.boxes(simd, planes(self.node))
    }
}

impl<B: Searchable> TopQuery for Instances<'_, '_, B> {
    fn children(&mut self, node: &WideNode) -> (u32, [f32; 16]) {
        (dispatch_on(self.level, Children { seen: &self.seen, node }), [0.0; 16])
    }

    fn limit(&self) -> f32 {
        0.0
    }

    fn entry(&mut self, entry: u32) -> ControlFlow<()> {
        let Self { placements, search, .. } = self;
        let place = &placements[entry as usize];
        // What nobody sees is not there.
        if place.mask == 0 {
            return ControlFlow::Continue(());
        }
        let (placed, first) = (search.placed, search.first);
        search.placed = placed.after(&place.transform);
        search.first = first + place.first;
        let flow = place.object.search_frustum(search);
        (search.placed, search.first) = (placed, first);
        flow
    }
}
