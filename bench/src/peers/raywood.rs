//! Raywood itself: every mode of its own that a user can choose.

use raywood::{BuildOptions, Bvh, Ray, Structure, StructureKind, TriangleMesh, TriangleTest};

use super::each_ray::{Batch, EachRay};
use super::{Built, Mode, Peer, PeerEntry};
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "raywood",
    settings: "Bvh::build and bvh-wide, default options (bvh-wide with reinsertion); closest hits with t, u, v and primitive; \
        fast modes with the triangle test of Moeller and Trumbore",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    let bvh = Bvh::build(mesh).map_err(|error| error.to_string())?;
    let wide = |triangle_test: TriangleTest| {
        let options = BuildOptions { triangle_test, ..BuildOptions::default() };
        Structure::build(StructureKind::BvhWide, mesh, &options).map_err(|error| error.to_string())
    };
    let (wide, fast) = (wide(TriangleTest::Watertight)?, wide(TriangleTest::Fast)?);
    Ok(Box::new(Raywood { bvh, wide, fast }))
}

struct Raywood<'a> {
    bvh: Bvh<&'a TriangleMesh>,
    wide: Structure<&'a TriangleMesh>,
    /// The same tree with a triangle test that is not watertight.
    fast: Structure<&'a TriangleMesh>,
}

impl Peer for Raywood<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        let Self { bvh, wide, fast } = self;
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
            Mode::new("fast batch", false, |set: &RaySet| {
                if set.kind.any_hit() {
                    Batch::boxed(set, |rays, occluded| fast.occluded_batch(rays, occluded))
                } else {
                    Batch::boxed(set, |rays, hits| fast.intersect_batch(rays, hits))
                }
            }),
            Mode::new("fast single", false, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, Ray::clone, |ray| fast.occluded(ray)).boxed()
                } else {
                    EachRay::new(set, Ray::clone, |ray| fast.intersect(ray)).boxed()
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
