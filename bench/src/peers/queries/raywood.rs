//! Raywood: its one tree, asked one by one or in batches.

use raywood::{Bvh, ClosestPoint, HitLists, Ray, TriangleMesh, Vec3};

use super::one_by_one::{OneByOne, counts};
use super::{Finder, QueryEntry, QueryMode, QueryPeer};
use crate::peers::RAYWOOD;
use crate::peers::each_ray::warm;
use crate::query::answers::Answers;
use crate::query::sets::{QuerySet, Questions};

pub(super) const ENTRY: QueryEntry = QueryEntry {
    name: RAYWOOD,
    settings: "Bvh::build; single: closest_point without a limit, crossings; batch: closest_point_batch, all_hits_batch, which also lists the hits by distance",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh) -> Result<Box<dyn QueryPeer + 'a>, String> {
    let bvh = Bvh::build(mesh).map_err(|error| error.to_string())?;
    Ok(Box::new(Raywood(bvh)))
}

struct Raywood<'a>(Bvh<&'a TriangleMesh>);

impl QueryPeer for Raywood<'_> {
    fn modes(&self) -> Vec<QueryMode<'_>> {
        let bvh = &self.0;
        vec![
            QueryMode::new("single", |set: &QuerySet| match &set.questions {
                Questions::ClosestPoint(points) => {
                    let closest = |point: &Vec3| bvh.closest_point(*point, f32::INFINITY);
                    OneByOne::boxed(points.clone(), closest, |_: &_, found: &_| distances(found))
                }
                Questions::Crossings(rays) => {
                    OneByOne::boxed(rays.clone(), |ray: &Ray| bvh.crossings(ray), counts)
                }
            }),
            QueryMode::new("batch", |set: &QuerySet| match &set.questions {
                Questions::ClosestPoint(points) => {
                    Box::new(ClosestPoints { bvh, points, found: vec![None; points.len()] })
                }
                Questions::Crossings(rays) => Box::new(AllHits { bvh, rays, lists: None }),
            }),
        ]
    }
}

fn distances(found: &[Option<ClosestPoint>]) -> Answers {
    let distance = |found: &Option<ClosestPoint>| {
        found.map_or(f64::INFINITY, |closest| f64::from(closest.distance))
    };
    Answers::Distances(found.iter().map(distance).collect())
}

/// All points at once.
struct ClosestPoints<'a> {
    bvh: &'a Bvh<&'a TriangleMesh>,
    points: &'a [Vec3],
    found: Vec<Option<ClosestPoint>>,
}

impl Finder for ClosestPoints<'_> {
    fn reset(&mut self) {
        warm(self.points);
        self.found.fill(None);
    }

    fn find(&mut self) {
        self.bvh.closest_point_batch(self.points, f32::INFINITY, &mut self.found);
    }

    fn answers(&self) -> Answers {
        distances(&self.found)
    }
}

/// All rays at once.
struct AllHits<'a> {
    bvh: &'a Bvh<&'a TriangleMesh>,
    rays: &'a [Ray],
    lists: Option<HitLists>,
}

impl Finder for AllHits<'_> {
    fn reset(&mut self) {
        warm(self.rays);
        self.lists = None;
    }

    fn find(&mut self) {
        self.lists = Some(self.bvh.all_hits_batch(self.rays));
    }

    fn answers(&self) -> Answers {
        Answers::Crossings(self.lists.iter().flat_map(HitLists::iter).map(<[_]>::len).collect())
    }
}
