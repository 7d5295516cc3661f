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
    let corner = |point: raywood::Vec3| Vec3A::from_array(point.to_array());
    let triangles: Vec<Triangle> = (0..mesh.triangles().len() as u32)
        .map(|number| {
            let [v0, v1, v2] = mesh.corners(number).map(corner);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let in_order = |indices: &[u32]| {
        indices.iter().map(|&i| RtTriangle::from(&triangles[i as usize])).collect()
    };
    let params = BvhBuildParams::very_slow_build();
    let bvh2 = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
    let cwbvh = build_cwbvh_from_tris(&triangles, params, &mut Duration::default());
    Ok(Box::new(Obvhs {
        bvh2_triangles: in_order(&bvh2.primitive_indices),
        cwbvh_triangles: in_order(&cwbvh.primitive_indices),
        bvh2,
        cwbvh,
    }))
}

struct Obvhs {
    bvh2: Bvh2,
    bvh2_triangles: Vec<RtTriangle>,
    cwbvh: CwBvh,
    cwbvh_triangles: Vec<RtTriangle>,
}

impl Peer for Obvhs {
    fn modes(&self) -> Vec<Mode<'_>> {
        // Its two trees have the same methods but no trait in common.
        macro_rules! mode {
            ($name:literal, $tree:ident, $triangles:ident) => {
                Mode::new($name, false, move |set: &RaySet| {
                    let test = move |ray: &Ray, place: usize| self.$triangles[place].intersect(ray);
                    if set.kind.any_hit() {
                        let occluded = move |&ray: &Ray| !self.$tree.ray_traverse_miss(ray, test);
                        EachRay::new(set, convert, occluded).boxed()
                    } else {
                        let closest = move |&ray: &Ray| {
                            let mut hit = RayHit::none();
                            let found = self.$tree.ray_traverse(ray, &mut hit, test);
                            found.then(|| {
                                (self.$tree.primitive_indices[hit.primitive_id as usize], hit.t)
                            })
                        };
                        EachRay::new(set, convert, closest).boxed()
                    }
                })
            };
        }
        vec![mode!("cwbvh", cwbvh, cwbvh_triangles), mode!("bvh2", bvh2, bvh2_triangles)]
    }
}

fn convert(ray: &raywood::Ray) -> Ray {
    let vector = |v: raywood::Vec3| Vec3A::from_array(v.to_array());
    Ray::new(vector(ray.origin), vector(ray.direction), ray.t_min, ray.t_max)
}
