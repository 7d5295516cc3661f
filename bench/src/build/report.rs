//! What building took, for people, as a table on the terminal, and for programs, as JSON.

use std::fmt::Write;

use raywood_lab::Timing;
use serde_json::{Value, json};

use super::ratios::ratios;
use super::turns::{Outcome, Row, Times, Trace};
use crate::ray_sets::SetKind;

/// Where and on how many threads rows were measured.
pub(crate) struct Place<'a> {
    pub(crate) scene: &'a str,
    pub(crate) triangles: usize,
    pub(crate) threads: usize,
}

/// The best time of any mode for a set, in nanoseconds per ray.
fn best(times: &Times, set: SetKind) -> Option<f64> {
    let of_set = times.traces.iter().filter(|trace| trace.set == set);
    of_set.filter_map(Trace::ns_per_ray).min_by(f64::total_cmp)
}

/// The table of one scene on so many threads.
pub(crate) fn text(place: &Place<'_>, rows: &[Row]) -> String {
    let Place { scene, triangles, threads } = place;
    let plural = if *threads == 1 { "" } else { "s" };
    let traced = |set: &&SetKind| {
        rows.iter().any(|row| match &row.outcome {
            Outcome::Timed(times) => best(times, **set).is_some(),
            _ => false,
        })
    };
    let sets: Vec<_> = SetKind::ALL.iter().filter(traced).collect();
    let mut text = format!("\n{scene}, {threads} thread{plural}: {triangles} triangles");
    text.push_str("; M/s: million triangles a second, B: bytes a triangle");
    text.push_str(if sets.is_empty() { "\n" } else { "; then ns per ray\n" });
    let _ = write!(
        text,
        "  {:<24}{:>10}      {:>10}      {:>6} {:>7} {:>7} {:>6}",
        "", "warm ms", "cold ms", "M/s", "B", "peak B", "Q"
    );
    for set in &sets {
        let _ = write!(text, "{:>9}", set.name());
    }
    text.push('\n');
    for Row { peer, preset, outcome } in rows {
        let _ = write!(text, "  {:<24}", format!("{peer} {preset}"));
        match outcome {
            Outcome::Timed(times) => {
                let Times { warm, cold, cost, .. } = times;
                let per_triangle = |bytes: usize| bytes as f64 / *triangles as f64;
                let q = cost.q.map_or(String::new(), |q| format!("{q:.1}"));
                let _ = write!(
                    text,
                    "{} {} {:>6.2} {:>7.1} {:>7.1} {q:>6}",
                    milliseconds(warm),
                    milliseconds(cold),
                    *triangles as f64 / warm.median() / 1e6,
                    per_triangle(cost.memory.bytes),
                    per_triangle(cost.memory.peak_bytes),
                );
                for set in &sets {
                    let ns = best(times, **set).map_or(String::new(), |ns| format!("{ns:.1}"));
                    let _ = write!(text, "{ns:>9}");
                }
            }
            Outcome::Wrong(how) => text.push_str(&format!("  wrong: {how}")),
            Outcome::Absent(why) => text.push_str(&format!("  {why}")),
        }
        text.push('\n');
    }
    for ratio in ratios(rows) {
        let _ = writeln!(
            text,
            "  embree {} / raywood {}: {:.2}",
            ratio.quality,
            ratio.preset,
            ratio.ratio()
        );
    }
    text
}

/// A time with its spread.
fn milliseconds(timing: &Timing) -> String {
    let spread = match timing.rounds() {
        1 => " once".to_owned(),
        _ => format!(" ±{:>2.0}%", 100.0 * timing.spread()),
    };
    format!("{:>10.1}{spread}", 1e3 * timing.median())
}

