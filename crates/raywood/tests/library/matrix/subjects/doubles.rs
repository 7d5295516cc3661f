//! Meshes in double precision.

use std::ops::ControlFlow;

use raywood::{
    Aabb64, Ball64, Bvh64, ClosestPoint64, Frustum64, Hit64, Ray64, Region64, SphereHit64,
    TriangleMesh64,
};
use raywood_testkit::reference::{Found, FoundPoint};

use super::{Answers, BATCHES_TAKE_NONE, Offered, Subject, hit_queries, sorted};
use crate::matrix::axes::{Choice, Query, keeps};
use crate::matrix::questions::Questions;

fn found(hit: Hit64) -> Found {
    Found { t: hit.t, instance: 0, primitive: hit.primitive }
}

fn balls(questions: &Questions) -> Vec<Ball64> {
    let pairs = questions.points.iter().zip(&questions.radii);
    pairs.map(|(&center, &radius)| Ball64::new(center, radius)).collect()
}

fn found_point(closest: ClosestPoint64) -> FoundPoint {
    let ClosestPoint64 { point, distance, primitive, .. } = closest;
    FoundPoint { point, distance, instance: 0, primitive }
}

fn found_contact(contact: SphereHit64) -> FoundPoint {
    let SphereHit64 { t, point, primitive, .. } = contact;
    FoundPoint { point, distance: t, instance: 0, primitive }
}

/// What touches a region, in order.
fn touching<R: Region64>(bvh: &Bvh64, region: &R) -> Vec<(u32, u32)> {
    let mut told = Vec::new();
    let flow = bvh.overlapping(region, |primitive| {
        told.push((0, primitive));
        ControlFlow::Continue(())
    });
    assert!(flow.is_continue() && bvh.overlaps(region) != told.is_empty());
    sorted(told)
}

impl Subject for Bvh64 {
    /// Its batches give the answers of single rays.
    fn has_packets(&self, _: Query) -> bool {
        false
    }

    fn ask(&self, query: Query, choice: Choice, questions: &Questions) -> Offered {
        let rays = questions.rays64(query);
        let filtered = |options: raywood::QueryOptions| {
            options.filter64(move |hit: &Hit64| !choice.filters() || keeps(hit.primitive))
        };
        if let Some(answers) =
            hit_queries!(self, query, choice, questions, &rays[..], found, filtered)
        {
            return Ok(answers);
        }
        Ok(match query {
            Query::ClosestPoint if choice == Choice::Plain => {
                let pairs = questions.points.iter().zip(&questions.limits);
                let answers = pairs.map(|(&point, &limit)| self.closest_point(point, limit));
                Answers::Points(answers.map(|answer| answer.map(found_point)).collect())
            }
            Query::ClosestPointBatch if choice == Choice::Plain => {
                let mut answers = vec![None; questions.points.len()];
                self.closest_point_batch(&questions.points, f64::INFINITY, &mut answers);
                Answers::Points(answers.into_iter().map(|a| a.map(found_point)).collect())
            }
            Query::BoxOverlap if choice == Choice::Plain => {
                let one = |number: usize| {
                    let [min, max] = questions.corners(number);
                    touching(self, &Aabb64::new(min, max))
                };
                Answers::Touching((0..questions.points.len()).map(one).collect())
            }
            Query::BallOverlap if choice == Choice::Plain => {
                let balls = balls(questions);
                Answers::Touching(balls.iter().map(|ball| touching(self, ball)).collect())
            }
            Query::OverlapBatch => {
                let balls = balls(questions);
                let mut answers = vec![false; balls.len()];
                self.overlaps_batch(&balls, &mut answers);
                Answers::Touched(answers)
            }
            Query::FrustumOverlap => {
                let frustum = |number: usize| {
                    let (eye, _) = questions.views[number];
                    let planes = questions.planes(number);
                    let square = |n: [f64; 3]| n.iter().map(|x| x * x).sum::<f64>();
                    let height =
                        |n: [f64; 3], d: f64| (0..3).map(|i| n[i] * eye[i]).sum::<f64>() + d;
                    // The point of each that is nearest to the eye.
                    let through = planes.map(|(n, d)| {
                        let back = height(n, d) / square(n);
                        (n, [0, 1, 2].map(|i| eye[i] - back * n[i]))
                    });
                    Frustum64::from_planes(through)
                };
                let views = 0..questions.views.len();
                Answers::Touching(views.map(|n| touching(self, &frustum(n))).collect())
            }
            Query::ClosestPoint
            | Query::ClosestPointBatch
            | Query::BoxOverlap
            | Query::BallOverlap => {
                return Err("meshes of double precision have no masks");
            }
            Query::ForEachHit => return Err("its closure can leave out what it likes"),
            Query::ClosestBatch
            | Query::AnyBatch
            | Query::AllHitsBatch
            | Query::NearestHitsBatch => {
                return Err(BATCHES_TAKE_NONE);
            }
            Query::ClosestFrom | Query::AnyTowards => {
                return Err(
                    "batches of double precision find out themselves that rays share a point",
                );
            }
            Query::Inside => {
                let solid = self.solid();
                let one = |&point: &[f64; 3]| {
                    let side = if solid.contains(point) { -1.0 } else { 1.0 };
                    Some(side * solid.signed_distance(point)?.abs())
                };
                Answers::SignedDistances(questions.points.iter().map(one).collect())
            }
            Query::SignedDistance => {
                let mut answers = vec![None; questions.points.len()];
                self.solid().signed_distance_batch(&questions.points, &mut answers);
                Answers::SignedDistances(answers)
            }
            Query::TriangleOverlap => {
                Answers::Touching(questions.others.iter().map(|o| touching(self, o)).collect())
            }
            Query::TreeOverlap => {
                let count = questions.others.len() as u32;
                let indices = (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
                let mesh = TriangleMesh64::new(questions.others.concat(), indices);
                let other = Bvh64::build(mesh.expect("a mesh")).expect("it builds");
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
                let cast = |ray: &Ray64| self.sphere_cast(ray, questions.radius);
                Answers::Casts(rays.iter().map(|ray| cast(ray).map(found_contact)).collect())
            }
            Query::SphereCastBatch => {
                let mut hits = vec![None; rays.len()];
                self.sphere_cast_batch(&rays, questions.radius, &mut hits);
                Answers::Casts(hits.into_iter().map(|hit| hit.map(found_contact)).collect())
            }
            Query::Visit => return Err("not in double precision yet"),
            Query::Closest
            | Query::Any
            | Query::AllHits
            | Query::Crossings
            | Query::NearestHits => unreachable!("answered above"),
        })
    }
}
