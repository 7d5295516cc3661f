//! Raywood itself: every mode of its own that a user can choose.

use raywood::{BuildOptions, Bvh, Ray, Structure, StructureKind, TriangleMesh};

use super::each_ray::{Batch, EachRay};
use super::{Built, Mode, Peer, PeerEntry};
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "raywood",
    settings: "Bvh::build and bvh-wide, default options (bvh-wide with reinsertion); closest hits with t, u, v and primitive",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    let bvh = Bvh::build(mesh).map_err(|error| error.to_string())?;
    let wide = Structure::build(StructureKind::BvhWide, mesh, &BuildOptions::default());
    Ok(Box::new(Raywood { bvh, wide: wide.map_err(|error| error.to_string())? }))
}

struct Raywood<'a> {
    bvh: Bvh<&'a TriangleMesh>,
    wide: Structure<&'a TriangleMesh>,
}

impl Peer for Raywood<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        let Self { bvh, wide } = self;
        vec![
            Mode::new("wide batch", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    Batch::boxed(set, |rays, occluded| wide.occluded_batch(rays, occluded))
                } else {
                    Batch::boxed(set, |rays, hits| wide.intersect_batch(rays, hits))
                }
            }),
            Mode::new("wide single", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, Ray::clone, |ray| wide.occluded(ray)).boxed()
                } else {
                    EachRay::new(set, Ray::clone, |ray| wide.intersect(ray)).boxed()
                }
            }),
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
