//! A run of `query` as Markdown, made from its JSON.

use std::fmt::Write;

use serde_json::Value;

use super::sets::QueryKind;
use crate::table::{count, list, measured_on, nanoseconds};

/// A line of the summary for each scene: its label, the peer, and which of the peer's modes count.
const LINES: &[(&str, &str, Option<&str>)] = &[
    ("Raywood, one by one", "raywood", Some("single")),
    ("Raywood, batch", "raywood", Some("batch")),
    ("parry3d, best", "parry3d", None),
];

/// A line for the ratio to each of Raywood's modes.
const RATIOS: &[(&str, &str)] =
    &[("**parry3d / Raywood, one by one**", "single"), ("**parry3d / Raywood, batch**", "batch")];

/// The summary: what it was measured on, and a table for each number of threads.
///
/// # Errors
///
/// The JSON is not that of a run.
pub(crate) fn markdown(run: &Value) -> Result<String, String> {
    let (scenes, measurements, ratios) =
        (list(run, "scenes")?, list(run, "measurements")?, list(run, "ratios")?);
    let mut out = measured_on(run);
    let _ = writeln!(
        out,
        "; {} rounds of {} points or rays. Nanoseconds per query, smaller is better; ratios above 1 mean that Raywood is faster.",
        run["settings"]["rounds"], run["settings"]["queries"],
    );
    let mut threads: Vec<_> = measurements.iter().filter_map(|m| m["threads"].as_u64()).collect();
    threads.sort_unstable();
    threads.dedup();
    let sets: Vec<_> = QueryKind::ALL
        .iter()
        .map(|set| set.name())
        .filter(|name| measurements.iter().any(|m| m["set"] == *name))
        .collect();

    for threads in threads {
        let plural = if threads == 1 { "" } else { "s" };
        let _ = writeln!(out, "\n### Queries, {threads} thread{plural}\n");
        let _ = writeln!(out, "| scene | | {} |", sets.join(" | "));
        let _ = writeln!(out, "| --- | --- |{}", " ---: |".repeat(sets.len()));
        for scene in scenes {
            let name = scene["name"].as_str().unwrap_or("?");
            let mut label = format!("{name} ({})", count(&scene["triangles"]));
            let mut line = |name: &str, cells: Vec<Option<String>>| {
                if cells.iter().any(Option::is_some) {
                    let cells: Vec<_> = cells.into_iter().map(Option::unwrap_or_default).collect();
                    let _ = writeln!(out, "| {label} | {name} | {} |", cells.join(" | "));
                    label.clear();
                }
            };
            let of = |value: &Value, set: &str| {
                value["scene"] == scene["name"]
                    && value["set"] == set
                    && value["threads"] == threads
            };
            for (name, peer, chosen) in LINES {
                let best = |set: &&str| {
                    let measurement = measurements.iter().find(|m| of(m, set))?;
                    let modes = measurement["modes"].as_array()?.iter();
                    modes
                        .filter(|mode| mode["peer"] == *peer)
                        .filter(|mode| chosen.is_none_or(|chosen| mode["mode"] == chosen))
                        .filter_map(|mode| mode["ns_per_query"].as_f64())
                        .min_by(f64::total_cmp)
                        .map(nanoseconds)
                };
                line(name, sets.iter().map(best).collect());
            }
            for (name, mode) in RATIOS {
                let ratio = |set: &&str| {
                    let chosen =
                        ratios.iter().find(|r| of(r, set) && r["raywood_mode"] == *mode)?;
                    Some(format!("**{:.2}**", chosen["ratio"].as_f64()?))
                };
                line(name, sets.iter().map(ratio).collect());
            }
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::query::ratios;
    use crate::query::report::{measurement_json, tests::measurement};

    #[test]
    fn the_summary_has_every_mode_of_ours_and_the_best_of_parry() {
        let measurement = measurement();
        let run = json!({
            "date": "2026-11-24T05:00:00Z",
            "machine": { "cpu": "A CPU", "cores": 2, "compiled_for": ["sse2"] },
            "settings": { "rounds": 3, "queries": 1000 },
            "scenes": [{ "name": "hall", "triangles": 1_000_000 }],
            "measurements": [measurement_json(&measurement)],
            "ratios": ratios::ratios(&measurement).iter().map(|r| r.json()).collect::<Vec<_>>(),
        });
        let summary = markdown(&run).expect("a run");
        let lines: Vec<_> = summary.lines().collect();
        assert_eq!(
            lines[2..],
            [
                "### Queries, 2 threads",
                "",
                "| scene | | box |",
                "| --- | --- | ---: |",
                "| hall (1.0M) | Raywood, one by one | 200 |",
                "|  | Raywood, batch | 100 |",
                "|  | parry3d, best | 300 |",
                "|  | **parry3d / Raywood, one by one** | **1.50** |",
                "|  | **parry3d / Raywood, batch** | **3.00** |",
            ]
        );
        assert!(markdown(&json!({ "scenes": [] })).is_err());
    }
}
