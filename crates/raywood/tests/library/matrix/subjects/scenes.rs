//! Scenes of instances, and scenes of these.

use std::ops::ControlFlow;
use std::sync::Arc;

use raywood::{
    Aabb, Ball, Bvh, Hit, HitColumns, Instance, Ray, SceneRegion, Searchable, SimdLevel, Tlas, Vec3,
};

use super::{
    Answers, BATCHES_TAKE_NONE, Offered, Subject, found, found_contact, found_point, frustum,
    hit_queries, is_for_packets, sorted, towards_point,
};
use crate::matrix::axes::{Choice, MASK, Query, keeps};
use crate::matrix::distance_of_box;
use crate::matrix::geometries::Shared;
use crate::matrix::questions::{Placed, Questions, outer_places, places};

fn scene<B: Searchable>(object: B, places: &[Placed], level: SimdLevel) -> Tlas<B> {
    let object = Arc::new(object);
    let instance = |&(placement, mask): &Placed| {
        let transform = placement.transform();
        Instance { mask, ..Instance::new(Arc::clone(&object), transform) }
    };
    let mut scene = Tlas::build(places.iter().map(instance).collect()).expect("good transforms");
    scene.set_simd_level(level);
    scene
}

/// Instances of a tree.
pub(crate) fn one_level(bvh: Bvh<Shared>) -> Tlas<Bvh<Shared>> {
    let level = bvh.simd_level();
    scene(bvh, &places(), level)
}

/// Instances of instances of a tree.
pub(crate) fn two_levels(bvh: Bvh<Shared>) -> Tlas<Tlas<Bvh<Shared>>> {
    let level = bvh.simd_level();
    scene(scene(bvh, &places()[1..5], level), &outer_places(), level)
}

/// What touches a region, in order.
fn touching<B: Searchable>(scene: &Tlas<B>, region: &impl SceneRegion) -> Vec<(u32, u32)> {
    let mut told = Vec::new();
    let flow = scene.overlapping(region, |instance, primitive| {
        told.push((instance, primitive));
        ControlFlow::Continue(())
    });
    assert!(flow.is_continue() && scene.overlaps(region) != told.is_empty());
    sorted(told)
}

impl<B: Searchable> Subject for Tlas<B> {
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
        let (is_plain, is_masked) = (choice == Choice::Plain, choice == Choice::Mask);
        Ok(match query {
            Query::ClosestBatch if is_masked => {
                let mut hits = vec![None; rays.len()];
                self.intersect_batch_masked(&rays, MASK, &mut hits);
                Answers::Closest(hits.into_iter().map(|hit| hit.map(found)).collect())
            }
            Query::AnyBatch if is_masked => {
                let mut answers = vec![false; rays.len()];
                self.occluded_batch_masked(&rays, MASK, &mut answers);
                Answers::Any(answers)
            }
            Query::ForEachHit => Answers::Lists(
                rays.iter()
                    .enumerate()
                    .map(|(number, ray)| {
                        let (mut told, enough) =
                            (Vec::new(), crate::matrix::questions::enough(number));
                        let options = filtered(choice.options(questions.skips[number]));
                        let flow = self.for_each_hit_with(ray, options, |hit| {
                            told.push(found(hit));
                            match told.len() < enough {
                                true => ControlFlow::Continue(()),
                                false => ControlFlow::Break(()),
                            }
                        });
                        assert_eq!(flow.is_break(), told.len() == enough);
                        told
                    })
                    .collect(),
            ),
            Query::ClosestBatch
            | Query::AnyBatch
            | Query::AllHitsBatch
            | Query::NearestHitsBatch => {
                return Err(BATCHES_TAKE_NONE);
            }
            Query::ClosestFrom => {
                let directions: Vec<_> = rays.iter().map(|ray| ray.direction).collect();
                let mut columns = HitColumns::default();
                self.intersect_from_serial(rays[0].origin, &directions, &mut columns);
                let hits = (0..rays.len()).map(|number| columns.get(number).map(found));
                Answers::Closest(hits.collect())
            }
            Query::ClosestPoint => {
                let one = |number: usize| {
                    let (point, limit) = (questions.point(number), questions.limits[number] as f32);
                    match choice {
                        Choice::Mask => self.closest_point_masked(point, limit, MASK),
                        _ => self.closest_point(point, limit),
                    }
                };
                Answers::Points(points().map(|n| one(n).map(found_point)).collect())
            }
            Query::ClosestPointBatch if is_plain => {
                let asked: Vec<_> = points().map(|number| questions.point(number)).collect();
                let mut answers = vec![None; asked.len()];
                self.closest_point_batch(&asked, f32::INFINITY, &mut answers);
                Answers::Points(answers.into_iter().map(|a| a.map(found_point)).collect())
            }
            Query::BoxOverlap if is_plain => {
                let one = |number: usize| {
                    let [min, max] = questions.corners(number).map(|p| p.map(|x| x as f32));
                    touching(self, &Aabb::new(min, max))
                };
                Answers::Touching(points().map(one).collect())
            }
            Query::BallOverlap if is_plain => {
                let ball = |n: usize| Ball::new(questions.point(n), questions.radii[n] as f32);
                Answers::Touching(points().map(|number| touching(self, &ball(number))).collect())
            }
            Query::ClosestPointBatch | Query::BoxOverlap | Query::BallOverlap => {
                return Err("`Tlas::closest_point_masked` alone takes a mask");
            }
            Query::AnyTowards => towards_point(&rays, |target, points, answers| {
                self.occluded_towards(target, 1.0, points, answers);
            }),
            Query::Inside => {
                let solid = self.solid();
                let asked: Vec<_> = points().map(|number| questions.point(number)).collect();
                let mut inside = vec![false; asked.len()];
                solid.contains_batch(&asked, &mut inside);
                let one = |(&point, is_inside): (&Vec3, bool)| {
                    assert_eq!(solid.contains(point), is_inside);
                    let side = if is_inside { -1.0 } else { 1.0 };
                    let distance = solid.signed_distance(point)?;
                    Some(side * f64::from(distance.abs()))
                };
                Answers::SignedDistances(asked.iter().zip(inside).map(one).collect())
            }
            Query::SignedDistance => {
                let asked: Vec<_> = points().map(|number| questions.point(number)).collect();
                let mut answers = vec![None; asked.len()];
                self.solid().signed_distance_batch(&asked, &mut answers);
                Answers::SignedDistances(answers.into_iter().map(|a| a.map(f64::from)).collect())
            }
            Query::OverlapBatch => {
                let ball = |n: usize| Ball::new(questions.point(n), questions.radii[n] as f32);
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
                let flow = self.overlapping_pairs(&other, |instance, own, others| {
                    told[others as usize].push((instance, own));
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
                    let (point, mut least) = (questions.point(number), f32::INFINITY);
                    let bound = |bounds: &Aabb| Some(distance_of_box(point, bounds));
                    let flow = self.visit(bound, |instance, primitive| {
                        let bounds = questions.box_of(instance, primitive);
                        least = least.min(distance_of_box(point, &bounds));
                        ControlFlow::Continue(least)
                    });
                    assert!(flow.is_continue());
                    (least, questions.nearest_of_all(number))
                };
                let is_finite = |&n: &usize| questions.point(n).is_finite();
                Answers::Boxes(points().filter(is_finite).map(one).collect())
            }
            Query::Closest
            | Query::Any
            | Query::AllHits
            | Query::Crossings
            | Query::NearestHits => unreachable!("answered above"),
        })
    }
}
