//! The summary of a run as Markdown, made from its JSON.

use std::fmt::Write;

use serde_json::Value;

use crate::ray_sets::SetKind;

/// A line of the summary for each scene: its label, the peer, and which of the peer's modes count.
const LINES: &[(&str, &str, Option<bool>)] = &[
    ("Raywood, watertight", "raywood", Some(true)),
    ("Raywood, fast", "raywood", Some(false)),
    ("Embree, best of all modes", "embree", None),
    ("Embree, best robust mode", "embree", Some(true)),
    ("obvhs, best", "obvhs", None),
    ("parry3d, best", "parry3d", None),
    ("bvh, best", "bvh", None),
];

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
        "; {} rounds of at most {} rays. Nanoseconds per ray, smaller is better; ratios above 1 mean that Raywood is faster.",
        run["settings"]["rounds"], run["settings"]["rays"],
    );
    let sets: Vec<_> = SetKind::ALL.iter().map(|set| set.name()).collect();
    let peers = LINES.iter().map(|&(label, peer, watertight)| {
        let counts = move |mode: &Value| {
            mode["peer"] == peer && watertight.is_none_or(|w| mode["watertight"] == w)
        };
        Line::new(label, move |of| fastest(measurements, of, counts, "ns_per_ray"))
    });
    let against = [
        ("**Embree robust / Raywood watertight**", "robust"),
        ("**Embree best / Raywood**", "best"),
    ];
    let against = against.into_iter().map(|(label, against)| {
        Line::new(label, move |of| ratio(ratios, of, |ratio| ratio["against"] == against))
    });
    let lines: Vec<_> = peers.chain(against).collect();
    out.push_str(&tables("", scenes, measurements, &sets, &lines));
    if ratios.iter().any(|ratio| ratio["unequal"] == true) {
        out.push_str(
            "\nThere is no fast mode of Raywood yet: where \"Embree best\" is not a robust mode, its time is held against Raywood's \
             watertight one.\n",
        );
    }
    Ok(out)
}

/// Says whether a part of a run belongs to a cell of a table.
type Chosen<'a> = &'a dyn Fn(&Value) -> bool;

/// A line that tables have for each scene.
pub(crate) struct Line<'a> {
    label: &'static str,
    /// What stands in the cell that the parts so chosen belong to.
    cell: Box<dyn Fn(Chosen<'_>) -> Option<String> + 'a>,
}

impl<'a> Line<'a> {
    pub(crate) fn new(
        label: &'static str,
        cell: impl Fn(Chosen<'_>) -> Option<String> + 'a,
    ) -> Self {
        Self { label, cell: Box::new(cell) }
    }
}

/// A table for each number of threads, headed by them behind `title`: a column for each of the sets that were measured, and of each scene the lines that have anything in them.
pub(crate) fn tables(
    title: &str,
    scenes: &[Value],
    measurements: &[Value],
    sets: &[&str],
    lines: &[Line<'_>],
) -> String {
    let measured = |set: &&&str| measurements.iter().any(|m| m["set"] == **set);
    let sets: Vec<_> = sets.iter().filter(measured).copied().collect();
    let mut threads: Vec<_> = measurements.iter().filter_map(|m| m["threads"].as_u64()).collect();
    threads.sort_unstable();
    threads.dedup();
    let mut out = String::new();
    for threads in threads {
        let plural = if threads == 1 { "" } else { "s" };
        let _ = writeln!(out, "\n### {title}{threads} thread{plural}\n");
        let _ = writeln!(out, "| scene | | {} |", sets.join(" | "));
        let _ = writeln!(out, "| --- | --- |{}", " ---: |".repeat(sets.len()));
        for scene in scenes {
            let name = scene["name"].as_str().unwrap_or("?");
            let mut scene_label = format!("{name} ({})", count(&scene["triangles"]));
            for Line { label, cell } in lines {
                let of_set = |set: &&str| {
                    cell(&|part| {
                        part["scene"] == scene["name"]
                            && part["set"] == *set
                            && part["threads"] == threads
                    })
                };
                let cells: Vec<_> = sets.iter().map(of_set).collect();
                if cells.iter().any(Option::is_some) {
                    let cells: Vec<_> = cells.into_iter().map(Option::unwrap_or_default).collect();
                    let _ = writeln!(out, "| {scene_label} | {label} | {} |", cells.join(" | "));
                    scene_label.clear();
                }
            }
        }
    }
    out
}

/// The least time of those modes that count in the measurement of a cell.
pub(crate) fn fastest(
    measurements: &[Value],
    of: Chosen<'_>,
    counts: impl Fn(&Value) -> bool,
    time: &str,
) -> Option<String> {
    let measurement = measurements.iter().find(|m| of(m))?;
    let modes = measurement["modes"].as_array()?.iter().filter(|mode| counts(mode));
    modes.filter_map(|mode| mode[time].as_f64()).min_by(f64::total_cmp).map(nanoseconds)
}

/// The ratio of a cell that counts.
pub(crate) fn ratio(
    ratios: &[Value],
    of: Chosen<'_>,
    counts: impl Fn(&Value) -> bool,
) -> Option<String> {
    let ratio = ratios.iter().find(|ratio| of(ratio) && counts(ratio))?;
    Some(format!("**{:.2}**", ratio["ratio"].as_f64()?))
}

/// When and on what a run was made, and with which Embree if it takes part in such runs.
pub(crate) fn measured_on(run: &Value) -> String {
    let machine = &run["machine"];
    let cores = match machine["cores"].as_u64() {
        Some(1) => "1 core".to_owned(),
        _ => format!("{} cores", machine["cores"]),
    };
    let embree = run
        .get("embree")
        .map(|embree| format!("; Embree {}", embree["version"].as_str().unwrap_or("absent")));
    format!(
        "Measured on {} on {}, {cores}, compiled for {}{}",
        run["date"].as_str().unwrap_or("?").split('T').next().unwrap_or_default(),
        machine["cpu"].as_str().unwrap_or("?"),
        strings(&machine["compiled_for"]),
        embree.unwrap_or_default(),
    )
}

/// A list that every run has.
pub(crate) fn list<'a>(run: &'a Value, key: &str) -> Result<&'a [Value], String> {
    let list = run[key].as_array().map(Vec::as_slice);
    list.ok_or_else(|| format!("expected a list `{key}`: is this the JSON of a run?"))
}

