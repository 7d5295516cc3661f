//! How many times as long as Raywood Embree takes: the numbers that the work on kernels is held against.

use serde_json::{Value, json};

use crate::measure::{Measurement, Row};
use crate::peers::{EMBREE, RAYWOOD};

/// Embree's time as a multiple of Raywood's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ratio {
    pub(crate) scene: String,
    pub(crate) set: &'static str,
    pub(crate) threads: usize,
    /// Whether Raywood's mode is watertight, else fast.
    pub(crate) watertight: bool,
    pub(crate) raywood_kernel: &'static str,
    pub(crate) raywood_ns: f64,
    pub(crate) embree_mode: &'static str,
    pub(crate) embree_ns: f64,
    pub(crate) against: Against,
}

/// Which of Embree's modes are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Against {
    /// The fastest of those with the flag ROBUST.
    Robust,
    /// The fastest of all.
    Best,
}

impl Ratio {
    /// Above 1 where Raywood is faster.
    pub(crate) fn ratio(&self) -> f64 {
        self.embree_ns / self.raywood_ns
    }

    /// The ratio as JSON.
    pub(crate) fn json(&self) -> Value {
        json!({
            "scene": self.scene,
            "set": self.set,
            "threads": self.threads,
            "raywood_mode": if self.watertight { "watertight" } else { "fast" },
            "raywood_kernel": self.raywood_kernel,
            "raywood_ns": self.raywood_ns,
            "embree_mode": self.embree_mode,
            "embree_ns": self.embree_ns,
            "ratio": self.ratio(),
            "against": match self.against {
                Against::Robust => "robust",
                Against::Best => "best",
            },
            // Watertight against what is not: only as long as there is no fast mode.
            "unequal": self.watertight && self.against == Against::Best,
        })
    }
}

/// The ratios of a measurement: Raywood's watertight modes against Embree's robust ones, and its fast modes, or the watertight ones where
/// there are none, against Embree's best. Modes that have no time take no part.
pub(crate) fn ratios(measurement: &Measurement) -> Vec<Ratio> {
    let fastest = |peer: &str, chosen: &dyn Fn(&Row) -> bool| {
        measurement
            .rows
            .iter()
            .filter(|row| row.peer == peer && chosen(row))
            .filter_map(|row| Some((row.mode, measurement.ns_per_ray(row)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let ratio = |watertight: bool, against: Against| {
        let raywood = fastest(RAYWOOD, &|row| row.watertight == watertight)?;
        let embree = fastest(EMBREE, &|row| against == Against::Best || row.watertight)?;
        Some(Ratio {
            scene: measurement.scene.clone(),
            set: measurement.set.name(),
            threads: measurement.threads,
            watertight,
            raywood_kernel: raywood.0,
            raywood_ns: raywood.1,
            embree_mode: embree.0,
            embree_ns: embree.1,
            against,
        })
    };
    let against_best = ratio(false, Against::Best).or_else(|| ratio(true, Against::Best));
    ratio(true, Against::Robust).into_iter().chain(against_best).collect()
}

#[cfg(test)]
mod tests {
    use raywood_lab::Timing;

    use super::*;
    use crate::answers::Agreement;
    use crate::outcome::Outcome;
    use crate::ray_sets::SetKind;

    fn row(peer: &'static str, mode: &'static str, watertight: bool, ns: f64) -> Row {
        let timing = Timing::new(vec![1e-9 * ns * 1000.0]);
        let outcome = Outcome::Timed { timing, agreement: Agreement::default() };
        Row { peer, mode, watertight, outcome }
    }

    fn measurement(rows: Vec<Row>) -> Measurement {
        let scene = "a scene".to_owned();
        Measurement { scene, set: SetKind::Mirror, threads: 2, rays: 1000, hits: 900, rows }
    }

    fn rows() -> Vec<Row> {
        vec![
            row(RAYWOOD, "batch", true, 50.0),
            row(RAYWOOD, "single", true, 80.0),
            row(EMBREE, "1", false, 60.0),
            row(EMBREE, "16", false, 20.0),
            row(EMBREE, "1 robust", true, 100.0),
            row(EMBREE, "16 robust", true, 120.0),
            row("obvhs", "cwbvh", false, 1.0),
        ]
    }

    /// Whom it compares with whom, and with what result, rounded.
    fn summary(ratio: &Ratio) -> (bool, &str, &str, f64) {
        let rounded = (1e6 * ratio.ratio()).round() / 1e6;
        (ratio.watertight, ratio.raywood_kernel, ratio.embree_mode, rounded)
    }

    #[test]
    fn the_fastest_of_each_are_compared() {
        let ratios = ratios(&measurement(rows()));
        let summaries: Vec<_> = ratios.iter().map(summary).collect();
        let expected = [(true, "batch", "1 robust", 2.0), (true, "batch", "16", 0.4)];
        assert_eq!(summaries, expected);
        let json = ratios[1].json();
        assert_eq!((&json["set"], &json["threads"]), (&json!("mirror"), &json!(2)));
        assert_eq!((&json["raywood_mode"], &json["unequal"]), (&json!("watertight"), &json!(true)));
        assert_eq!(ratios[0].json()["unequal"], false);
    }

    #[test]
    fn a_fast_mode_takes_the_watertight_ones_place_against_the_best() {
        let mut rows = rows();
        rows.push(row(RAYWOOD, "fast", false, 10.0));
        let ratios = ratios(&measurement(rows));
        let summaries: Vec<_> = ratios.iter().map(summary).collect();
        assert_eq!(summaries, [(true, "batch", "1 robust", 2.0), (false, "fast", "16", 2.0)]);
    }

    #[test]
    fn wrong_and_absent_modes_take_no_part() {
        let mut rows = rows();
        rows[3].outcome = Outcome::Wrong("wrong".into());
        assert_eq!(ratios(&measurement(rows.clone()))[1].embree_mode, "1");
        for row in rows.iter_mut().filter(|row| row.peer == EMBREE) {
            row.outcome = Outcome::Absent("absent".into());
        }
        assert_eq!(ratios(&measurement(rows)), []);
    }
}
