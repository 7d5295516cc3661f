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

#[cfg(test)]
mod tests {
    use raywood::Vec3;
    use raywood_testkit::closed::torus;

    use super::*;
    use crate::peers::queries::QUERY_PEERS;
    use crate::query::answers::Answers;
    use crate::query::reference::Reference;
    use crate::query::sets::query_sets;

    /// The measurements of all sets on a torus, with the answers expected as they are or changed.
    fn measurements(change: fn(&mut Answers)) -> Vec<Measurement> {
        let mesh = torus(24, Vec3::new(5.0, 0.0, -3.0), 2.0, 0.5);
        let reference = Reference::build(&mesh).expect("a tree");
        let pools = [1, 2].map(|threads| {
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool")
        });
        let built: Vec<_> = QUERY_PEERS
            .iter()
            .map(|peer| (peer.name, (peer.build)(&mesh).expect("a mesh that all take")))
            .collect();
        let sets = query_sets(QueryKind::ALL, &mesh, mesh.total_bounds().diagonal(), 2000);
        let measured = |set| {
            let mut expected = reference.expected(set).expect("brute force agrees");
            change(&mut expected.answers);
            let modes: Vec<_> = built
                .iter()
                .flat_map(|(peer, trees)| trees.modes().into_iter().map(|mode| (*peer, mode)))
                .collect();
            measure("torus", set, &expected, &modes, &pools, 2)
        };
        sets.iter().flat_map(measured).collect()
    }

    #[test]
    fn all_modes_of_all_libraries_answer_all_sets_rightly() {
        let measurements = measurements(|_| ());
        assert_eq!(measurements.len(), 2 * QueryKind::ALL.len());
        for measurement in measurements {
            assert_eq!((measurement.queries, measurement.rows.len()), (2000, 4));
            for row in &measurement.rows {
                assert!(measurement.ns_per_query(row) > Some(0.0), "{row:?}");
            }
        }
    }

    #[test]
    fn who_does_not_answer_as_expected_has_no_time() {
        let measurements = measurements(|answers| match answers {
            Answers::Distances(distances) => distances[1234] *= 1.01,
            Answers::Crossings(crossings) => crossings[..2].iter_mut().for_each(|n| *n += 1),
        });
        for row in measurements.iter().flat_map(|measurement| &measurement.rows) {
            assert!(matches!(row.outcome, Outcome::Wrong(_)), "{row:?}");
        }
    }
}
