//! What is inside of a scene of instances: inside of any of them.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::place::Placement;
use super::{Searchable, Tlas};
use crate::double::{Double3, double};
use crate::geometry::round_down;
use crate::simd::{Kernel, Simd, SimdLevel, dispatch_on};
use crate::structures::WideNode;
use crate::structures::wide::search::{boxes_touching, planes};
use crate::structures::wide::top::TopQuery;
use crate::structures::wide::winding::Winding;
use crate::{Aabb, Bvh, Geometry, Vec3, WideBvh, parallel};

/// A scene of instances as the surfaces of solids: made by [`Tlas::solid`].
///
/// Inside is what is inside of any instance: of the object's box, and of its surface, by the winding number that [`Solid`](crate::Solid) tells of, in the object's space. So mirrored instances have their
/// insides where the object has its own, instances may overlap, and a floor between solids has no inside.
#[derive(Clone, Debug)]
pub struct SceneSolid<'a, B> {
    scene: &'a Tlas<B>,
    enclosure: Enclosure,
}

impl<B: Searchable> Tlas<B> {
    /// The scene as the surfaces of solids, for questions about its inside. O(N) in all primitives of all objects, each counted once however often it stands there, and about as much memory as the nodes of their
    /// trees. Instances that no [mask](crate::Instance::mask) sees are not there.
    ///
    /// ```
    /// use raywood::{Bvh, Instance, Tlas, Transform, TriangleMesh};
    /// use std::sync::Arc;
    ///
    /// // A tetrahedron, its normals outwards; and another one that is mirrored and four times as high.
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    /// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    /// let leaf = Arc::new(Bvh::build(mesh)?);
    /// let high = Transform::scaling([-1.0, 1.0, 4.0]);
    /// let scene = Tlas::build(vec![Instance::new(Arc::clone(&leaf), Transform::IDENTITY), Instance::new(leaf, high)])?;
    ///
    /// let solid = scene.solid();
    /// assert!(solid.contains([-0.5, 0.5, 9.0]) && !solid.contains([0.5, 0.5, 9.0]));
    /// assert_eq!(solid.signed_distance([-0.25, 1.0, 4.0]), Some(-0.25));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solid(&self) -> SceneSolid<'_, B> {
        SceneSolid { scene: self, enclosure: Enclosure::of_scene(self) }
    }
}

impl<B: Searchable> SceneSolid<'_, B> {
    /// Whether a point is inside of any instance. On a surface itself it may be told either way. Not if it is not finite.
    ///
    /// The point is taken into the space of each instance whose box holds it, in double precision, and there told as right as by [`Solid::contains`](crate::Solid::contains).
    pub fn contains(&self, point: impl Into<[f32; 3]>) -> bool {
        self.holds(Vec3::from(point.into()), &mut Vec::new())
    }

    /// [`contains`](Self::contains) for many points, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn contains_batch(&self, points: &[Vec3], answers: &mut [bool]) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            let mut stack = Vec::new();
            for (&point, answer) in points.iter().zip(answers) {
                *answer = self.holds(point, &mut stack);
            }
        });
    }

    /// The distance from the closest surface of any instance, whether that lies within others or not, negative inside. `None` if there is no surface or the point is not finite. It costs what
    /// [`closest_point`](Tlas::closest_point) and [`contains`](Self::contains) cost, and is as right: of primitives that are no triangles distances are told of instances that only turn, mirror, move and
    /// scale by the same in all directions, while it is known of all of them what is inside.
    pub fn signed_distance(&self, point: impl Into<[f32; 3]>) -> Option<f32> {
        self.signed(Vec3::from(point.into()), &mut Vec::new())
    }

    /// [`signed_distance`](Self::signed_distance) for many points, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn signed_distance_batch(&self, points: &[Vec3], answers: &mut [Option<f32>]) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            let mut stack = Vec::new();
            for (&point, answer) in points.iter().zip(answers) {
                *answer = self.signed(point, &mut stack);
            }
        });
    }

    fn holds(&self, point: Vec3, stack: &mut Vec<u32>) -> bool {
        let mut search = InsideSearch { point: double(point), stack };
        point.is_finite() && self.enclosure.holds_in_scene(self.scene, &mut search)
    }

    fn signed(&self, point: Vec3, stack: &mut Vec<u32>) -> Option<f32> {
        let closest = self.scene.closest_point(point, f32::INFINITY)?;
        let side = if self.holds(point, stack) { -1.0 } else { 1.0 };
        Some(side * closest.distance)
    }
}

/// What is known of an object's inside: what [`Searchable`]s sum up for [`Tlas::solid`].
#[derive(Clone, Debug)]
pub struct Enclosure(Kind);

