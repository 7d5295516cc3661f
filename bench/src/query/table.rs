//! A run of `query` as Markdown, made from its JSON.

use std::fmt::Write;

use serde_json::Value;

use super::sets::QueryKind;
use crate::table::{Line, fastest, list, measured_on, ratio, tables};

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
    let sets: Vec<_> = QueryKind::ALL.iter().map(|set| set.name()).collect();
    let peers = LINES.iter().map(|&(label, peer, chosen)| {
        let counts = move |mode: &Value| {
            mode["peer"] == peer && chosen.is_none_or(|chosen| mode["mode"] == chosen)
        };
        Line::new(label, move |of| fastest(measurements, of, counts, "ns_per_query"))
    });
    let against = RATIOS.iter().map(|&(label, mode)| {
        Line::new(label, move |of| ratio(ratios, of, |ratio| ratio["raywood_mode"] == mode))
    });
    let lines: Vec<_> = peers.chain(against).collect();
    out.push_str(&tables("Queries, ", scenes, measurements, &sets, &lines));
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
