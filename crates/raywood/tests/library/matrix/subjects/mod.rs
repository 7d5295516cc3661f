//! The axis of structures: everything that can be asked, each of which answers a query or says why it does not offer it.

mod doubles;
mod scenes;
mod trees;

pub(crate) use scenes::{one_level, two_levels};
pub(crate) use trees::Packets;

use raywood::{ClosestPoint, Frustum, Hit, Ray, SphereHit, Vec3};
use raywood_testkit::reference::{Found, FoundPoint};

use super::axes::{Choice, Query};
use super::questions::Questions;

/// Answers to all that a query asks.
#[derive(Clone, PartialEq)]
pub(crate) enum Answers {
    Closest(Vec<Option<Found>>),
    Any(Vec<bool>),
    Lists(Vec<Vec<Found>>),
    Counts(Vec<usize>),
    Points(Vec<Option<FoundPoint>>),
    SignedDistances(Vec<Option<f64>>),
    /// Of each region what touches it, in order.
    Touching(Vec<Vec<(u32, u32)>>),
    /// Of each region whether anything does.
    Touched(Vec<bool>),
    Casts(Vec<Option<FoundPoint>>),
    /// The distances of the nearest boxes.
    Boxes(Vec<(f32, f32)>),
}

/// Answers, or why there are none.
pub(crate) type Offered = Result<Answers, &'static str>;

/// Something that can be asked.
pub(crate) trait Subject {
    fn ask(&self, query: Query, choice: Choice, questions: &Questions) -> Offered;

    /// Whether rays of this query travel together in packets that round differently from single rays, so that of equally near hits any may be named.
    fn has_packets(&self, query: Query) -> bool;
}

/// The queries whose rays travel together where there are packets at all.
fn is_for_packets(query: Query) -> bool {
    use Query::{AnyBatch, AnyTowards, ClosestBatch, ClosestFrom};
    matches!(query, ClosestBatch | ClosestFrom | AnyBatch | AnyTowards)
}

fn found(hit: Hit) -> Found {
    Found { t: f64::from(hit.t), instance: hit.instance, primitive: hit.primitive }
}

fn found_point(closest: ClosestPoint) -> FoundPoint {
    let ClosestPoint { point, distance, primitive, instance, .. } = closest;
    let point = point.to_array().map(f64::from);
    FoundPoint { point, distance: f64::from(distance), instance, primitive }
}

fn found_contact(contact: SphereHit) -> FoundPoint {
    let SphereHit { t, point, primitive, instance, .. } = contact;
    let point = point.to_array().map(f64::from);
    FoundPoint { point, distance: f64::from(t), instance, primitive }
}

fn towards_point(rays: &[Ray], trace: impl FnOnce(Vec3, &[Vec3], &mut [bool])) -> Answers {
    let points: Vec<_> = rays.iter().map(|ray| ray.origin).collect();
    let mut answers = vec![false; points.len()];
    trace(rays[0].at(1.0), &points, &mut answers);
    Answers::Any(answers)
}

/// A view as a region.
fn frustum(questions: &Questions, number: usize) -> Frustum {
    let plane = |([a, b, c], d): ([f64; 3], f64)| [a, b, c, d].map(|x| x as f32);
    Frustum::from_planes(questions.planes(number).map(plane))
}

fn sorted<T: Ord>(mut list: Vec<T>) -> Vec<T> {
    list.sort_unstable();
    list
}

const BATCHES_TAKE_NONE: &str =
    "batches take no options: what many rays share is what makes them fast";

/// The queries about hits of rays, which trees and scenes have in common. Falls through where the subject must answer itself.
macro_rules! hit_queries {
    ($subject:expr, $query:expr, $choice:expr, $questions:expr, $rays:expr, $found:expr, $options:expr) => {{
        use std::ops::ControlFlow;
        use $crate::matrix::axes::{Choice, Query};
        use $crate::matrix::questions::{NEAREST, enough, nearest};
        use $crate::matrix::subjects::Answers;

        let (subject, rays, plain) = ($subject, $rays, $choice == Choice::Plain);
        let found = $found;
        let options = |number: usize| $options($choice.options($questions.skips[number]));
        let each = rays.iter().enumerate();
        let mut hits = Vec::new();
        match $query {
            Query::Closest => Some(Answers::Closest(
                each.map(|(i, ray)| match plain {
                    true => subject.intersect(ray).map(found),
                    false => subject.intersect_with(ray, options(i)).map(found),
                })
                .collect(),
            )),
            Query::Any => Some(Answers::Any(
                each.map(|(i, ray)| match plain {
                    true => subject.occluded(ray),
                    false => subject.occluded_with(ray, options(i)),
                })
                .collect(),
            )),
            Query::ClosestBatch if plain => {
                let mut hits = vec![None; rays.len()];
                subject.intersect_batch(&rays, &mut hits);
                Some(Answers::Closest(hits.into_iter().map(|hit| hit.map(found)).collect()))
            }
            Query::AnyBatch if plain => {
                let mut answers = vec![false; rays.len()];
                subject.occluded_batch(&rays, &mut answers);
                Some(Answers::Any(answers))
            }
            Query::AllHits => Some(Answers::Lists(
                each.map(|(i, ray)| {
                    match plain {
                        true => subject.all_hits(ray, &mut hits),
                        false => subject.all_hits_with(ray, options(i), &mut hits),
                    }
                    hits.iter().copied().map(found).collect()
                })
                .collect(),
            )),
            Query::AllHitsBatch if plain => {
                let lists = subject.all_hits_batch(&rays);
                let lists = lists.iter().map(|hits| hits.iter().copied().map(found).collect());
                Some(Answers::Lists(lists.collect()))
            }
            Query::NearestHits => Some(Answers::Lists(
                each.map(|(i, ray)| {
                    match plain {
                        true => subject.nearest_hits(ray, nearest(i), &mut hits),
                        false => subject.nearest_hits_with(ray, nearest(i), options(i), &mut hits),
                    }
                    hits.iter().copied().map(found).collect()
                })
                .collect(),
            )),
            Query::NearestHitsBatch if plain => {
                let lists = subject.nearest_hits_batch(&rays, NEAREST);
                let lists = lists.iter().map(|hits| hits.iter().copied().map(found).collect());
                Some(Answers::Lists(lists.collect()))
            }
            Query::ForEachHit if plain => Some(Answers::Lists(
                each.map(|(i, ray)| {
                    let mut told = Vec::new();
                    let flow = subject.for_each_hit(ray, |hit| {
                        told.push(found(hit));
                        match told.len() < enough(i) {
                            true => ControlFlow::Continue(()),
                            false => ControlFlow::Break(()),
                        }
                    });
                    assert_eq!(flow.is_break(), told.len() == enough(i));
                    told
                })
                .collect(),
            )),
            Query::Crossings => {
                Some(Answers::Counts(each.map(|(_, ray)| subject.crossings(ray)).collect()))
            }
            _ => None,
        }
    }};
}

pub(crate) use hit_queries;
