//! The times of all modes for one set of questions: checked, then measured by turns.

use rayon::ThreadPool;
use raywood_lab::timing::seconds;

use super::answers::{Agreement, Expected};
use super::sets::{QueryKind, QuerySet};
use crate::outcome::{Outcome, outcomes};
use crate::peers::queries::{Finder, QueryMode};

/// How all modes did with one set of questions on so many threads.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measurement {
    pub(crate) scene: String,
    pub(crate) set: QueryKind,
    pub(crate) threads: usize,
    /// How many questions the set has.
    pub(crate) queries: usize,
    /// The modes of all peers, and the peers without any.
    pub(crate) rows: Vec<Row>,
}

/// How a mode did.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) peer: &'static str,
    /// Empty for a peer that has none because it is absent.
    pub(crate) mode: &'static str,
    pub(crate) outcome: Outcome<Agreement>,
}

impl Measurement {
    /// Nanoseconds for each question, on all threads together.
    pub(crate) fn ns_per_query(&self, row: &Row) -> Option<f64> {
        row.outcome.nanoseconds(self.queries)
    }
}

/// Lets all modes answer the set in each of the pools, checks their answers against those expected, and times those that are right. Each mode comes with its
/// library's name.
pub(crate) fn measure<'a>(
    scene: &str,
    set: &'a QuerySet,
    expected: &Expected,
    modes: &[(&'static str, QueryMode<'a>)],
    pools: &[ThreadPool],
    rounds: usize,
) -> Vec<Measurement> {
    // Converted once.
    let mut finders: Vec<_> = modes.iter().map(|(_, mode)| (mode.prepare)(set)).collect();
    let mut measurements = Vec::new();
    for pool in pools {
        let outcomes = outcomes(&mut finders, rounds, |f| find(f, pool), |f| check(f, expected));
        let rows = modes.iter().zip(outcomes).map(|((peer, mode), outcome)| Row {
            peer,
            mode: mode.name,
            outcome,
        });
        measurements.push(Measurement {
            scene: scene.to_owned(),
            set: set.kind,
            threads: pool.current_num_threads(),
            queries: set.len(),
            rows: rows.collect(),
        });
    }
    measurements
}

/// Seconds that the answers take in the pool.
fn find(finder: &mut (dyn Finder + '_), pool: &ThreadPool) -> f64 {
    pool.install(|| {
        finder.reset();
        seconds(|| finder.find()).0
    })
}

fn check(finder: &(dyn Finder + '_), expected: &Expected) -> Result<Agreement, String> {
    let agreement = Agreement::of(expected, &finder.answers())?;
    agreement.verdict()?;
    Ok(agreement)
}
