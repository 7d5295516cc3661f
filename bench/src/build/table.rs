//! A run of `build` as Markdown, made from its JSON.

use std::fmt::Write;

use serde_json::Value;

use super::pareto::tracing_time;
use crate::table::{count, list, measured_on};

/// A table for each number of threads, and the ratios.
///
/// # Errors
///
/// The JSON is not that of a run.
pub(crate) fn markdown(run: &Value) -> Result<String, String> {
    let (scenes, builds, ratios) =
        (list(run, "scenes")?, list(run, "builds")?, list(run, "ratios")?);
    let mut out = measured_on(run);
    let _ = writeln!(out, "; {} rounds, fewer of slow builds.", run["settings"]["rounds"]);
    let traced = builds.iter().any(|build| tracing_time(build).is_some());
    let mut threads: Vec<_> = builds.iter().filter_map(|build| build["threads"].as_u64()).collect();
    threads.sort_unstable();
    threads.dedup();
    for threads in threads {
        let plural = if threads == 1 { "" } else { "s" };
        let _ = writeln!(out, "\n### Builds, {threads} thread{plural}\n");
        out.push_str(
            "| scene | | warm ms | cold ms | M triangles/s | bytes a triangle | peak | `Q` |",
        );
        out.push_str(if traced { " ns a ray |\n" } else { "\n" });
        out.push_str("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |");
        out.push_str(if traced { " ---: |\n" } else { "\n" });
        for scene in scenes {
            let name = scene["name"].as_str().unwrap_or("?");
            let mut label = format!("{name} ({})", count(&scene["triangles"]));
            let of_scene =
                |value: &&Value| value["scene"] == scene["name"] && value["threads"] == threads;
            let triangles = scene["triangles"].as_f64().unwrap_or(f64::NAN);
            for build in builds.iter().filter(of_scene) {
                let Some(warm) = build["warm_ms"].as_f64() else { continue };
                let _ = write!(
                    out,
                    "| {label} | {} `{}` | {} | {} | {} | {} | {} | {} |",
                    build["peer"].as_str().unwrap_or("?"),
                    build["preset"].as_str().unwrap_or("?"),
                    short(Some(warm)),
                    short(build["cold_ms"].as_f64()),
                    short(build["million_triangles_per_second"].as_f64()),
                    short(build["bytes_per_triangle"].as_f64()),
                    short(build["peak_bytes"].as_f64().map(|bytes| bytes / triangles)),
                    short(build["q"].as_f64()),
                );
                if traced {
                    let _ = write!(out, " {} |", short(tracing_time(build)));
                }
                out.push('\n');
                label.clear();
            }
        }
        let pairs = ratios.iter().filter(|ratio| ratio["threads"] == threads);
        let pairs: Vec<_> = pairs.collect();
        if !pairs.is_empty() {
            out.push_str("\n| scene | Raywood | Embree | ms | ms | Embree / Raywood |\n");
            out.push_str("| --- | --- | --- | ---: | ---: | ---: |\n");
        }
        for ratio in pairs {
            let text = |key: &str| ratio[key].as_str().unwrap_or("?");
            let _ = writeln!(
                out,
                "| {} | `{}` | {} | {} | {} | **{:.2}** |",
                text("scene"),
                text("preset"),
                text("embree_quality"),
                short(ratio["raywood_ms"].as_f64()),
                short(ratio["embree_ms"].as_f64()),
                ratio["ratio"].as_f64().unwrap_or(f64::NAN),
            );
        }
    }
    Ok(out)
}

/// A number with three digits; nothing if there is none.
fn short(number: Option<f64>) -> String {
    match number {
        Some(number) if number < 9.995 => format!("{number:.2}"),
        Some(number) if number < 99.95 => format!("{number:.1}"),
        Some(number) => format!("{number:.0}"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn every_build_with_a_time_has_a_line() {
        let run = json!({
            "date": "2026-11-24T05:00:00Z",
            "machine": { "cpu": "A CPU", "cores": 2, "compiled_for": ["sse2"] },
            "embree": null,
            "settings": { "rounds": 3, "rays": 1000 },
            "scenes": [{ "name": "hall", "triangles": 1_000_000 }],
            "builds": [
                { "scene": "hall", "threads": 2, "peer": "raywood", "preset": "fast", "warm_ms": 100.0, "cold_ms": 120.0,
                  "million_triangles_per_second": 10.0, "bytes_per_triangle": 64.0, "peak_bytes": 96_000_000, "q": 40.0,
                  "traces": [{ "set": "primary", "ns_per_ray": 20.0 }, { "set": "diffuse", "ns_per_ray": 80.0 }] },
                { "scene": "hall", "threads": 2, "peer": "bvh", "preset": "build_par", "wrong": "why" },
            ],
            "ratios": [
                { "scene": "hall", "threads": 2, "preset": "fast", "embree_quality": "LOW", "raywood_ms": 100.0,
                  "embree_ms": 50.0, "ratio": 0.5 },
            ],
        });
        let markdown = markdown(&run).expect("a run");
        let lines: Vec<_> = markdown.lines().filter(|line| line.contains("hall")).collect();
        assert_eq!(
            lines,
            [
                "| hall (1.0M) | raywood `fast` | 100 | 120 | 10.0 | 64.0 | 96.0 | 40.0 | 40.0 |",
                "| hall | `fast` | LOW | 100 | 50.0 | **0.50** |",
            ]
        );
        assert!(!markdown.contains("build_par"), "{markdown}");
        assert!(super::markdown(&json!({ "scenes": [] })).is_err());
    }
}