/// A time with three digits or one decimal.
fn nanoseconds(ns: f64) -> String {
    if ns < 99.95 { format!("{ns:.1}") } else { format!("{ns:.0}") }
}

/// A number of triangles, short.
pub(crate) fn count(value: &Value) -> String {
    match value.as_u64() {
        Some(n) if n >= 999_500 => format!("{:.1}M", n as f64 / 1e6),
        Some(n) if n >= 1000 => format!("{:.0}k", n as f64 / 1e3),
        Some(n) => n.to_string(),
        None => "?".to_owned(),
    }
}

fn strings(value: &Value) -> String {
    let items = value.as_array().map(Vec::as_slice).unwrap_or_default();
    items.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn run() -> Value {
        json!({
            "date": "2026-11-23T19:00:00Z",
            "machine": { "cpu": "A CPU", "cores": 2, "compiled_for": ["sse2"] },
            "embree": { "version": "4.4.0" },
            "settings": { "rounds": 7, "rays": 1_024_000 },
            "scenes": [{ "name": "hall", "triangles": 1_000_000 }],
            "measurements": [{
                "scene": "hall", "set": "diffuse", "threads": 1,
                "modes": [
                    { "peer": "raywood", "mode": "batch", "watertight": true, "ns_per_ray": 123.4 },
                    { "peer": "raywood", "mode": "single", "watertight": true, "ns_per_ray": 99.0 },
                    { "peer": "embree", "mode": "1", "watertight": false, "wrong": "all" },
                    { "peer": "embree", "mode": "1 robust", "watertight": true, "ns_per_ray": 49.5 },
                ],
            }],
            "ratios": [
                { "scene": "hall", "set": "diffuse", "threads": 1, "against": "robust", "ratio": 0.5,
                  "unequal": false },
            ],
        })
    }

    #[test]
    fn the_summary_has_the_best_of_each() {
        let summary = markdown(&run()).expect("a run");
        let lines: Vec<_> = summary.lines().skip(2).collect();
        assert_eq!(
            lines,
            [
                "### 1 thread",
                "",
                "| scene | | diffuse |",
                "| --- | --- | ---: |",
                "| hall (1.0M) | Raywood, watertight | 99.0 |",
                "|  | Embree, best of all modes | 49.5 |",
                "|  | Embree, best robust mode | 49.5 |",
                "|  | **Embree robust / Raywood watertight** | **0.50** |",
            ]
        );
        assert!(markdown(&json!({ "scenes": [] })).is_err());
    }
}
