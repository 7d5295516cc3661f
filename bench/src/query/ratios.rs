//! How many times as long as each of Raywood's modes `parry3d` takes.

use serde_json::{Value, json};

use super::measure::Measurement;
use crate::peers::RAYWOOD;
use crate::peers::queries::PARRY;

/// The time of `parry3d` as a multiple of Raywood's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ratio {
    pub(crate) scene: String,
    pub(crate) set: &'static str,
    pub(crate) threads: usize,
    pub(crate) raywood_mode: &'static str,
    pub(crate) raywood_ns: f64,
    /// The fastest of its modes.
    pub(crate) parry_mode: &'static str,
    pub(crate) parry_ns: f64,
}

impl Ratio {
    /// Above 1 where Raywood is faster.
    pub(crate) fn ratio(&self) -> f64 {
        self.parry_ns / self.raywood_ns
    }

    /// The ratio as JSON.
    pub(crate) fn json(&self) -> Value {
        json!({
            "scene": self.scene,
            "set": self.set,
            "threads": self.threads,
            "raywood_mode": self.raywood_mode,
            "raywood_ns": self.raywood_ns,
            "parry_mode": self.parry_mode,
            "parry_ns": self.parry_ns,
            "ratio": self.ratio(),
        })
    }
}

/// The ratios of a measurement, one for each of Raywood's modes. Modes that have no time take no part.
pub(crate) fn ratios(measurement: &Measurement) -> Vec<Ratio> {
    let times = |peer: &'static str| {
        let of_peer = measurement.rows.iter().filter(move |row| row.peer == peer);
        of_peer.filter_map(|row| Some((row.mode, measurement.ns_per_query(row)?)))
    };
    let Some((parry_mode, parry_ns)) = times(PARRY).min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Vec::new();
    };
    let ratio = |(raywood_mode, raywood_ns)| Ratio {
        scene: measurement.scene.clone(),
        set: measurement.set.name(),
        threads: measurement.threads,
        raywood_mode,
        raywood_ns,
        parry_mode,
        parry_ns,
    };
    times(RAYWOOD).map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::Outcome;
    use crate::query::report::tests::measurement;

    #[test]
    fn each_mode_is_held_against_the_faster_one_of_parry() {
        let mut measurement = measurement();
        let summary = |measurement: &Measurement| -> Vec<_> {
            let rounded = |ratio: &Ratio| (1e6 * ratio.ratio()).round() / 1e6;
            ratios(measurement).iter().map(|r| (r.raywood_mode, r.parry_mode, rounded(r))).collect()
        };
        assert_eq!(summary(&measurement), [("single", "ploc", 1.5), ("batch", "ploc", 3.0)]);
        let json = ratios(&measurement)[0].json();
        assert_eq!((&json["set"], &json["threads"]), (&json!("box"), &json!(2)));
        for row in measurement.rows.iter_mut().filter(|row| row.mode == "ploc") {
            row.outcome = Outcome::Wrong("wrong".into());
        }
        assert_eq!(summary(&measurement), [("single", "trimesh", 2.0), ("batch", "trimesh", 4.0)]);
        measurement.rows.retain(|row| row.peer == RAYWOOD);
        assert_eq!(summary(&measurement), []);
    }
}
