//! `parry3d`: points are projected onto its mesh; crossings are counted along its tree, for which it has no query of its own.

use parry3d::math::Vector;
use parry3d::partitioning::Bvh;
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast};
use parry3d::shape::TriMesh;
use raywood::TriangleMesh;

use super::one_by_one::{OneByOne, counts};
use super::{Finder, QueryEntry, QueryMode, QueryPeer};
use crate::peers::parry3d::{ENTRY as TRACER, ploc, tri_mesh, vector};
use crate::query::answers::Answers;
use crate::query::sets::{QuerySet, Questions};

pub(super) const ENTRY: QueryEntry = QueryEntry {
    name: TRACER.name,
    settings: "TriMesh without flags (binned SAH) and Bvh by PLOC over the same triangles; project_local_point of points, not solid; of rays the triangles hit in those of its \
        Bvh's leaves that BvhNode::cast_ray lets through",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh) -> Result<Box<dyn QueryPeer + 'a>, String> {
    let mesh = tri_mesh(mesh)?;
    Ok(Box::new(Parry { ploc: ploc(&mesh), mesh }))
}

struct Parry {
    mesh: TriMesh,
    ploc: Bvh,
}

impl QueryPeer for Parry {
    fn modes(&self) -> Vec<QueryMode<'_>> {
        let Self { mesh, ploc } = self;
        vec![
            QueryMode::new("trimesh", |set: &QuerySet| match &set.questions {
                Questions::ClosestPoint(points) => {
                    projected(points, |point| Some(mesh.project_local_point(*point, false)))
                }
                Questions::Crossings(rays) => counted(rays, mesh, mesh.bvh()),
            }),
            QueryMode::new("ploc", |set: &QuerySet| match &set.questions {
                Questions::ClosestPoint(points) => projected(points, |&point| {
                    let onto =
                        |number, _| Some(mesh.triangle(number).project_local_point(point, false));
                    ploc.project_point(point, f32::MAX, onto).map(|(_, (_, projection))| projection)
                }),
                Questions::Crossings(rays) => counted(rays, mesh, ploc),
            }),
        ]
    }
}

/// What projects points. Their distances are computed when the clock stands: it gives none.
fn projected<'a>(
    points: &[raywood::Vec3],
    project: impl Fn(&Vector) -> Option<PointProjection> + Send + Sync + 'a,
) -> Box<dyn Finder + 'a> {
    let read = |points: &[Vector], found: &[Option<PointProjection>]| {
        let distance = |(from, found): (&Vector, &Option<PointProjection>)| {
            found.map_or(f64::INFINITY, |found| distance(*from, found.point))
        };
        Answers::Distances(points.iter().zip(found).map(distance).collect())
    };
    OneByOne::boxed(points.iter().map(|point| vector(*point)).collect(), project, read)
}

fn distance(a: Vector, b: Vector) -> f64 {
    let squares = [a.x - b.x, a.y - b.y, a.z - b.z].map(|x| f64::from(x).powi(2));
    squares.iter().sum::<f64>().sqrt()
}

/// What counts the triangles that rays hit.
fn counted<'a>(rays: &[raywood::Ray], mesh: &'a TriMesh, tree: &'a Bvh) -> Box<dyn Finder + 'a> {
    let convert = |ray: &raywood::Ray| Ray::new(vector(ray.origin), vector(ray.direction));
    let count = |ray: &Ray| {
        tree.leaves(|node| node.cast_ray(ray, f32::MAX) < f32::MAX)
            .filter(|&number| mesh.triangle(number).cast_local_ray(ray, f32::MAX, false).is_some())
            .count()
    };
    OneByOne::boxed(rays.iter().map(convert).collect(), count, counts)
}
