//! Measurements for people, as a table on the terminal, and for programs, as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::measure::{Measurement, Row};
use crate::outcome::{Outcome, nanoseconds};
use crate::ratios::{Against, ratios};

/// The table of one measurement.
pub(crate) fn text(measurement: &Measurement) -> String {
    let Measurement { scene, set, threads, rays, hits, rows } = measurement;
    let share = 100.0 * *hits as f64 / (*rays).max(1) as f64;
    let plural = if *threads == 1 { "" } else { "s" };
    let set = set.name();
    let mut text = format!(
        "\n{scene}, {set}: {rays} rays, {share:.1}% hit; {threads} thread{plural}, ns per ray\n"
    );
    for row in rows {
        text.push_str(&line(&format!("{} {}", row.peer, row.mode), &row.outcome, *rays));
    }
    for ratio in ratios(measurement) {
        let mode = if ratio.watertight { "watertight" } else { "fast" };
        let best = match ratio.against {
            Against::Robust => "embree's best robust mode",
            Against::Best => "embree's best mode",
        };
        let _ = writeln!(
            text,
            "  {best} ({}) / raywood's best {mode} mode ({}): {:.2}",
            ratio.embree_mode,
            ratio.raywood_kernel,
            ratio.ratio()
        );
    }
    text
}

/// The line of one mode, with its time for each of so many questions.
pub(crate) fn line<A>(name: &str, outcome: &Outcome<A>, questions: usize) -> String {
    match outcome {
        Outcome::Timed { timing, .. } => {
            let spread = match timing.rounds() {
                1 => "once".to_owned(),
                _ => format!("±{:>3.0}%", 100.0 * timing.spread()),
            };
            let ns = nanoseconds(timing, questions);
            format!("  {name:<28} {ns:>8.1} {spread}\n")
        }
        Outcome::Wrong(how) => format!("  {name:<28}    wrong: {how}\n"),
        Outcome::Absent(why) => format!("  {name:<28} {why}\n"),
    }
}

/// One measurement as JSON.
pub(crate) fn measurement_json(measurement: &Measurement) -> Value {
    json!({
        "scene": measurement.scene,
        "set": measurement.set.name(),
        "threads": measurement.threads,
        "rays": measurement.rays,
        "hits": measurement.hits,
        "modes": measurement.rows.iter().map(|row| row_json(measurement, row)).collect::<Vec<_>>(),
    })
}

fn row_json(measurement: &Measurement, row: &Row) -> Value {
    let mut value = json!({ "peer": row.peer, "mode": row.mode, "watertight": row.watertight });
    match &row.outcome {
        Outcome::Timed { timing, agreement } => {
            value["ns_per_ray"] = json!(measurement.ns_per_ray(row));
            value["spread"] = json!(timing.spread());
            value["rounds"] = json!(timing.rounds());
            value["hits"] = json!(agreement.hits);
            value["mismatches"] = json!(agreement.mismatches);
            value["far_off"] = json!(agreement.far_off);
        }
        Outcome::Wrong(how) => value["wrong"] = json!(how),
        Outcome::Absent(why) => value["absent"] = json!(why),
    }
    value
}

#[cfg(test)]
mod tests {
    use raywood_lab::Timing;

    use super::*;
    use crate::answers::Agreement;
    use crate::peers::{EMBREE, RAYWOOD};
    use crate::ray_sets::SetKind;

    fn measurement() -> Measurement {
        let agreement = Agreement { rays: 1000, hits: 899, mismatches: 1, ..Agreement::default() };
        let timing = Timing::new(vec![4e-5, 5e-5, 6e-5]);
        let row = |peer, mode, outcome| Row { peer, mode, watertight: true, outcome };
        let timed = || Outcome::Timed { timing: timing.clone(), agreement };
        Measurement {
            scene: "hall".into(),
            set: SetKind::AmbientOcclusion,
            threads: 1,
            rays: 1000,
            hits: 900,
            rows: vec![
                row(RAYWOOD, "batch", timed()),
                row(EMBREE, "16 robust", timed()),
                row(EMBREE, "1", Outcome::Wrong("4 differ".into())),
                row("bvh", "", Outcome::Absent("not asked for".into())),
            ],
        }
    }

    #[test]
    fn json_holds_what_was_measured() {
        let value = measurement_json(&measurement());
        let expected = json!({
            "scene": "hall", "set": "ao", "threads": 1, "rays": 1000, "hits": 900,
            "modes": [
                { "peer": "raywood", "mode": "batch", "watertight": true, "ns_per_ray": 50.0,
                  "spread": 0.1, "rounds": 3, "hits": 899, "mismatches": 1, "far_off": 0 },
                { "peer": "embree", "mode": "16 robust", "watertight": true, "ns_per_ray": 50.0,
                  "spread": 0.1, "rounds": 3, "hits": 899, "mismatches": 1, "far_off": 0 },
                { "peer": "embree", "mode": "1", "watertight": true, "wrong": "4 differ" },
                { "peer": "bvh", "mode": "", "watertight": true, "absent": "not asked for" },
            ],
        });
        // Times are products of decimal fractions: nearly what is expected.
        let mut rounded = value;
        for mode in rounded["modes"].as_array_mut().expect("modes") {
            for key in ["ns_per_ray", "spread"] {
                if let Some(number) = mode.get(key).and_then(Value::as_f64) {
                    mode[key] = json!((1e9 * number).round() / 1e9);
                }
            }
        }
        assert_eq!(rounded, expected);
    }

    #[test]
    fn text_names_what_is_wrong_and_gives_it_no_time() {
        let text = text(&measurement());
        assert!(text.contains("hall, ao: 1000 rays, 90.0% hit; 1 thread, ns per ray"), "{text}");
        let line = |start: &str| {
            let found = text.lines().find(|line| line.trim_start().starts_with(start));
            found.unwrap_or_else(|| panic!("{start} in {text}"))
        };
        assert!(line("raywood batch").ends_with("50.0 ± 10%"), "{text}");
        assert!(line("embree 1 ").ends_with("wrong: 4 differ"), "{text}");
        assert!(line("embree's best robust mode").ends_with(": 1.00"), "{text}");
    }
}
