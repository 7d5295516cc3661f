//! How many times as long as Raywood's presets Embree's builds take that are for the same purpose.

use serde_json::{Value, json};

use super::turns::{Outcome, Row};
use crate::peers::builds::PAIRS;
use crate::peers::{EMBREE, RAYWOOD};

/// Embree's time as a multiple of Raywood's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ratio {
    pub(crate) preset: &'static str,
    pub(crate) quality: &'static str,
    pub(crate) raywood_ms: f64,
    pub(crate) embree_ms: f64,
}

impl Ratio {
    /// Above 1 where Raywood is faster.
    pub(crate) fn ratio(&self) -> f64 {
        self.embree_ms / self.raywood_ms
    }

    /// The ratio as JSON.
    pub(crate) fn json(&self, scene: &str, threads: usize) -> Value {
        json!({
            "scene": scene,
            "threads": threads,
            "preset": self.preset,
            "embree_quality": self.quality,
            "raywood_ms": self.raywood_ms,
            "embree_ms": self.embree_ms,
            "ratio": self.ratio(),
        })
    }
}

/// The ratios of all pairs of which both were measured, of their warm times.
pub(crate) fn ratios(rows: &[Row]) -> Vec<Ratio> {
    let ms = |peer: &str, preset: &str| {
        let row = rows.iter().find(|row| row.peer == peer && row.preset == preset)?;
        match &row.outcome {
            Outcome::Timed(times) => Some(1e3 * times.warm.median()),
            _ => None,
        }
    };
    let ratio = |&(preset, quality): &(&'static str, &'static str)| {
        let (raywood_ms, embree_ms) = (ms(RAYWOOD, preset)?, ms(EMBREE, quality)?);
        Some(Ratio { preset, quality, raywood_ms, embree_ms })
    };
    PAIRS.iter().filter_map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use raywood_lab::Timing;

    use super::*;
    use crate::build::turns::Times;

    #[test]
    fn presets_are_held_against_the_quality_of_their_purpose() {
        let row = |peer, preset, seconds| {
            let times = Times { warm: Timing::new(vec![seconds]), ..Times::default() };
            Row { peer, preset, outcome: Outcome::Timed(times) }
        };
        let mut rows = vec![
            row(RAYWOOD, "fastest", 0.5),
            row(RAYWOOD, "fast", 1.0),
            row(RAYWOOD, "high", 4.0),
            row(EMBREE, "LOW", 0.25),
            row(EMBREE, "MEDIUM", 3.0),
            row(EMBREE, "HIGH", 8.0),
        ];
        let summary = |rows: &[Row]| -> Vec<_> {
            ratios(rows).iter().map(|r| (r.preset, r.quality, r.ratio())).collect()
        };
        assert_eq!(summary(&rows), [("fastest", "LOW", 0.5), ("high", "HIGH", 2.0)]);
        rows[3].outcome = Outcome::Wrong("wrong".into());
        assert_eq!(summary(&rows), [("high", "HIGH", 2.0)]);
        let json = ratios(&rows)[0].json("hall", 2);
        assert_eq!((&json["embree_ms"], &json["threads"]), (&json!(8000.0), &json!(2)));
    }
}
