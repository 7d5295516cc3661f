//! The times of all modes for one set of rays: checked, then measured by turns.

use rayon::ThreadPool;
use raywood_lab::timing::seconds;

use crate::answers::{Agreement, Answers};
use crate::outcome::{Outcome, outcomes};
use crate::peers::{Mode, Tracer};
use crate::ray_sets::{RaySet, SetKind};

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
    pub(crate) outcome: Outcome<Agreement>,
}

impl Measurement {
    /// Nanoseconds for each ray, on all threads together.
    pub(crate) fn ns_per_ray(&self, row: &Row) -> Option<f64> {
        row.outcome.nanoseconds(self.rays)
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
        let outcomes = outcomes(&mut tracers, rounds, |t| trace(t, pool), |t| check(t, expected));
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

/// Seconds that the tracer takes in the pool, packing left out.
fn trace(tracer: &mut (dyn Tracer + '_), pool: &ThreadPool) -> f64 {
    pool.install(|| {
        tracer.reset();
        seconds(|| tracer.trace()).0
    })
}

fn check(tracer: &(dyn Tracer + '_), expected: &Answers) -> Result<Agreement, String> {
    let agreement = Agreement::of(expected, &tracer.answers())?;
    agreement.verdict()?;
    Ok(agreement)
}
