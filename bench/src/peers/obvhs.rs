//! `obvhs`: a binary tree by PLOC with reinsertion and pre-splits, and an eight-wide compressed one made from it.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use raywood::TriangleMesh;

use super::each_ray::EachRay;
use super::{Built, Mode, Peer, PeerEntry};
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "obvhs",
    settings: "preset very_slow_build; RtTriangle in the order of the leaves",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    let triangles = triangles(mesh);
    let params = BvhBuildParams::very_slow_build();
    let bvh2 = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
    let cwbvh = build_cwbvh_from_tris(&triangles, params, &mut Duration::default());
    Ok(Box::new(Obvhs {
        cwbvh: Ordered::new(cwbvh, &triangles),
        bvh2: Ordered::new(bvh2, &triangles),
    }))
}

/// The mesh in its own format.
pub(super) fn triangles(mesh: &TriangleMesh) -> Vec<Triangle> {
    let corner = |point: raywood::Vec3| Vec3A::from_array(point.to_array());
    let triangle = |number| {
        let [v0, v1, v2] = mesh.corners(number).map(corner);
        Triangle { v0, v1, v2 }
    };
    (0..mesh.triangles().len() as u32).map(triangle).collect()
}

struct Obvhs {
    cwbvh: Ordered<CwBvh>,
    bvh2: Ordered<Bvh2>,
}

impl Peer for Obvhs {
    fn modes(&self) -> Vec<Mode<'_>> {
        vec![self.cwbvh.mode("cwbvh"), self.bvh2.mode("bvh2")]
    }
}

/// A tree with triangles in the order of its leaves.
pub(super) struct Ordered<T> {
    tree: T,
    triangles: Vec<RtTriangle>,
}

impl<T: Tree> Ordered<T> {
    pub(super) fn new(tree: T, triangles: &[Triangle]) -> Self {
        let in_order = |&i: &u32| RtTriangle::from(&triangles[i as usize]);
        Self { triangles: tree.order().iter().map(in_order).collect(), tree }
    }

    pub(super) fn mode(&self, name: &'static str) -> Mode<'_> {
        Mode::new(name, false, move |set: &RaySet| {
            let test = move |ray: &Ray, place: usize| self.triangles[place].intersect(ray);
            if set.kind.any_hit() {
                let occluded = move |&ray: &Ray| !self.tree.misses(ray, test);
                EachRay::new(set, convert, occluded).boxed()
            } else {
                let closest = move |&ray: &Ray| {
                    let mut hit = RayHit::none();
                    let found = self.tree.closest(ray, &mut hit, test);
                    found.then(|| (self.tree.order()[hit.primitive_id as usize], hit.t))
                };
                EachRay::new(set, convert, closest).boxed()
            }
        })
    }
}

/// What its two trees have in common: the same methods, but no trait.
pub(super) trait Tree: Sync {
    /// The number of the primitive at each place in the leaves.
    fn order(&self) -> &[u32];
    fn closest(&self, ray: Ray, hit: &mut RayHit, test: impl FnMut(&Ray, usize) -> f32) -> bool;
    fn misses(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) -> bool;
}

macro_rules! tree {
    ($type:ty) => {
        impl Tree for $type {
            fn order(&self) -> &[u32] {
                &self.primitive_indices
            }

            fn closest(
                &self,
                ray: Ray,
                hit: &mut RayHit,
                test: impl FnMut(&Ray, usize) -> f32,
            ) -> bool {
                self.ray_traverse(ray, hit, test)
            }

            fn misses(&self, ray: Ray, test: impl FnMut(&Ray, usize) -> f32) -> bool {
                self.ray_traverse_miss(ray, test)
            }
        }
    };
}

tree!(CwBvh);
tree!(Bvh2);

fn convert(ray: &raywood::Ray) -> Ray {
    let vector = |v: raywood::Vec3| Vec3A::from_array(v.to_array());
    Ray::new(vector(ray.origin), vector(ray.direction), ray.t_min, ray.t_max)
}
