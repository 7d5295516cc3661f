//! Structures over one geometry: those of the registry, packets through the binary tree, and the facade with all queries.

use std::ops::ControlFlow;

use raywood::{
    Aabb, Ball, Bvh, Bvh2, Hit, HitColumns, Ray, Region, Structure, StructureKind, Vec3,
};

use super::{
    Answers, BATCHES_TAKE_NONE, Offered, Subject, found, found_contact, found_point, frustum,
    hit_queries, is_for_packets, sorted, towards_point,
};
use crate::matrix::axes::{Choice, Query, keeps};
use crate::matrix::distance_of_box;
use crate::matrix::geometries::Shared;
use crate::matrix::questions::Questions;

const FOR_COMPARING: &str =
    "`Structure` is for comparing structures by closest and any hits; `Bvh` has every query";

fn closest(hits: &[Option<Hit>]) -> Answers {
    Answers::Closest(hits.iter().map(|hit| hit.map(found)).collect())
}

fn from_point(rays: &[Ray], trace: impl FnOnce(Vec3, &[Vec3], &mut HitColumns)) -> Answers {
    let directions: Vec<_> = rays.iter().map(|ray| ray.direction).collect();
    let mut columns = HitColumns::default();
    trace(rays[0].origin, &directions, &mut columns);
    Answers::Closest((0..rays.len()).map(|number| columns.get(number).map(found)).collect())
}

impl Subject for Structure<Shared> {
    fn has_packets(&self, query: Query) -> bool {
        self.kind() == StructureKind::BvhWide && is_for_packets(query)
    }

    fn ask(&self, query: Query, choice: Choice, questions: &Questions) -> Offered {
        if choice != Choice::Plain {
            return Err(FOR_COMPARING);
        }
        let rays = questions.rays(query);
        Ok(match query {
            Query::Closest => closest(&rays.iter().map(|r| self.intersect(r)).collect::<Vec<_>>()),
            Query::Any => Answers::Any(rays.iter().map(|ray| self.occluded(ray)).collect()),
            Query::ClosestBatch => {
                let mut hits = vec![None; rays.len()];
                self.intersect_batch(&rays, &mut hits);
                closest(&hits)
            }
            Query::AnyBatch => {
                let mut answers = vec![false; rays.len()];
                self.occluded_batch(&rays, &mut answers);
                Answers::Any(answers)
            }
            Query::ClosestFrom => from_point(&rays, |origin, directions, hits| {
                self.intersect_from(origin, directions, hits);
            }),
            Query::AnyTowards => towards_point(&rays, |target, points, answers| {
                self.occluded_towards(target, 1.0, points, answers);
            }),
            Query::AllHits
            | Query::AllHitsBatch
            | Query::ForEachHit
            | Query::Crossings
            | Query::NearestHits
            | Query::NearestHitsBatch
            | Query::ClosestPoint
            | Query::ClosestPointBatch
            | Query::Inside
            | Query::SignedDistance
            | Query::BoxOverlap
            | Query::BallOverlap
            | Query::FrustumOverlap
            | Query::TriangleOverlap
            | Query::OverlapBatch
            | Query::TreeOverlap
            | Query::SphereCast
            | Query::SphereCastBatch
            | Query::Visit => return Err(FOR_COMPARING),
        })
    }
}

/// Packets of rays through the tree of 32-byte nodes.
pub(crate) struct Packets(pub(crate) Bvh2, pub(crate) Shared);

impl Subject for Packets {
    /// These round as single rays do.
    fn has_packets(&self, _: Query) -> bool {
        false
    }

    fn ask(&self, query: Query, choice: Choice, questions: &Questions) -> Offered {
        let Self(tree, geometry) = self;
        let rays = questions.rays(query);
        match (query, choice) {
            (Query::ClosestBatch, Choice::Plain) => {
                let mut hits = vec![None; rays.len()];
                tree.intersect_packet(geometry, &rays, &mut hits, &mut ());
                Ok(closest(&hits))
            }
            (Query::AnyBatch, Choice::Plain) => {
                let mut answers = vec![false; rays.len()];
                tree.occluded_packet(geometry, &rays, &mut answers, &mut ());
                Ok(Answers::Any(answers))
            }
            _ => Err("packets through the binary tree are for closest and any hits"),
        }
    }
}

/// What touches a region, in order.
fn touching<R: Region>(bvh: &Bvh<Shared>, region: &R) -> Vec<(u32, u32)> {
    let mut told = Vec::new();
    let flow = bvh.overlapping(region, |primitive| {
        told.push((0, primitive));
        ControlFlow::Continue(())
    });
    assert!(flow.is_continue() && bvh.overlaps(region) != told.is_empty());
    sorted(told)
}

impl Subject for Bvh<Shared> {
    fn has_packets(&self, query: Query) -> bool {
        is_for_packets(query)
    }

