//! Measurements for people, as a table on the terminal, and for programs, as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use super::measure::{Measurement, Row};
use super::ratios::ratios;
use super::sets::QueryKind;
use crate::outcome::Outcome;
use crate::report::line;

/// The table of one measurement.
pub(crate) fn text(measurement: &Measurement) -> String {
    let Measurement { scene, set, threads, queries, rows } = measurement;
    let plural = if *threads == 1 { "" } else { "s" };
    let what = match set {
        QueryKind::SurfaceNear | QueryKind::Box | QueryKind::Far => "points, closest point",
        QueryKind::Crossings => "rays, how often they cross the surface",
    };
    let set = set.name();
    let mut text =
        format!("\n{scene}, {set}: {queries} {what}; {threads} thread{plural}, ns per query\n");
    for row in rows {
        text.push_str(&line(&format!("{} {}", row.peer, row.mode), &row.outcome, *queries));
    }
    for ratio in ratios(measurement) {
        let _ = writeln!(
            text,
            "  parry3d's best mode ({}) / raywood {}: {:.2}",
            ratio.parry_mode,
            ratio.raywood_mode,
            ratio.ratio()
        );
    }
    text
}

/// One measurement as JSON.
pub(crate) fn measurement_json(measurement: &Measurement) -> Value {
    json!({
        "scene": measurement.scene,
        "set": measurement.set.name(),
        "threads": measurement.threads,
        "queries": measurement.queries,
        "modes": measurement.rows.iter().map(|row| row_json(measurement, row)).collect::<Vec<_>>(),
    })
}

fn row_json(measurement: &Measurement, row: &Row) -> Value {
    let mut value = json!({ "peer": row.peer, "mode": row.mode });
    match &row.outcome {
        Outcome::Timed { timing, agreement } => {
            value["ns_per_query"] = json!(measurement.ns_per_query(row));
            value["spread"] = json!(timing.spread());
            value["rounds"] = json!(timing.rounds());
            value["differing"] = json!(agreement.differing);
        }
        Outcome::Wrong(how) => value["wrong"] = json!(how),
        Outcome::Absent(why) => value["absent"] = json!(why),
    }
    value
}

#[cfg(test)]
pub(super) mod tests {
    use raywood_lab::Timing;

    use super::*;
    use crate::peers::RAYWOOD;
    use crate::peers::queries::PARRY;
    use crate::query::answers::Agreement;

    /// A thousand points; times of 200 and 100 ns against 400 and 300.
    pub(crate) fn measurement() -> Measurement {
        let row = |peer, mode, ns: f64| {
            let timing = Timing::new(vec![0.8e-6 * ns, 1e-6 * ns, 1.2e-6 * ns]);
            let agreement = Agreement::default();
            Row { peer, mode, outcome: Outcome::Timed { timing, agreement } }
        };
        Measurement {
            scene: "hall".into(),
            set: QueryKind::Box,
            threads: 2,
            queries: 1000,
            rows: vec![
                row(RAYWOOD, "single", 200.0),
                row(RAYWOOD, "batch", 100.0),
                row(PARRY, "trimesh", 400.0),
                row(PARRY, "ploc", 300.0),
            ],
        }
    }

    #[test]
    fn text_has_times_only_of_who_is_right() {
        let mut measurement = measurement();
        measurement.rows[2].outcome = Outcome::Wrong("7 of 9 answers differ".into());
        let text = text(&measurement);
        let lines: Vec<_> =
            text.lines().map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(
            lines[1..],
            [
                "hall, box: 1000 points, closest point; 2 threads, ns per query",
                "raywood single 200.0 ± 10%",
                "raywood batch 100.0 ± 10%",
                "parry3d trimesh wrong: 7 of 9 answers differ",
                "parry3d ploc 300.0 ± 10%",
                "parry3d's best mode (ploc) / raywood single: 1.50",
                "parry3d's best mode (ploc) / raywood batch: 3.00",
            ]
        );
    }

    #[test]
    fn json_holds_what_was_measured() {
        let mut measurement = measurement();
        measurement.rows[2].outcome = Outcome::Wrong("how".into());
        measurement.rows[3].outcome = Outcome::Absent("why".into());
        let value = measurement_json(&measurement);
        assert_eq!((&value["set"], &value["queries"]), (&json!("box"), &json!(1000)));
        let modes = value["modes"].as_array().expect("modes");
        let ns = modes[0]["ns_per_query"].as_f64().expect("a time");
        assert!((ns - 200.0).abs() < 1e-6, "{ns}");
        assert_eq!((&modes[0]["rounds"], &modes[0]["differing"]), (&json!(3), &json!(0)));
        assert_eq!(modes[2], json!({ "peer": "parry3d", "mode": "trimesh", "wrong": "how" }));
        assert_eq!(modes[3], json!({ "peer": "parry3d", "mode": "ploc", "absent": "why" }));
    }
}
