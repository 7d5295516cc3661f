//! Which primitives of a scene of instances touch those of another geometry.

use std::ops::ControlFlow;

use super::overlap::Touches;
use super::place::Placement;
use super::space::Affine;
use super::{Searchable, Tlas};
use crate::double::{double, single};
use crate::geometry::{TOUCH_SLACK, triangle_overlaps, triangles_touch_in_double};
use crate::simd::dispatch_on;
use crate::structures::WideNode;
use crate::structures::wide::pairs::{Pairs, placed_boxes_touching};
use crate::structures::wide::top::TopQuery;
use crate::{Aabb, Bvh, Geometry, Vec3, WideBvh};

impl<B: Searchable> Tlas<B> {
    /// Tells `visit` all pairs of a primitive of this scene, by the numbers of its instance and its own, and one of another geometry that touch, each once, in no particular order, until it breaks. The other one
    /// lies in the scene's space as it is. Instances that no [mask](crate::Instance::mask) sees are not there.
    ///
    /// Triangles touch where they stand, as [`Bvh::overlapping_pairs`] says; their corners are computed in double precision. Of other primitives it is told whether they may, as far as boxes where they stand and
    /// [`Geometry::overlaps`] tell. In about the time of the pairs whose boxes touch, and what it costs to look for the instances whose boxes touch that around the other geometry.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, Tlas, Transform, TriangleMesh};
    /// use std::ops::ControlFlow;
    /// use std::sync::Arc;
    ///
    /// let flat = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]])?;
    /// let upright = TriangleMesh::new(vec![[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [3.0, 3.0, 0.0]], vec![[0, 1, 2]])?;
    /// let (flat, upright) = (Arc::new(Bvh::build(flat)?), Bvh::build(upright)?);
    /// let at = |z: f32| Instance::new(Arc::clone(&flat), Transform::translation([0.0, 0.0, z]));
    /// let scene = Tlas::build(vec![at(2.0), at(0.5)])?;
    ///
    /// let mut found = Vec::new();
    /// let _ = scene.overlapping_pairs(&upright, |instance, primitive, other| {
    ///     found.push((instance, primitive, other));
    ///     ControlFlow::Continue(())
    /// });
    /// assert_eq!(found, [(1, 0, 0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn overlapping_pairs<H: Geometry>(
        &self,
        other: &Bvh<H>,
        mut visit: impl FnMut(u32, u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (tree, geometry) = (&other.tree, &other.geometry);
        let (placed, first) = (Affine::IDENTITY, 0);
        self.search_pairs(&mut PairSearch { tree, geometry, placed, first, visit: &mut visit })
    }

    /// Whether anything of this scene touches anything of another geometry: [`overlapping_pairs`](Self::overlapping_pairs) up to the first.
    pub fn overlaps_any_of<H: Geometry>(&self, other: &Bvh<H>) -> bool {
        self.overlapping_pairs(other, |_, _, _| ControlFlow::Break(())).is_break()
    }
}

/// A search for what touches another geometry: what [`Searchable`]s hand on to each other.
pub struct PairSearch<'a> {
    /// The other geometry.
    tree: &'a WideBvh,
    geometry: &'a dyn Geometry,
    /// From the space of the object that is searched into the scene's.
    placed: Affine,
    /// The number of the object's first instance.
    first: u32,
    visit: &'a mut dyn FnMut(u32, u32, u32) -> ControlFlow<()>,
}

impl PairSearch<'_> {
    /// Takes boxes of the object that is searched into the scene's space, larger by what counts as touching.
    fn place(&self) -> impl Fn(&Aabb) -> Aabb + use<> {
        let (placed, reach) = (self.placed, f64::from(self.tree.reach()));
        move |bounds| placed.bounds(bounds, 4.0 * TOUCH_SLACK, reach)
    }

    /// Goes through a scene.
    pub(super) fn through_scene<B: Searchable>(&mut self, scene: &Tlas<B>) -> ControlFlow<()> {
        let (placements, place) = (&scene.built.placements[..], self.place());
        scene.built.tree.search(&mut Instances { placements, place, search: self })
    }

    /// Goes through a tree.
    pub(super) fn through_tree<G: Geometry>(&mut self, bvh: &Bvh<G>) -> ControlFlow<()> {
        let place = self.place();
        let Self { tree, geometry: others, placed, first, visit } = self;
        let visit = |other: u32, own: u32| {
            let touch = match (bvh.geometry.triangle(own), others.triangle(other)) {
                (Some(corners), Some(others)) => {
                    let corners = corners.map(|corner| placed.point(double(corner)));
                    triangles_touch_in_double(others.map(double), corners)
                }
                (Some(corners), None) => {
                    let corners = corners.map(|corner| single(placed.point(double(corner))));
                    triangle_touches(corners, *others, other)
                }
                (None, Some(others)) => others.other(&bvh.geometry, own, placed),
                (None, None) => {
                    let bounds = placed.bounds(&bvh.geometry.bounds(own), 0.0, 0.0);
                    !bounds.intersection(&others.bounds(other)).is_empty()
                }
            };
            if touch { visit(*first, own, other) } else { ControlFlow::Continue(()) }
        };
        dispatch_on(tree.level(), Pairs { first: tree, second: &bvh.tree, place, visit })
    }
}

/// Whether a triangle whose corners were rounded may touch a primitive that is none.
fn triangle_touches(corners: [Vec3; 3], geometry: &dyn Geometry, primitive: u32) -> bool {
    let (around, bounds) = (Aabb::of_points(corners), geometry.bounds(primitive));
    let largest = around.min.abs().max(around.max.abs()).max_element();
    let rounding = Vec3::splat(f32::EPSILON * largest);
    let wider = |bounds: &Aabb| Aabb { min: bounds.min - rounding, max: bounds.max + rounding };
    triangle_overlaps(corners, &wider(&bounds)) && geometry.overlaps(primitive, &wider(&around))
}

/// A search through the instances of a scene.
struct Instances<'s, 'a, B, P> {
    placements: &'s [Placement<B>],
    place: P,
    search: &'s mut PairSearch<'a>,
}

impl<B: Searchable, P: Fn(&Aabb) -> Aabb> TopQuery for Instances<'_, '_, B, P> {
    fn children(&mut self, node: &WideNode) -> (u32, [f32; 16]) {
        let bounds = self.search.tree.bounds();
        (placed_boxes_touching(node, &self.place, &bounds), [0.0; 16])
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
        let flow = place.object.search_pairs(search);
        (search.placed, search.first) = (placed, first);
        flow
    }
}
