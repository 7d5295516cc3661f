//! Holds answers against the reference.

use raywood_testkit::reference::{Entry, Region};

use super::axes::{Choice, MASK, Query};
use super::questions::{NEAREST, Questions, enough, nearest};
use super::subjects::Answers;

/// Compares all answers to a query; tells how many there were, or what is wrong with one. With `ties` the lowest of equally near hits must be named.
pub(crate) fn check(
    questions: &Questions,
    query: Query,
    choice: Choice,
    answers: &Answers,
    ties: bool,
) -> Result<usize, String> {
    let reference = &questions.reference;
    let rays = questions.range(query);
    // Batches and points ask instances for their masks alone.
    let counts = |entry: &Entry| !choice.masks() || entry.masks[1..].iter().all(|m| m & MASK != 0);
    let is_batch = matches!(query, Query::ClosestBatch | Query::AnyBatch);
    let counts_of = |ray: usize| {
        let skip = questions.skips[ray];
        move |entry: &Entry| match is_batch {
            true => counts(entry),
            false => choice.counts(skip, entry),
        }
    };
    let is_finite = |number: usize| questions.points[number].iter().all(|x| x.is_finite());
    let with_ray =
        |ray: usize, error: String| format!("{error}, with {:?}", questions.met[ray].ray);
    match answers {
        Answers::Closest(hits) => {
            assert_eq!(hits.len(), rays.len());
            for (ray, hit) in rays.zip(hits) {
                let counts = counts_of(ray);
                let rule = choice.rule(&counts);
                let checked =
                    reference.check_closest(&questions.met[ray], hit.as_ref(), &rule, ties);
                checked.map_err(|error| with_ray(ray, error))?;
            }
            Ok(hits.len())
        }
        Answers::Any(any) => {
            assert_eq!(any.len(), rays.len());
            for (ray, &any) in rays.zip(any) {
                let counts = counts_of(ray);
                let checked = reference.check_any(&questions.met[ray], any, &choice.rule(&counts));
                checked.map_err(|error| with_ray(ray, error))?;
            }
            Ok(any.len())
        }
        Answers::Lists(lists) => {
            assert_eq!(lists.len(), rays.len());
            for (number, (ray, hits)) in rays.zip(lists).enumerate() {
                let (met, counts) = (&questions.met[ray], counts_of(ray));
                let rule = choice.rule(&counts);
                let checked = match query {
                    Query::ForEachHit => {
                        let checked = reference.check_some(met, hits, &rule, enough(number));
                        checked.and_then(|_| match hits.len() < enough(number) {
                            true => reference.check_complete(met, hits, &rule, f64::INFINITY),
                            false => Ok(()),
                        })
                    }
                    Query::NearestHits => reference.check_all(met, hits, &rule, nearest(number)),
                    Query::NearestHitsBatch => reference.check_all(met, hits, &rule, NEAREST),
                    _ => reference.check_all(met, hits, &rule, usize::MAX),
                };
                checked.map_err(|error| with_ray(ray, error))?;
            }
            Ok(lists.iter().map(Vec::len).sum::<usize>().max(lists.len()))
        }
        Answers::Counts(hits) => {
            assert_eq!(hits.len(), rays.len());
            for (ray, &hits) in rays.zip(hits) {
                let counts = counts_of(ray);
                let met = &questions.met[ray];
                let checked = reference.check_count(met, hits, &choice.rule(&counts));
                checked.map_err(|error| with_ray(ray, error))?;
            }
            Ok(hits.len())
        }
        Answers::Points(found) => {
            assert_eq!(found.len(), questions.points.len());
            for (number, found) in found.iter().enumerate() {
                let (point, limit) = match query {
                    Query::ClosestPointBatch => (questions.points[number], f64::INFINITY),
                    _ => (questions.points[number], questions.limits[number]),
                };
                if is_finite(number) && limit >= 0.0 {
                    let checked =
                        reference.check_closest_point(point, limit, found.as_ref(), &counts);
                    checked.map_err(|error| format!("{error}, of {point:?} up to {limit}"))?;
                } else if found.is_some() {
                    return Err(format!("{found:?} of {point:?} up to {limit}"));
                }
            }
            Ok(found.len())
        }
        Answers::SignedDistances(distances) => {
            assert_eq!(distances.len(), questions.points.len());
            for (number, &distance) in distances.iter().enumerate() {
                let point = questions.points[number];
                if is_finite(number) {
                    let checked = reference.check_signed_distance(point, distance);
                    checked.map_err(|error| format!("{error}, of {point:?}"))?;
                } else if distance.is_some() {
                    return Err(format!("{distance:?} of {point:?}"));
                }
            }
            Ok(distances.len())
        }
        Answers::Touching(told) => {
            for (number, told) in told.iter().enumerate() {
                let region = match query {
                    Query::BoxOverlap => questions.cuboid(number),
                    Query::BallOverlap => questions.ball(number),
                    Query::FrustumOverlap => questions.view(number),
                    _ => Region::Triangle(questions.others[number]),
                };
                let is_point = matches!(query, Query::BoxOverlap | Query::BallOverlap);
                if !is_point || is_finite(number) {
                    reference.check_touching(&region, told, &counts)?;
                } else if matches!(query, Query::BallOverlap) && !told.is_empty() {
                    return Err(format!("{told:?} touches {region:?}"));
                }
            }
            Ok(told.len())
        }
        Answers::Touched(told) => {
            for (number, &told) in told.iter().enumerate().filter(|(n, _)| is_finite(*n)) {
                reference.check_touches(&questions.ball(number), told)?;
            }
            Ok(told.len())
        }
        Answers::Casts(contacts) => {
            assert_eq!(contacts.len(), rays.len());
            for (ray, contact) in rays.zip(contacts) {
                let met = &questions.met[ray];
                let checked = match met.is_valid {
                    true => reference.check_cast(&met.ray, questions.radius, contact.as_ref()),
                    false if contact.is_some() => Err(format!("{contact:?}")),
                    false => Ok(()),
                };
                checked.map_err(|error| with_ray(ray, error))?;
            }
            Ok(contacts.len())
        }
        Answers::Boxes(distances) => {
            match distances.iter().find(|(walked, expected)| walked != expected) {
                Some((walked, expected)) => Err(format!("{walked} instead of {expected}")),
                None => Ok(distances.len()),
            }
        }
    }
}
