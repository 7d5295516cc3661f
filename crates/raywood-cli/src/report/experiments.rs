//! Experiments as a page, as text and as JSON.

use maud::{Markup, html};
use raywood_lab::figures::{Cell, Chart, Line, Table};
use raywood_lab::lecture::{Experiment, Judgement};
use serde_json::{Value, json};

use super::{charts, page};
use crate::failure::Failure;
use crate::print::wrapped;

/// What pages of experiments need beside the common style.
const STYLE: &str = include_str!("experiments.css");

/// What was run, for the head of the page and of the JSON.
pub(crate) struct Run<'a> {
    /// The scenes' names.
    pub(crate) scenes: &'a [String],
    /// The most threads that were used.
    pub(crate) threads: usize,
    /// Whether little was measured.
    pub(crate) quick: bool,
    /// How long it all took.
    pub(crate) seconds: f64,
}

/// A page with all experiments.
pub(crate) fn as_html(run: &Run<'_>, experiments: &[Experiment]) -> Result<String, Failure> {
    let mut facts = vec![
        ("Scenes", run.scenes.join(", ")),
        ("Threads", run.threads.to_string()),
        ("Platform", format!("{} on {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("Raywood", env!("CARGO_PKG_VERSION").to_owned()),
        ("Time taken", format!("{:.0} s", run.seconds)),
    ];
    if run.quick {
        facts.push(("Mode", "quick: small scenes and few rays, to see that it works".to_owned()));
    }
    let sections = experiments.iter().map(section).collect::<Result<Vec<_>, _>>()?;
    let body = html! {
        p.lead {
            "The claims of the well-known lecture on accelerating ray tracing, measured on this machine. Each verdict follows from the numbers \
             below it."
        }
        (page::facts(&facts))
        ol.contents {
            @for experiment in experiments {
                li {
                    a href={ "#" (experiment.id) } { (experiment.title) }
                    span.judgement.(tone(experiment.verdict.judgement)) { (mark(experiment)) }
                }
            }
        }
        @for section in &sections { (section) }
        footer {
            p {
                "Repeat it with " code { "raywood lecture --html FILE" } ". Times are medians of rounds in which all contestants take turns; counts \
                 are exact and the same on every machine."
            }
        }
    };
    Ok(page::html("The lecture, measured", STYLE, &body))
}

fn section(experiment: &Experiment) -> Result<Markup, Failure> {
    let Experiment { id, title, claim, method, tables, charts, verdict } = experiment;
    let charts = charts.iter().map(charts::figure).collect::<Result<Vec<_>, _>>()?;
    Ok(html! {
        section id=(id) {
            h2 { (title) }
            p.claim { strong { "Claim. " } (claim) }
            div.verdict.keep.(tone(verdict.judgement)) {
                span.judgement { (mark(experiment)) }
                p { (verdict.explanation) }
            }
            p.method { strong { "Method. " } (method) }
            @for chart in &charts { (chart) }
            @for table in tables { (page::table(table)) }
        }
    })
}

/// The judgement in words, with a sign that needs no colour.
fn mark(experiment: &Experiment) -> String {
    let judgement = experiment.verdict.judgement;
    let sign = match judgement {
        Judgement::Holds => "\u{2713}",
        Judgement::HoldsInPart => "\u{2248}",
        Judgement::Fails => "\u{2717}",
        Judgement::NotMeasured => "?",
    };
    format!("{sign} {}", judgement.name())
}

fn tone(judgement: Judgement) -> &'static str {
    match judgement {
        Judgement::Holds => "holds",
        Judgement::HoldsInPart => "part",
        Judgement::Fails => "fails",
        Judgement::NotMeasured => "none",
    }
}

/// Titles and verdicts for a terminal.
pub(crate) fn as_text(experiments: &[Experiment]) -> String {
    let mut text = String::new();
    for Experiment { id, title, verdict, .. } in experiments {
        let judgement = verdict.judgement.name().to_uppercase();
        text += &format!("{id}: {title}: {judgement}\n");
        for line in wrapped(&verdict.explanation, 76) {
            text += &format!("    {line}\n");
        }
    }
    text
}

/// Everything for machines.
pub(crate) fn as_json(run: &Run<'_>, experiments: &[Experiment]) -> Value {
    json!({
        "scenes": run.scenes,
        "threads": run.threads,
        "quick": run.quick,
        "seconds": run.seconds,
        "experiments": experiments.iter().map(|experiment| json!({
            "id": experiment.id,
            "title": experiment.title,
            "claim": experiment.claim,
            "method": experiment.method,
            "judgement": experiment.verdict.judgement.name(),
            "explanation": experiment.verdict.explanation,
            "tables": experiment.tables.iter().map(table).collect::<Vec<_>>(),
            "charts": experiment.charts.iter().map(chart).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
    })
}

fn table(table: &Table) -> Value {
    let row = |row: &Vec<Cell>| row.iter().map(cell).collect::<Vec<_>>();
    json!({
        "caption": table.caption,
        "columns": table.columns,
        "rows": table.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

/// The value as it was measured, not as it is shown.
fn cell(cell: &Cell) -> Value {
    match cell {
        Cell::Text(text) => json!(text),
        Cell::Count(count) => json!(count),
        Cell::Number(value, _) | Cell::Share(value) | Cell::Spread(value, ..) => json!(value),
        Cell::Nothing => Value::Null,
    }
}

fn chart(chart: &Chart) -> Value {
    match chart {
        Chart::Plot(plot) => json!({
            "kind": "plot",
            "title": plot.title,
            "x": plot.x.label,
            "y": plot.y.label,
            "series": plot.series.iter().map(|series| json!({
                "name": series.name, "points": series.points, "measured": series.line == Line::Measured,
            })).collect::<Vec<_>>(),
        }),
        Chart::Bars(bars) => json!({
            "kind": "bars",
            "title": bars.title,
            "value": bars.value.label,
            "categories": bars.categories,
            "series": bars.series.iter().map(|series| json!({
                "name": series.name, "values": series.values,
            })).collect::<Vec<_>>(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use raywood_lab::lecture::Verdict;
    use raywood_testkit::html::{check_well_formed, is_self_contained};

    use super::*;

    fn experiment(judgement: Judgement) -> Experiment {
        let mut values = Table::new("values & more", &["name", "value"]);
        values.rows.push(vec![Cell::text("<a>"), Cell::Number(f64::NAN, 1)]);
        Experiment {
            id: "growth",
            title: "a < b",
            claim: "1 & 2",
            method: "so".to_owned(),
            tables: vec![values],
            charts: Vec::new(),
            verdict: Verdict { judgement, explanation: "because 2 > 1 ".repeat(20) },
        }
    }

    #[test]
    fn every_judgement_is_shown_on_a_sound_page() {
        let scenes = ["<scene>".to_owned()];
        let run = Run { scenes: &scenes, threads: 2, quick: true, seconds: 1.0 };
        let judgements =
            [Judgement::Holds, Judgement::HoldsInPart, Judgement::Fails, Judgement::NotMeasured];
        let experiments = judgements.map(experiment);
        let page = as_html(&run, &experiments).expect("a page");
        assert_eq!(check_well_formed(&page), Ok(()));
        assert!(is_self_contained(&page));
        let text = as_text(&experiments);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        for judgement in judgements {
            assert!(page.contains(judgement.name()), "{}", judgement.name());
            assert!(text.contains(&judgement.name().to_uppercase()), "{}", judgement.name());
        }
        // What is no number is null.
        assert_eq!(
            as_json(&run, &experiments)["experiments"][0]["tables"][0]["rows"][0][1],
            Value::Null
        );
    }
}
