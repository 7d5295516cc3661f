//! The budget of a frame: how far this machine is from pictures in real time.

use std::hint::black_box;

use rayon::prelude::*;
use raywood::{Geometry, Ray, Structure};

use super::measure::spread_text;
use super::{Entry, Findings, Judgement, Lab, LectureError, Verdict};
use crate::figures::{Axis, BarChart, BarSeries, Cell, Chart, Table};
use crate::flat::structure_of;
use crate::frame_budget::{CYCLES_PER_RAY, RAYS_PER_SECOND};
use crate::ray_sets::RayKind;
use crate::timing::{Timing, seconds, take_turns};

pub(super) const ENTRY: Entry = Entry {
    id: "frame",
    title: "The budget of a frame",
    claim: "1280 x 800 pixels with 10 rays each, 30 times a second, are 300 million rays a second. Eight cores of 3 GHz have 80 cycles for each: \
            26.7 ns of one core's time.",
    measure,
};

/// The lecture's cores have 3 GHz: the budget of a ray in nanoseconds.
const BUDGET: f64 = CYCLES_PER_RAY / 3.0;

/// Rays of a kind on one core.
#[derive(Clone, Debug)]
struct KindCost {
    kind: RayKind,
    nanoseconds: f64,
}

/// Rays of all kinds on some threads.
#[derive(Clone, Copy, Debug)]
struct Scaling {
    threads: usize,
    rays_per_second: f64,
}

fn measure(lab: &Lab<'_>) -> Result<Findings, LectureError> {
    let Some(subject) = lab.subjects().first() else {
        return Ok(findings(lab, "none", &[], &[], &[]));
    };
    let prepared = subject.prepared()?;
    let structure = structure_of(&prepared.scene);

    // One core, each kind in turn.
    let kinds: Vec<_> =
        RayKind::ALL.iter().copied().filter(|kind| !prepared.rays(*kind).is_empty()).collect();
    let rays: Vec<_> = kinds.iter().map(|kind| repeated(prepared.rays(*kind))).collect();
    let run = |i: usize| Some(seconds(|| trace(structure, kinds[i], &rays[i])).0);
    let mut timings = take_turns(kinds.len(), lab.rounds(), run).unwrap_or_default();
    let costs: Vec<_> = kinds
        .iter()
        .zip(&rays)
        .zip(&timings)
        .map(|((&kind, rays), timing)| KindCost {
            kind,
            nanoseconds: 1e9 * timing.median() / rays.len() as f64,
        })
        .collect();

    // All kinds together on more and more threads.
    let pieces: Vec<_> = kinds
        .iter()
        .zip(&rays)
        .flat_map(|(&kind, rays)| rays.chunks(BATCH).map(move |piece| (kind, piece)))
        .collect();
    let all: usize = rays.iter().map(Vec::len).sum();
    let mut scaling = Vec::new();
    if all > 0 {
        let counts = thread_counts(lab.threads());
        let pools: Vec<_> = counts.iter().filter_map(|&threads| pool(threads)).collect();
        let run = |i: usize| {
            let work = || pieces.par_iter().for_each(|(kind, rays)| trace(structure, *kind, rays));
            Some(seconds(|| pools[i].install(work)).0)
        };
        let measured = take_turns(pools.len(), lab.rounds(), run).unwrap_or_default();
        let point = |(pool, timing): (&rayon::ThreadPool, &Timing)| Scaling {
            threads: pool.current_num_threads(),
            rays_per_second: all as f64 / timing.median(),
        };
        scaling = pools.iter().zip(&measured).map(point).collect();
        timings.extend(measured);
    }
    Ok(findings(lab, subject.name(), &costs, &scaling, &timings))
}

/// How many rays are handed to the structure at once.
const BATCH: usize = 1024;

/// As few rays as this take less time than waking a thread does.
const FEWEST: usize = 1 << 16;

/// The rays as often as it takes to be enough for the clock.
fn repeated(rays: &[Ray]) -> Vec<Ray> {
    let times = FEWEST.div_ceil(rays.len().max(1));
    rays.repeat(times)
}

/// Traces rays of a kind in batches on this thread.
fn trace<G: Geometry>(structure: &Structure<G>, kind: RayKind, rays: &[Ray]) {
    let (mut hits, mut blocked) = ([None; BATCH], [false; BATCH]);
    for batch in rays.chunks(BATCH) {
        if kind.any_hit() {
            structure.occluded_batch_serial(batch, &mut blocked[..batch.len()]);
        } else {
            structure.intersect_batch_serial(batch, &mut hits[..batch.len()]);
        }
    }
    black_box((hits, blocked));
}

/// 1, 2, 4 ... and the most.
fn thread_counts(most: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(1), |count| Some(2 * count));
    doubled.take_while(|count| *count < most).chain([most.max(1)]).collect()
}

/// A pool of threads, or `None` if the system has no more.
fn pool(threads: usize) -> Option<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()
}

