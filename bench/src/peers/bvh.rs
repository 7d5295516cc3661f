//! `bvh`: a binary tree by SAH with iterators over the shapes whose boxes a ray meets.

use std::cell::Cell;

use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray;
use nalgebra::{Point3, Vector3};
use raywood::{TriangleMesh, Vec3};

use super::each_ray::EachRay;
use super::moeller_trumbore::Corner;
use super::{Built, Mode, Peer, PeerEntry};
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "bvh",
    settings: "Bvh::build_par; `nearest` by nearest_traverse_iterator until boxes begin behind the hit, `clipped` by traverse_iterator with a query that ends at the hit; its own triangle test culls back faces, so ours (Moeller-Trumbore)",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    let mut shapes = shapes(mesh);
    let tree = Bvh::build_par(&mut shapes);
    Ok(Box::new(Tree::new(tree, shapes)?))
}

/// The triangles as it wants them.
pub(super) fn shapes(mesh: &TriangleMesh) -> Vec<Shape> {
    let shape = |number: u32| {
        let corners = mesh.corners(number);
        let mut shape =
            Shape { bounds: Aabb::empty(), triangle: Corner::new(corners), number, node: 0 };
        shape.measure(corners);
        shape
    };
    (0..mesh.triangles().len() as u32).map(shape).collect()
}

/// The size of its iterators' stack.
const DEEPEST: usize = 32;

/// How many interior nodes lie above the deepest leaf.
fn depth(tree: &Bvh<f32, 3>) -> usize {
    let (mut deepest, mut stack) = (0, vec![(0, 0)]);
    while let Some((node, depth)) = stack.pop() {
        match tree.nodes.get(node) {
            Some(&BvhNode::Node { child_l_index, child_r_index, .. }) => {
                stack.extend([(child_l_index, depth + 1), (child_r_index, depth + 1)]);
            }
            _ => deepest = deepest.max(depth),
        }
    }
    deepest
}

/// A tree with the shapes that it was built over, owned or lent.
pub(super) struct Tree<S> {
    tree: Bvh<f32, 3>,
    shapes: S,
}

impl<S: AsRef<[Shape]>> Tree<S> {
    /// # Errors
    ///
    /// The tree is too deep to be traced.
    pub(super) fn new(tree: Bvh<f32, 3>, shapes: S) -> Result<Self, String> {
        let depth = depth(&tree);
        if depth > DEEPEST {
            return Err(format!("its tree is {depth} deep, its iterators panic beyond {DEEPEST}"));
        }
        Ok(Self { tree, shapes })
    }
}

/// A triangle with its box.
pub(super) struct Shape {
    bounds: Aabb<f32, 3>,
    triangle: Corner,
    number: u32,
    node: usize,
}

impl Shape {
    /// Computes the box.
    pub(super) fn measure(&mut self, corners: [Vec3; 3]) {
        let [min, max] = [Vec3::min, Vec3::max].map(|pick| {
            let point = pick(pick(corners[0], corners[1]), corners[2]);
            Point3::from(point.to_array())
        });
        self.bounds = Aabb::with_bounds(min, max);
    }
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.bounds
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// A ray in its format and in ours.
#[derive(Clone, Copy)]
struct Pair {
    theirs: Ray<f32, 3>,
    ours: raywood::Ray,
}

impl Pair {
    fn new(ray: &raywood::Ray) -> Self {
        let direction = Vector3::from(ray.direction.to_array());
        // Not `Ray::new`, which would normalise the direction once more and so trace another ray.
        let theirs = Ray {
            origin: Point3::from(ray.origin.to_array()),
            direction,
            inv_direction: direction.map(|x| 1.0 / x),
        };
        Self { theirs, ours: *ray }
    }

    /// The distance at which it hits the shape, infinite where it does not.
    fn test(&self, shape: &Shape) -> f32 {
        let t = shape.triangle.intersect(self.ours.origin, self.ours.direction);
        if t < self.ours.t_max { t } else { f32::INFINITY }
    }
}

/// A ray that meets only the boxes before the closest hit so far.
struct Clipped<'a> {
    ray: &'a Pair,
    end: Cell<f32>,
}

impl IntersectsAabb<f32, 3> for Clipped<'_> {
    fn intersects_aabb(&self, aabb: &Aabb<f32, 3>) -> bool {
        let entry = self.ray.theirs.intersection_slice_for_aabb(aabb);
        entry.is_some_and(|(entry, _)| entry <= self.end.get())
    }
}

impl<S: AsRef<[Shape]>> Tree<S> {
    fn nearest(&self, ray: &Pair) -> Option<(u32, f32)> {
        let (mut end, mut found) = (ray.ours.t_max, None);
        for shape in self.tree.nearest_traverse_iterator(&ray.theirs, self.shapes.as_ref()) {
            // They come by the distance of their boxes.
            let entry = ray.theirs.intersection_slice_for_aabb(&shape.bounds);
            if entry.is_some_and(|(entry, _)| entry > end) {
                break;
            }
            let t = ray.test(shape);
            if t < end {
                (end, found) = (t, Some((shape.number, t)));
            }
        }
        found
    }

    fn clipped(&self, ray: &Pair) -> Option<(u32, f32)> {
        let query = Clipped { ray, end: Cell::new(ray.ours.t_max) };
        let mut found = None;
        for shape in self.tree.traverse_iterator(&query, self.shapes.as_ref()) {
            let t = ray.test(shape);
            if t < query.end.get() {
                query.end.set(t);
                found = Some((shape.number, t));
            }
        }
        found
    }

    fn any(&self, ray: &Pair) -> bool {
        let query = Clipped { ray, end: Cell::new(ray.ours.t_max) };
        self.tree
            .traverse_iterator(&query, self.shapes.as_ref())
            .any(|shape| ray.test(shape).is_finite())
    }
}

impl<S: AsRef<[Shape]> + Sync> Peer for Tree<S> {
    fn modes(&self) -> Vec<Mode<'_>> {
        vec![
            Mode::new("nearest", false, |set: &RaySet| {
                let closest = |ray: &Pair| self.nearest(ray);
                // Any hit is better asked for without order.
                (!set.kind.any_hit()).then(|| EachRay::new(set, Pair::new, closest).boxed())?
            }),
            Mode::new("clipped", false, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, Pair::new, |ray: &Pair| self.any(ray)).boxed()
                } else {
                    EachRay::new(set, Pair::new, |ray: &Pair| self.clipped(ray)).boxed()
                }
            }),
        ]
    }
}
