//! Raywood itself: every mode of its own that a user can choose.

use raywood::{Bvh, Ray, TriangleMesh};

use super::each_ray::{Batch, EachRay};
use super::{Built, Mode, Peer, PeerEntry};
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "raywood",
    settings: "Bvh::build, default options; closest hits with t, u, v and primitive",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    Ok(Box::new(Raywood(Bvh::build(mesh).map_err(|error| error.to_string())?)))
}

struct Raywood<'a>(Bvh<&'a TriangleMesh>);

impl Peer for Raywood<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        let bvh = &self.0;
        vec![
            Mode::new("batch", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    Batch::boxed(set, |rays, occluded| bvh.occluded_batch(rays, occluded))
                } else {
                    Batch::boxed(set, |rays, hits| bvh.intersect_batch(rays, hits))
                }
            }),
            Mode::new("single", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, Ray::clone, |ray| bvh.occluded(ray)).boxed()
                } else {
                    EachRay::new(set, Ray::clone, |ray| bvh.intersect(ray)).boxed()
                }
            }),
        ]
    }
}
