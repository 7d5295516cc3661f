//! Walks through scenes of instances for questions of one's own.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::place::Placement;
use super::space::Affine;
use super::{Searchable, Tlas};
use crate::structures::WideNode;
use crate::structures::wide::top::TopQuery;
use crate::{Aabb, Bvh, Geometry};

impl<B: Searchable> Tlas<B> {
    /// Walks through the trees of all levels, the most promising boxes first, as [`Bvh::visit`] does through one: for questions that the library does not know.
    ///
    /// `bound` is asked for a lower bound, of whatever is to be small, over all that lies in a box, which is upright in the scene's space and holds what stands there; `None` leaves the box out. `visit` is given
    /// the numbers of the instance and of each primitive in the boxes that remain, once, and returns the limit from there on: boxes of larger bounds are left out. With a break the walk ends. Boxes inside the same box
    /// are entered in the order of their bounds, and the tree of an instance is walked through before the next instance. With a bound that is NaN the box is entered. Instances that no
    /// [mask](crate::Instance::mask) sees are not there.
    ///
    /// Boxes of turned instances are larger than what they are around, so bounds may fall a little on the way down, but are true of all levels. O(nodes visited), by plain code: the queries that the library knows are faster.
    ///
    /// ```
    /// use raywood::{Aabb, Bvh, Instance, Spheres, Tlas, Transform};
    /// use std::ops::ControlFlow;
    /// use std::sync::Arc;
    ///
    /// // The highest instance of a ball, in the part of space where x is positive.
    /// let ball = Arc::new(Bvh::build(Spheres::new(vec![([0.0; 3].into(), 0.5)])?)?);
    /// let at = |i: u16| Transform::translation([f32::from(i) - 50.0, f32::from(i * 37 % 100), 0.0]);
    /// let scene = Tlas::build((0..100).map(|i| Instance::new(Arc::clone(&ball), at(i))).collect())?;
    /// let (mut highest, mut height) = (None, f32::NEG_INFINITY);
    /// let bound = |bounds: &Aabb| (bounds.max.x > 0.0).then_some(-bounds.max.y);
    /// let _ = scene.visit(bound, |instance, _| {
    ///     let [x, y, _] = scene.instances()[instance as usize].transform.point([0.0; 3]).to_array();
    ///     if x > 0.0 && y > height {
    ///         (highest, height) = (Some(instance), y);
    ///     }
    ///     ControlFlow::Continue(-height)
    /// });
    /// assert_eq!((highest, height), (Some(54), 98.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn visit(
        &self,
        mut bound: impl FnMut(&Aabb) -> Option<f32>,
        mut visit: impl FnMut(u32, u32) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        self.walk_boxes(&mut WalkSearch {
            bound: &mut bound,
            visit: &mut visit,
            limit: f32::INFINITY,
            placed: Affine::IDENTITY,
            first: 0,
        })
    }
}

/// A walk for a question of one's own: what [`Searchable`]s hand on to each other.
pub struct WalkSearch<'a> {
    bound: &'a mut dyn FnMut(&Aabb) -> Option<f32>,
    visit: &'a mut dyn FnMut(u32, u32) -> ControlFlow<(), f32>,
    limit: f32,
    /// From the space of the object that is walked through into the scene's.
    placed: Affine,
    /// The number of the object's first instance.
    first: u32,
}

impl WalkSearch<'_> {
    /// Goes through a scene.
    pub(super) fn through_scene<B: Searchable>(&mut self, scene: &Tlas<B>) -> ControlFlow<()> {
        let placements = &scene.built.placements[..];
        scene.built.tree.search(&mut Instances { placements, walk: self })
    }

    /// Goes through a tree.
    pub(super) fn through_tree<G: Geometry>(&mut self, bvh: &Bvh<G>) -> ControlFlow<()> {
        let Self { bound, visit, limit, placed, first } = self;
        let left = Cell::new(*limit);
        let bound = |bounds: &Aabb| {
            let key = bound(&placed.bounds(bounds, 0.0, 0.0))?;
            let is_beyond = key > left.get();
            (!is_beyond).then_some(key)
        };
        let flow = bvh.tree.visit_primitives(bound, |primitive| {
            left.set(visit(*first, primitive)?);
            ControlFlow::Continue(left.get())
        });
        *limit = left.get();
        flow
    }
}

/// A walk through the instances of a scene.
struct Instances<'s, 'a, B> {
    placements: &'s [Placement<B>],
    walk: &'s mut WalkSearch<'a>,
}

impl<B: Searchable> TopQuery for Instances<'_, '_, B> {
    fn children(&mut self, node: &WideNode) -> (u32, [f32; 16]) {
        let WalkSearch { bound, limit, placed, .. } = &mut *self.walk;
        let (mut chosen, mut keys) = (0, [0.0; 16]);
        for (lane, bounds) in node.boxes() {
            match bound(&placed.bounds(&bounds, 0.0, 0.0)) {
                Some(key) if key > *limit => {}
                Some(key) => {
                    chosen |= 1 << lane;
                    keys[lane] = key;
                }
                None => {}
            }
        }
        (chosen, keys)
    }

    fn limit(&self) -> f32 {
        self.walk.limit
    }

    fn entry(&mut self, entry: u32) -> ControlFlow<()> {
        let Self { placements, walk } = self;
        let place = &placements[entry as usize];
        // What nobody sees is not there.
        if place.mask == 0 {
            return ControlFlow::Continue(());
        }
        let (placed, first) = (walk.placed, walk.first);
        walk.placed = placed.after(&place.transform);
        walk.first = first + place.first;
        let flow = place.object.walk_boxes(walk);
        (walk.placed, walk.first) = (placed, first);
        flow
    }
}
