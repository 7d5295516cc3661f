//! The summary of a run as Markdown, made from its JSON.

use std::fmt::Write;

use serde_json::Value;

use crate::ray_sets::SetKind;

/// What stands before and after a summary in a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marks {
    /// Of a run of `trace`.
    Traces,
    /// Of a run of `build`.
    Builds,
    /// Of a run of `query`.
    Queries,
}

impl Marks {
    /// The lines between which the summary is.
    fn lines(self) -> [&'static str; 2] {
        match self {
            Self::Traces => [
                "<!-- made by `raywood-bench table`: begin -->",
                "<!-- made by `raywood-bench table`: end -->",
            ],
            Self::Builds => [
                "<!-- made by `raywood-bench table` of builds: begin -->",
                "<!-- made by `raywood-bench table` of builds: end -->",
            ],
            Self::Queries => [
                "<!-- made by `raywood-bench table` of queries: begin -->",
                "<!-- made by `raywood-bench table` of queries: end -->",
            ],
        }
    }
}

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
    let text = |value: &Value| value.as_str().unwrap_or("?").to_owned();
    let mut out = measured_on(run);
    let _ = writeln!(
        out,
        "; {} rounds of at most {} rays. Nanoseconds per ray, smaller is better; ratios above 1 mean that Raywood is faster.",
        run["settings"]["rounds"], run["settings"]["rays"],
    );
    let mut threads: Vec<_> = measurements.iter().filter_map(|m| m["threads"].as_u64()).collect();
    threads.sort_unstable();
    threads.dedup();
    let sets: Vec<_> = SetKind::ALL
        .iter()
        .map(|set| set.name())
        .filter(|name| measurements.iter().any(|m| m["set"] == *name))
        .collect();

    for threads in threads {
        let plural = if threads == 1 { "" } else { "s" };
        let _ =
            write!(out, "\n### {threads} thread{plural}\n\n| scene | | {} |\n", sets.join(" | "));
        let _ = writeln!(out, "| --- | --- |{}", " ---: |".repeat(sets.len()));
        for scene in scenes {
            let mut label = format!("{} ({})", text(&scene["name"]), count(&scene["triangles"]));
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
            for (name, peer, watertight) in LINES {
                let best = |set: &&str| {
                    let measurement = measurements.iter().find(|m| of(m, set))?;
                    let modes = measurement["modes"].as_array()?.iter();
                    modes
                        .filter(|mode| mode["peer"] == *peer)
                        .filter(|mode| watertight.is_none_or(|w| mode["watertight"] == w))
                        .filter_map(|mode| mode["ns_per_ray"].as_f64())
                        .min_by(f64::total_cmp)
                        .map(nanoseconds)
                };
                line(name, sets.iter().map(best).collect());
            }
            for (name, against) in [
                ("**Embree robust / Raywood watertight**", "robust"),
                ("**Embree best / Raywood**", "best"),
            ] {
                let ratio = |set: &&str| {
                    let chosen = ratios.iter().find(|r| of(r, set) && r["against"] == against)?;
                    Some(format!("**{:.2}**", chosen["ratio"].as_f64()?))
                };
                line(name, sets.iter().map(ratio).collect());
            }
        }
    }
    if ratios.iter().any(|ratio| ratio["unequal"] == true) {
        out.push_str(
            "\nThere is no fast mode of Raywood yet: where \"Embree best\" is not a robust mode, its time is held against Raywood's \
             watertight one.\n",
        );
    }
    Ok(out)
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

/// The page with what stands between its marks replaced.
///
/// # Errors
///
/// The page does not have these lines, in this order.
pub(crate) fn replace(page: &str, marks: Marks, summary: &str) -> Result<String, String> {
    let [begin, end] = marks.lines();
    let parts = page
        .split_once(begin)
        .and_then(|(before, rest)| rest.split_once(end).map(|(_, after)| (before, after)));
    let (before, after) =
        parts.ok_or_else(|| format!("expected the lines `{begin}` and `{end}`"))?;
    Ok(format!("{before}{begin}\n\n{summary}\n{end}{after}"))
}

/// A time with three digits or one decimal.
pub(crate) fn nanoseconds(ns: f64) -> String {
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
    use std::path::Path;

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

    #[test]
    fn pages_keep_what_is_around_the_summary() {
        let [begin, end] = Marks::Builds.lines();
        let page = format!("a\n{begin}\nold\n{end}\nb\n");
        assert_eq!(
            replace(&page, Marks::Builds, "new\n").as_deref(),
            Ok(&*format!("a\n{begin}\n\nnew\n\n{end}\nb\n"))
        );
        assert!(replace(&page, Marks::Traces, "new").is_err());
    }

    /// The page's tables are those that its recorded runs make, and so is the picture.
    #[test]
    fn the_readme_shows_recorded_runs() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let page = std::fs::read_to_string(folder.join("README.md")).expect("a README");
        let run = |mark: &str| -> (String, Value) {
            let link = |line: &str| Some(line.strip_prefix(mark)?.split('`').next()?.to_owned());
            let name = page.lines().find_map(link).expect(mark);
            let json = std::fs::read_to_string(folder.join(&name)).expect("the recorded run");
            (name, serde_json::from_str(&json).expect("JSON"))
        };
        let shown = |name: &str, marks, summary: &str| {
            let expected = replace(&page, marks, summary).expect("marks");
            assert!(page == expected, "raywood-bench table bench/{name} --into bench/README.md");
        };
        let (name, traces) = run("Recorded run: [`");
        shown(&name, Marks::Traces, &markdown(&traces).expect("a run"));
        let (name, queries) = run("Recorded run of queries: [`");
        shown(&name, Marks::Queries, &crate::query::table::markdown(&queries).expect("a run"));
        let (name, builds) = run("Recorded run of builds: [`");
        shown(&name, Marks::Builds, &crate::build::table::markdown(&builds).expect("a run"));
        let picture =
            std::fs::read_to_string(folder.join("results/builds.svg")).expect("a picture");
        let expected = crate::build::pareto::svg(&builds).expect("a run");
        assert!(picture == expected, "raywood-bench plot bench/{name} -o bench/results/builds.svg");
    }
}