#[derive(Clone, Debug)]
enum Kind {
    /// That of a tree.
    Tree(Winding),
    /// Those of the different objects of a scene, and which of them each instance is.
    Scene { objects: Vec<Enclosure>, of: Vec<u32> },
}

/// A point that may be inside: what [`Searchable`]s hand on to each other.
#[derive(Debug)]
pub struct InsideSearch<'a> {
    /// In the space of the object that is asked.
    point: Double3,
    /// Memory for walks through trees.
    stack: &'a mut Vec<u32>,
}

impl Enclosure {
    /// That of a tree.
    pub(super) fn of_tree<G: Geometry>(bvh: &Bvh<G>) -> Self {
        Self(Kind::Tree(Winding::new(&bvh.tree, &bvh.geometry)))
    }

    /// That of a scene, which sums up each object once.
    pub(super) fn of_scene<B: Searchable>(scene: &Tlas<B>) -> Self {
        let (mut numbers, mut different) = (HashMap::new(), Vec::new());
        let mut of = Vec::with_capacity(scene.built.placements.len());
        for place in &scene.built.placements {
            // What nobody sees is not asked.
            let number = match place.mask {
                0 => u32::MAX,
                _ => *numbers.entry(Arc::as_ptr(&place.object)).or_insert_with(|| {
                    different.push(&place.object);
                    different.len() as u32 - 1
                }),
            };
            of.push(number);
        }
        let objects = parallel::map(different.len(), |number| different[number].enclosure());
        Self(Kind::Scene { objects, of })
    }

    /// Whether a tree, which this is of, holds a point.
    pub(super) fn holds_in_tree<G: Geometry>(
        &self,
        bvh: &Bvh<G>,
        search: &mut InsideSearch<'_>,
    ) -> bool {
        let Kind::Tree(winding) = &self.0 else { return false };
        let (tree, geometry, point) = (&bvh.tree, &bvh.geometry, search.point);
        let Aabb { min, max } = tree.bounds();
        let is_within = |i: usize| f64::from(min[i]) <= point[i] && point[i] <= f64::from(max[i]);
        (0..3).all(is_within)
            && dispatch_on(tree.level(), IsAround { tree, geometry, winding, search })
    }

    /// Whether any instance of a scene, which this is of, holds a point.
    pub(super) fn holds_in_scene<B: Searchable>(
        &self,
        scene: &Tlas<B>,
        search: &mut InsideSearch<'_>,
    ) -> bool {
        let Kind::Scene { objects, of } = &self.0 else { return false };
        let point = search.point;
        // A box of single precision that holds the point holds this one's corner, too.
        let around = Aabb {
            min: Vec3::from(point.map(round_down)),
            max: Vec3::from(point.map(|x| -round_down(-x))),
        };
        let placements = &scene.built.placements[..];
        let mut asked =
            AskInstances { placements, objects, of, level: scene.level, around, search };
        scene.built.tree.search(&mut asked).is_break()
    }
}

/// Finds whether a tree's surface goes around a point.
struct IsAround<'s, 'a, G> {
    tree: &'s WideBvh,
    geometry: &'s G,
    winding: &'s Winding,
    search: &'s mut InsideSearch<'a>,
}

impl<G: Geometry> Kernel for IsAround<'_, '_, G> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, _simd: S) -> bool {
        let Self { tree, geometry, winding, search } = self;
        winding.around(tree, geometry, search.point, search.stack) as f32 >= 0.5
    }
}

/// Asks the instances in whose boxes a point lies, until one of them holds it.
struct AskInstances<'s, 'a, B> {
    placements: &'s [Placement<B>],
    objects: &'s [Enclosure],
    of: &'s [u32],
    level: SimdLevel,
    around: Aabb,
    search: &'s mut InsideSearch<'a>,
}

/// Looks at the children of a node.
struct Children<'a> {
    node: &'a WideNode,
    around: &'a Aabb,
}

impl Kernel for Children<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u32 {
        boxes_touching(simd, planes(self.node), self.around)
    }
}

impl<B: Searchable> TopQuery for AskInstances<'_, '_, B> {
    fn children(&mut self, node: &WideNode) -> (u32, [f32; 16]) {
        let children = Children { node, around: &self.around };
        (dispatch_on(self.level, children), [0.0; 16])
    }

    fn limit(&self) -> f32 {
        0.0
    }

    fn entry(&mut self, entry: u32) -> ControlFlow<()> {
        let place = &self.placements[entry as usize];
        let number = self.of.get(entry as usize).map_or(u32::MAX, |&number| number);
        let Some(enclosure) = self.objects.get(number as usize) else {
            return ControlFlow::Continue(());
        };
        let point = place.inverse.point(self.search.point);
        let mut search = InsideSearch { point, stack: self.search.stack };
        match place.object.encloses(enclosure, &mut search) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