    fn ask(&self, query: Query, choice: Choice, questions: &Questions) -> Offered {
        let rays = questions.rays(query);
        let filtered = |options: raywood::QueryOptions| {
            options.filter(move |hit: &Hit| !choice.filters() || keeps(hit.primitive))
        };
        if let Some(answers) =
            hit_queries!(self, query, choice, questions, &rays[..], found, filtered)
        {
            return Ok(answers);
        }
        let points = || 0..questions.points.len();
        let of_points = |number: usize| questions.point(number);
        if choice != Choice::Plain {
            return Err(match query {
                Query::ForEachHit => "its closure can leave out what it likes",
                Query::ClosestPoint
                | Query::ClosestPointBatch
                | Query::BoxOverlap
                | Query::BallOverlap => {
                    "primitives have masks for rays; `Bvh::visit` leaves out what one likes"
                }
                _ => BATCHES_TAKE_NONE,
            });
        }
        Ok(match query {
            Query::ClosestFrom => from_point(&rays, |origin, directions, hits| {
                self.intersect_from(origin, directions, hits);
            }),
            Query::AnyTowards => towards_point(&rays, |target, points, answers| {
                self.occluded_towards(target, 1.0, points, answers);
            }),
            Query::ClosestPoint => {
                let one = |number: usize| {
                    self.closest_point(of_points(number), questions.limits[number] as f32)
                };
                Answers::Points(points().map(|n| one(n).map(found_point)).collect())
            }
            Query::ClosestPointBatch => {
                let asked: Vec<_> = points().map(of_points).collect();
                let mut answers = vec![None; asked.len()];
                self.closest_point_batch(&asked, f32::INFINITY, &mut answers);
                Answers::Points(answers.into_iter().map(|a| a.map(found_point)).collect())
            }
            Query::Inside => {
                let solid = self.solid();
                let one = |number: usize| {
                    let point = of_points(number);
                    let side = if solid.contains(point) { -1.0 } else { 1.0 };
                    let distance = solid.signed_distance(point)?;
                    Some(side * f64::from(distance.abs()))
                };
                Answers::SignedDistances(points().map(one).collect())
            }
            Query::SignedDistance => {
                let asked: Vec<_> = points().map(of_points).collect();
                let mut answers = vec![None; asked.len()];
                self.solid().signed_distance_batch(&asked, &mut answers);
                Answers::SignedDistances(answers.into_iter().map(|a| a.map(f64::from)).collect())
            }
            Query::BoxOverlap => {
                let one = |number: usize| {
                    let [min, max] = questions.corners(number).map(|p| p.map(|x| x as f32));
                    touching(self, &Aabb::new(min, max))
                };
                Answers::Touching(points().map(one).collect())
            }
            Query::BallOverlap => {
                let ball = |n: usize| Ball::new(of_points(n), questions.radii[n] as f32);
                Answers::Touching(points().map(|number| touching(self, &ball(number))).collect())
            }
            Query::OverlapBatch => {
                let ball = |n: usize| Ball::new(of_points(n), questions.radii[n] as f32);
                let balls: Vec<_> = points().map(ball).collect();
                let mut answers = vec![false; balls.len()];
                self.overlaps_batch(&balls, &mut answers);
                Answers::Touched(answers)
            }
            Query::FrustumOverlap => {
                let views = 0..questions.views.len();
                Answers::Touching(views.map(|n| touching(self, &frustum(questions, n))).collect())
            }
            Query::TriangleOverlap => {
                let others = 0..questions.others.len();
                Answers::Touching(others.map(|n| touching(self, &questions.other(n))).collect())
            }
            Query::TreeOverlap => {
                let other = Bvh::build(questions.mesh_of_others()).expect("it builds");
                let mut told = vec![Vec::new(); questions.others.len()];
                let flow = self.overlapping_pairs(&other, |own, others| {
                    told[others as usize].push((0, own));
                    ControlFlow::Continue(())
                });
                assert!(flow.is_continue());
                assert_eq!(self.overlaps_any_of(&other), told.iter().any(|t| !t.is_empty()));
                Answers::Touching(told.into_iter().map(sorted).collect())
            }
            Query::SphereCast => {
                let cast = |ray: &Ray| self.sphere_cast(ray, questions.radius as f32);
                Answers::Casts(rays.iter().map(|ray| cast(ray).map(found_contact)).collect())
            }
            Query::SphereCastBatch => {
                let mut hits = vec![None; rays.len()];
                self.sphere_cast_batch(&rays, questions.radius as f32, &mut hits);
                Answers::Casts(hits.into_iter().map(|hit| hit.map(found_contact)).collect())
            }
            Query::Visit => {
                let one = |number: usize| {
                    let (point, mut least) = (of_points(number), f32::INFINITY);
                    let bound = |bounds: &Aabb| Some(distance_of_box(point, bounds));
                    let flow = self.visit(bound, |primitive| {
                        let bounds = self.geometry().bounds(primitive);
                        least = least.min(distance_of_box(point, &bounds));
                        ControlFlow::Continue(least)
                    });
                    assert!(flow.is_continue());
                    (least, questions.nearest_box(number, self.geometry()))
                };
                Answers::Boxes(points().filter(|&n| of_points(n).is_finite()).map(one).collect())
            }
            Query::Closest
            | Query::ClosestBatch
            | Query::Any
            | Query::AnyBatch
            | Query::AllHits
            | Query::AllHitsBatch
            | Query::ForEachHit
            | Query::Crossings
            | Query::NearestHits
            | Query::NearestHitsBatch => unreachable!("answered above"),
        })
    }
}