/// One row as JSON.
pub(crate) fn json(place: &Place<'_>, row: &Row) -> Value {
    let Place { scene, triangles, threads } = place;
    let mut value = json!({
        "scene": scene, "threads": threads, "peer": row.peer, "preset": row.preset,
    });
    match &row.outcome {
        Outcome::Timed(Times { warm, cold, cost, traces }) => {
            value["warm_ms"] = json!(1e3 * warm.median());
            value["warm_spread"] = json!(warm.spread());
            value["cold_ms"] = json!(1e3 * cold.median());
            value["cold_spread"] = json!(cold.spread());
            value["rounds"] = json!(warm.rounds());
            value["million_triangles_per_second"] = json!(*triangles as f64 / warm.median() / 1e6);
            value["bytes"] = json!(cost.memory.bytes);
            value["bytes_per_triangle"] = json!(cost.memory.bytes as f64 / *triangles as f64);
            value["peak_bytes"] = json!(cost.memory.peak_bytes);
            value["q"] = json!(cost.q);
            value["traces"] = traces.iter().map(trace_json).collect();
        }
        Outcome::Wrong(how) => value["wrong"] = json!(how),
        Outcome::Absent(why) => value["absent"] = json!(why),
    }
    value
}

fn trace_json(trace: &Trace) -> Value {
    let Trace { set, rays, mode, watertight, outcome } = trace;
    let mut value = json!({
        "set": set.name(), "rays": rays, "mode": mode, "watertight": watertight,
    });
    match outcome {
        Ok((timing, agreement)) => {
            value["ns_per_ray"] = json!(trace.ns_per_ray());
            value["spread"] = json!(timing.spread());
            value["hits"] = json!(agreement.hits);
            value["mismatches"] = json!(agreement.mismatches);
            value["far_off"] = json!(agreement.far_off);
        }
        Err(how) => value["wrong"] = json!(how),
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::Agreement;
    use crate::memory::Memory;
    use crate::peers::builds::Cost;

    fn rows() -> Vec<Row> {
        let trace = |mode, ns: f64| Trace {
            set: SetKind::Mirror,
            rays: 1000,
            mode,
            watertight: true,
            outcome: Ok((Timing::new(vec![1e-6 * ns]), Agreement::default())),
        };
        let times = Times {
            warm: Timing::new(vec![0.5, 0.5, 0.5]),
            cold: Timing::new(vec![0.75]),
            cost: Cost {
                seconds: 0.5,
                memory: Memory { bytes: 64_000, peak_bytes: 80_000 },
                q: Some(32.5),
            },
            traces: vec![trace("a", 150.0), trace("b", 125.0)],
        };
        let row = |preset, outcome| Row { peer: "raywood", preset, outcome };
        vec![
            row("fast", Outcome::Timed(times)),
            row("high", Outcome::Wrong("4 differ".into())),
            row("best", Outcome::Absent("not there".into())),
        ]
    }

    const PLACE: Place<'_> = Place { scene: "hall", triangles: 1000, threads: 2 };

    #[test]
    fn text_has_times_only_of_who_is_right() {
        let text = text(&PLACE, &rows());
        let lines: Vec<_> =
            text.lines().map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(
            lines[2..],
            [
                "warm ms cold ms M/s B peak B Q mirror",
                "raywood fast 500.0 ± 0% 750.0 once 0.00 64.0 80.0 32.5 125.0",
                "raywood high wrong: 4 differ",
                "raywood best not there",
            ]
        );
    }

    #[test]
    fn json_holds_what_was_measured() {
        let [fast, high, best] = [0, 1, 2].map(|number| json(&PLACE, &rows()[number]));
        assert_eq!((&fast["warm_ms"], &fast["cold_ms"]), (&json!(500.0), &json!(750.0)));
        assert_eq!((&fast["bytes_per_triangle"], &fast["q"]), (&json!(64.0), &json!(32.5)));
        assert_eq!((&fast["traces"][1]["mode"], &fast["rounds"]), (&json!("b"), &json!(3)));
        assert_eq!(high["wrong"], "4 differ");
        assert_eq!((&best["absent"], &best["warm_ms"]), (&json!("not there"), &Value::Null));
    }
}