fn findings(
    lab: &Lab<'_>,
    scene: &str,
    costs: &[KindCost],
    scaling: &[Scaling],
    timings: &[Timing],
) -> Findings {
    let cores = scaling.last().map_or(1, |last| last.threads);
    let method = format!(
        "Scene: {scene}. Rays of every kind as a picture of it has them are traced through the default structure, a thousand at a time: first each \
         kind on one thread, then all together on 1 to {cores} threads. Medians of {} rounds taken in turn, {}. Only the search for hits is timed, \
         not shading. Clock rates are not known to the program, so times are compared instead of cycles.",
        lab.rounds(),
        spread_text(timings)
    );
    let mut table = Table::new(
        "Rays on one core",
        &["rays", "ns per ray", "million rays per second", "times the budget of 26.7 ns"],
    );
    table.rows = costs
        .iter()
        .map(|cost| {
            vec![
                Cell::text(cost.kind.name()),
                Cell::Number(cost.nanoseconds, 0),
                Cell::Number(1e3 / cost.nanoseconds, 2),
                Cell::Number(cost.nanoseconds / BUDGET, 1),
            ]
        })
        .collect();
    let mut threads = Table::new(
        "All kinds of rays on several threads",
        &["threads", "million rays per second", "times one thread", "share of 300 million"],
    );
    let alone = scaling.first().map_or(f64::NAN, |first| first.rays_per_second);
    threads.rows = scaling
        .iter()
        .map(|point| {
            vec![
                Cell::count(point.threads),
                Cell::Number(point.rays_per_second / 1e6, 2),
                Cell::Number(point.rays_per_second / alone, 2),
                Cell::Share(point.rays_per_second / RAYS_PER_SECOND),
            ]
        })
        .collect();

    let bars = Chart::Bars(BarChart {
        title: "Time per ray on one core; the budget is 26.7 ns".to_owned(),
        value: Axis::linear("time per ray (ns)"),
        decimals: 0,
        categories: costs.iter().map(|cost| cost.kind.name().to_owned()).collect(),
        series: vec![BarSeries {
            name: "time per ray".to_owned(),
            values: costs.iter().map(|cost| Some(cost.nanoseconds)).collect(),
        }],
    });
    let rates = |rate: &dyn Fn(&Scaling) -> f64| scaling.iter().map(|p| Some(rate(p))).collect();
    let by_threads = Chart::Bars(BarChart {
        title: "Rays per second on several threads".to_owned(),
        value: Axis::linear("million rays per second"),
        decimals: 2,
        categories: scaling.iter().map(|point| threads_text(point.threads)).collect(),
        series: vec![
            BarSeries { name: "measured".to_owned(), values: rates(&|p| p.rays_per_second / 1e6) },
            BarSeries {
                name: "as many times one thread".to_owned(),
                values: rates(&|p| p.threads as f64 * alone / 1e6),
            },
        ],
    });
    let verdict = judge(costs, scaling);
    Findings { method, tables: vec![table, threads], charts: vec![bars, by_threads], verdict }
}

fn threads_text(threads: usize) -> String {
    if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") }
}

fn judge(costs: &[KindCost], scaling: &[Scaling]) -> Verdict {
    let Some(most) = scaling.last().filter(|_| !costs.is_empty()) else {
        let explanation = "The eye sees nothing, so there are no rays to time.".to_owned();
        return Verdict { judgement: Judgement::NotMeasured, explanation };
    };
    let within: Vec<_> = costs.iter().map(|cost| cost.nanoseconds <= BUDGET).collect();
    let judgement = Judgement::by_conditions(&within);
    let names: Vec<_> = costs
        .iter()
        .map(|cost| format!("{:.0} ns for {} rays", cost.nanoseconds, cost.kind.name()))
        .collect();
    let explanation = format!(
        "A core needs {}: {} of {} kinds are within 26.7 ns. On {} this machine traces {:.2} million rays a second, {:.1} % of what the frame \
         takes; it would take {:.0} times as much.",
        names.join(", "),
        within.iter().filter(|within| **within).count(),
        within.len(),
        threads_text(most.threads),
        most.rays_per_second / 1e6,
        100.0 * most.rays_per_second / RAYS_PER_SECOND,
        RAYS_PER_SECOND / most.rays_per_second
    );
    Verdict { judgement, explanation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::default_scenes;

    #[test]
    fn verdicts_follow_from_the_numbers() {
        let scaling = [Scaling { threads: 2, rays_per_second: 1e7 }];
        let cost = |kind, nanoseconds| KindCost { kind, nanoseconds };
        let judgement = |primary: f64, diffuse: f64| {
            judge(&[cost(RayKind::Primary, primary), cost(RayKind::Diffuse, diffuse)], &scaling)
                .judgement
        };
        assert_eq!(judgement(20.0, 26.0), Judgement::Holds);
        assert_eq!(judgement(20.0, 260.0), Judgement::HoldsInPart);
        assert_eq!(judgement(200.0, 260.0), Judgement::Fails);
        assert_eq!(judge(&[], &scaling).judgement, Judgement::NotMeasured);
    }

    #[test]
    fn threads_double_up_to_the_most() {
        assert_eq!(thread_counts(1), [1]);
        assert_eq!(thread_counts(2), [1, 2]);
        assert_eq!(thread_counts(6), [1, 2, 4, 6]);
        assert_eq!(thread_counts(8), [1, 2, 4, 8]);
    }

    #[test]
    fn every_kind_of_ray_and_every_number_of_threads_is_timed() {
        let scenes = default_scenes(true);
        let lab = Lab::new(&scenes, true, 2).expect("scenes");
        let findings = measure(&lab).expect("findings");
        assert_eq!(findings.tables[0].rows.len(), RayKind::ALL.len());
        assert_eq!(findings.tables[1].rows.len(), 2);
        assert_ne!(findings.verdict.judgement, Judgement::NotMeasured);
    }
}
