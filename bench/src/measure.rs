//! The times of all modes for one set of rays: checked, then measured by turns.

use rayon::ThreadPool;
use raywood_lab::Timing;
use raywood_lab::timing::seconds;

use crate::answers::{Agreement, Answers};
use crate::peers::{Mode, Tracer};
use crate::ray_sets::{RaySet, SetKind};

/// A mode that takes longer than this for a set of rays takes part in fewer rounds, in the first [`FEW_ROUNDS`].
const SLOW_SECONDS: f64 = 0.6;
const FEW_ROUNDS: usize = 3;

/// How all modes did with one set of rays on so many threads.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measurement {
    pub(crate) scene: String,
    pub(crate) set: SetKind,
    pub(crate) threads: usize,
    /// How many rays the set has.
    pub(crate) rays: usize,
    /// How many of them hit something, by the reference.
    pub(crate) hits: usize,
    /// The modes of all peers, and the peers without any.
    pub(crate) rows: Vec<Row>,
}

/// How a mode did.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) peer: &'static str,
    /// Empty for a peer that has none because it is absent.
    pub(crate) mode: &'static str,
    pub(crate) watertight: bool,
    pub(crate) outcome: Outcome,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// Its answers are right, and it took so long.
    Timed { timing: Timing, agreement: Agreement },
    /// Its answers are wrong: how.
    Wrong(String),
    /// It is not there: why.
    Absent(String),
}

impl Measurement {
    /// Nanoseconds for each ray, on all threads together.
    pub(crate) fn ns_per_ray(&self, row: &Row) -> Option<f64> {
        match &row.outcome {
            Outcome::Timed { timing, .. } => Some(1e9 * timing.median() / self.rays.max(1) as f64),
            _ => None,
        }
    }
}

/// A mode that takes part.
pub(crate) struct Contestant<'a> {
    pub(crate) peer: &'static str,
    pub(crate) mode: Mode<'a>,
}

/// Lets all modes trace the set in each of the pools, checks their answers against those expected, and times those that are right.
pub(crate) fn measure<'a>(
    scene: &str,
    set: &'a RaySet,
    expected: &Answers,
    contestants: &[Contestant<'a>],
    pools: &[ThreadPool],
    rounds: usize,
) -> Vec<Measurement> {
    // Packed once; where a mode does not trace such rays there is nothing to tell.
    let (heads, mut tracers): (Vec<_>, Vec<_>) = contestants
        .iter()
        .filter_map(|contestant| Some((contestant, (contestant.mode.prepare)(set)?)))
        .unzip();
    let mut measurements = Vec::new();
    for pool in pools {
        let outcomes = outcomes(&mut tracers, expected, pool, rounds);
        let rows = heads.iter().zip(outcomes).map(|(Contestant { peer, mode }, outcome)| Row {
            peer,
            mode: mode.name,
            watertight: mode.watertight,
            outcome,
        });
        measurements.push(Measurement {
            scene: scene.to_owned(),
            set: set.kind,
            threads: pool.current_num_threads(),
            rays: set.rays.len(),
            hits: expected.hits(),
            rows: rows.collect(),
        });
    }
    measurements
}

/// What comes of each tracer in a pool.
fn outcomes(
    tracers: &mut [Box<dyn Tracer + '_>],
    expected: &Answers,
    pool: &ThreadPool,
    rounds: usize,
) -> Vec<Outcome> {
    // Check, which also warms up, and see who is slow.
    let mut verdicts = Vec::new();
    let mut allowed = Vec::new();
    for tracer in tracers.iter_mut() {
        let time = trace(&mut **tracer, pool);
        let verdict = check(&**tracer, expected);
        allowed.push(match verdict {
            Err(_) => 0,
            Ok(_) if time > SLOW_SECONDS => rounds.min(FEW_ROUNDS),
            Ok(_) => rounds,
        });
        verdicts.push(verdict);
    }

    // Take turns, every other round backwards, so that what slows the machine for a while slows all alike.
    let mut times = vec![Vec::new(); tracers.len()];
    for round in 0..rounds {
        for place in 0..tracers.len() {
            let turn = if round % 2 == 0 { place } else { tracers.len() - 1 - place };
            if round < allowed[turn] {
                times[turn].push(trace(&mut *tracers[turn], pool));
            }
        }
    }

    // The answers that were timed are right too.
    let parts = tracers.iter_mut().zip(verdicts).zip(times);
    parts
        .map(|((tracer, verdict), times)| match verdict.and_then(|_| check(&**tracer, expected)) {
            Ok(agreement) => Outcome::Timed { timing: Timing::new(times), agreement },
            Err(wrong) => Outcome::Wrong(wrong),
        })
        .collect()
}

/// Seconds that the tracer takes in the pool, packing left out.
fn trace(tracer: &mut dyn Tracer, pool: &ThreadPool) -> f64 {
    pool.install(|| {
        tracer.reset();
        seconds(|| tracer.trace()).0
    })
}

fn check(tracer: &dyn Tracer, expected: &Answers) -> Result<Agreement, String> {
    let agreement = Agreement::of(expected, &tracer.answers())?;
    agreement.verdict()?;
    Ok(agreement)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// A tracer that is right until it has traced so often; it counts on an atomic that outlives it.
    struct Decaying<'a> {
        rounds_left: usize,
        traced: &'a AtomicUsize,
        distance: f32,
    }

    impl Tracer for Decaying<'_> {
        fn reset(&mut self) {
            self.distance = f32::INFINITY;
        }

        fn trace(&mut self) {
            self.traced.fetch_add(1, Ordering::Relaxed);
            self.distance = if self.rounds_left > 0 { 1.0 } else { 2.0 };
            self.rounds_left = self.rounds_left.saturating_sub(1);
        }

        fn answers(&self) -> Answers {
            Answers::Closest(vec![self.distance; 100])
        }
    }

    #[test]
    fn wrong_answers_get_no_time_not_even_late_ones() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let expected = Answers::Closest(vec![1.0; 100]);
        let counts = [0; 3].map(AtomicUsize::new);
        // Right, wrong, and wrong from the fourth time on.
        let decaying = |(rounds_left, traced)| {
            Box::new(Decaying { rounds_left, traced, distance: 0.0 }) as Box<dyn Tracer + '_>
        };
        let mut tracers: Vec<_> = [100, 0, 3].into_iter().zip(&counts).map(decaying).collect();
        let outcomes = outcomes(&mut tracers, &expected, &pool, 5);
        assert!(matches!(&outcomes[0], Outcome::Timed { timing, .. } if timing.rounds() == 5));
        assert!(matches!(outcomes[1], Outcome::Wrong(_)));
        assert!(matches!(outcomes[2], Outcome::Wrong(_)));
        // Who is wrong at once is not even timed.
        assert_eq!(counts.each_ref().map(|count| count.load(Ordering::Relaxed)), [6, 1, 6]);
    }
}
