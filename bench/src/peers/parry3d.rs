//! `parry3d`: a triangle mesh with its tree by binned SAH, as its users have it, and its tree by PLOC, which it recommends for casting
//! rays.

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::{Ray, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};
use raywood::TriangleMesh;

use super::each_ray::{Answer, EachRay};
use super::{Built, Mode, Peer, PeerEntry};
use crate::embree::Library;
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "parry3d",
    settings: "TriMesh without flags (binned SAH), and Bvh by PLOC over the same triangles; it has no any-hit query: closest hit up to t_max",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, _: Option<&'a Library>) -> Built<'a> {
    let mesh = tri_mesh(mesh)?;
    Ok(Box::new(Parry { ploc: ploc(&mesh), mesh }))
}

/// Its own mesh, which comes with a tree.
pub(super) fn tri_mesh(mesh: &TriangleMesh) -> Result<TriMesh, String> {
    let vertices = mesh.positions().iter().map(|p| vector(*p)).collect();
    TriMesh::new(vertices, mesh.triangles().to_vec()).map_err(|error| error.to_string())
}

/// The tree over its mesh that it recommends for rays.
pub(super) fn ploc(mesh: &TriMesh) -> Bvh {
    Bvh::from_iter(BvhBuildStrategy::Ploc, leaves(mesh))
}

/// The boxes of all triangles with their numbers.
pub(super) fn leaves(mesh: &TriMesh) -> impl Iterator<Item = (usize, Aabb)> {
    mesh.triangles().map(|triangle| triangle.local_aabb()).enumerate()
}

struct Parry {
    mesh: TriMesh,
    ploc: Bvh,
}

/// A ray and where it ends: its own rays have no end.
type Segment = (Ray, f32);

impl Peer for Parry {
    fn modes(&self) -> Vec<Mode<'_>> {
        let in_mesh = |(ray, t_max): &Segment| {
            CompositeShapeRef(&self.mesh).cast_local_ray(ray, *t_max, false)
        };
        vec![mode("trimesh", in_mesh), tree_mode("ploc", &self.mesh, &self.ploc)]
    }
}

/// The mode that traces through a tree over a mesh.
pub(super) fn tree_mode<'a>(name: &'static str, mesh: &'a TriMesh, tree: &'a Bvh) -> Mode<'a> {
    mode(name, |(ray, t_max): &Segment| {
        let test = |number, best| mesh.triangle(number).cast_local_ray(ray, best, false);
        tree.cast_ray(ray, *t_max, test).filter(|hit| hit.1 < *t_max)
    })
}

/// The mode that finds the closest hit, which answers both questions.
fn mode<'a>(
    name: &'static str,
    closest: impl Fn(&Segment) -> Option<(u32, f32)> + Copy + Send + Sync + 'a,
) -> Mode<'a> {
    Mode::new(name, false, move |set: &RaySet| {
        if set.kind.any_hit() {
            each(set, move |segment| closest(segment).is_some())
        } else {
            each(set, closest)
        }
    })
}

fn each<'a, A: Answer + 'a>(
    set: &RaySet,
    trace: impl Fn(&Segment) -> A + Send + Sync + 'a,
) -> Option<Box<dyn super::Tracer + 'a>> {
    EachRay::new(set, convert, trace).boxed()
}

fn convert(ray: &raywood::Ray) -> Segment {
    // It takes the largest number for a ray without end.
    (Ray::new(vector(ray.origin), vector(ray.direction)), ray.t_max.min(f32::MAX))
}

pub(super) fn vector(v: raywood::Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}
