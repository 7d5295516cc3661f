//! Raywood itself: every mode of its own that a user can choose.

use std::hint::black_box;

use raywood::{
    BuildOptions, BuildPreset, Bvh64, HitColumns, Ray, Ray64, Structure, StructureKind,
    TriangleMesh, TriangleMesh64, TriangleTest, Vec3,
};

use super::each_ray::{Batch, EachRay};
use super::{Built, Mode, Peer, PeerEntry, Tracer};
use crate::answers::Answers;
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "raywood",
    settings: "bvh-wide (which Bvh is) by the preset best, with reinsertion and spatial splits, and bvh-sah-binned (modes batch and single) by default options; closest hits with t, u, v and primitive; \
        fast modes with the triangle test of Moeller and Trumbore; \
        double modes with Bvh64 over the same coordinates and rays as f64",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    let bvh = Structure::build(StructureKind::BvhSahBinned, mesh, &BuildOptions::default())
        .map_err(|error| error.to_string())?;
    let wide = |triangle_test: TriangleTest| {
        let options = BuildOptions { triangle_test, ..BuildPreset::Best.options() };
        Structure::build(StructureKind::BvhWide, mesh, &options).map_err(|error| error.to_string())
    };
    let (wide, fast) = (wide(TriangleTest::Watertight)?, wide(TriangleTest::Fast)?);
    let positions = mesh.positions().iter().map(|&p| double(p)).collect();
    let double = TriangleMesh64::new(positions, mesh.triangles().to_vec())
        .map_err(|error| error.to_string())?;
    let double = Bvh64::build_with(double, &BuildPreset::Best.options())
        .map_err(|error| error.to_string())?;
    Ok(Box::new(Raywood { bvh, wide, fast, double }))
}

/// The same coordinates in double precision.
fn double(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

/// The same ray in double precision.
fn double_ray(ray: &Ray) -> Ray64 {
    Ray64::new(double(ray.origin), double(ray.direction))
        .with_interval(f64::from(ray.t_min), f64::from(ray.t_max))
}

struct Raywood<'a> {
    /// The lecture's binary tree.
    bvh: Structure<&'a TriangleMesh>,
    wide: Structure<&'a TriangleMesh>,
    /// The same tree with a triangle test that is not watertight.
    fast: Structure<&'a TriangleMesh>,
    /// The mesh and the rays in double precision.
    double: Bvh64,
}

impl Peer for Raywood<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        let Self { bvh, wide, fast, double } = self;
        vec![
            batch_mode("wide batch", wide),
            Mode::new("wide single", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, Ray::clone, |ray| wide.occluded(ray)).boxed()
                } else {
                    EachRay::new(set, Ray::clone, |ray| wide.intersect(ray)).boxed()
                }
            }),
            Mode::new("fast batch", false, |set: &RaySet| {
                if set.kind.any_hit() {
                    Batch::boxed(&set.rays, |rays, occluded| fast.occluded_batch(rays, occluded))
                } else {
                    Batch::boxed(&set.rays, |rays, hits| fast.intersect_batch(rays, hits))
                }
            }),
            Mode::new("fast single", false, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, Ray::clone, |ray| fast.occluded(ray)).boxed()
                } else {
                    EachRay::new(set, Ray::clone, |ray| fast.intersect(ray)).boxed()
                }
            }),
            Mode::new("double batch", true, |set: &RaySet| {
                let rays: Vec<_> = set.rays.iter().map(double_ray).collect();
                if set.kind.any_hit() {
                    Batch::boxed(rays, |rays, occluded| double.occluded_batch(rays, occluded))
                } else {
                    Batch::boxed(rays, |rays, hits| double.intersect_batch(rays, hits))
                }
            }),
            Mode::new("double single", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    EachRay::new(set, double_ray, |ray| double.occluded(ray)).boxed()
                } else {
                    EachRay::new(set, double_ray, |ray| double.intersect(ray)).boxed()
                }
            }),
            Mode::new("wide point", true, |set: &RaySet| point_tracer(wide, set)),
            Mode::new("fast point", false, |set: &RaySet| point_tracer(fast, set)),
            Mode::new("batch", true, |set: &RaySet| {
                if set.kind.any_hit() {
                    Batch::boxed(&set.rays, |rays, occluded| bvh.occluded_batch(rays, occluded))
                } else {
                    Batch::boxed(&set.rays, |rays, hits| bvh.intersect_batch(rays, hits))
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

/// The watertight mode that is handed slices of rays.
pub(super) fn batch_mode<'a>(
    name: &'static str,
    structure: &'a Structure<&'a TriangleMesh>,
) -> Mode<'a> {
    Mode::new(name, true, |set: &RaySet| {
        if set.kind.any_hit() {
            Batch::boxed(&set.rays, |rays, occluded| structure.occluded_batch(rays, occluded))
        } else {
            Batch::boxed(&set.rays, |rays, hits| structure.intersect_batch(rays, hits))
        }
    })
}

/// The rays of a set that have a point in common, given by that point and what else each has.
fn point_tracer<'a>(
    structure: &'a Structure<&'a TriangleMesh>,
    set: &'a RaySet,
) -> Option<Box<dyn Tracer + 'a>> {
    let point = set.common?;
    Some(if set.kind.any_hit() {
        let points: Vec<_> = set.rays.iter().map(|ray| ray.origin).collect();
        Box::new(Towards { structure, point, occluded: vec![false; points.len()], points })
    } else {
        let directions: Vec<_> = set.rays.iter().map(|ray| ray.direction).collect();
        let hits = HitColumns::new(directions.len());
        Box::new(FromPoint { structure, point, directions, hits })
    })
}

/// Rays from a point.
struct FromPoint<'a> {
    structure: &'a Structure<&'a TriangleMesh>,
    point: Vec3,
    directions: Vec<Vec3>,
    hits: HitColumns,
}

impl Tracer for FromPoint<'_> {
    fn reset(&mut self) {
        black_box(self.directions.clone());
        self.hits = HitColumns::new(self.directions.len());
    }

    fn trace(&mut self) {
        self.structure.intersect_from(self.point, &self.directions, &mut self.hits);
    }

    fn answers(&self) -> Answers {
        Answers::closest(self.hits.iter().map(|hit| hit.map(|hit| hit.t)))
    }
}

/// Rays to a point.
struct Towards<'a> {
    structure: &'a Structure<&'a TriangleMesh>,
    point: Vec3,
    points: Vec<Vec3>,
    occluded: Vec<bool>,
}

impl Tracer for Towards<'_> {
    fn reset(&mut self) {
        black_box(self.points.clone());
        self.occluded.fill(false);
    }

    fn trace(&mut self) {
        self.structure.occluded_towards(self.point, 1.0, &self.points, &mut self.occluded);
    }

    fn answers(&self) -> Answers {
        Answers::Any(self.occluded.clone())
    }
}
