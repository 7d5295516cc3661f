//! One page with everything: tables, bars, heat maps side by side.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};
use raywood::StructureKind;
use raywood_lab::figures::{Axis, BarChart, BarSeries, Cell, Chart, Plot, Series, Table};
use raywood_lab::{Comparison, StructureReport, Traces};

use super::Compared;
use super::contents::{notes, ray_sets, tables};
use crate::failure::Failure;
use crate::print::thousands;
use crate::report::{charts, page};

/// What this page needs beside the common style.
const STYLE: &str = "\
body { max-width: 64rem; }
.maps { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 19rem), 1fr)); gap: 1rem; }
.maps figure { margin: 0; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 0 2rem; }
.maps img { display: block; width: 100%; height: auto; }";

/// The heat map of a structure.
pub(crate) struct Map {
    /// The structure's name.
    pub(crate) name: &'static str,
    /// The map with its legend, as a PNG.
    pub(crate) png: Vec<u8>,
}

/// Heat maps of the structures on one scale.
pub(crate) struct HeatMaps {
    /// What was counted, in words.
    pub(crate) title: String,
    /// The maps.
    pub(crate) maps: Vec<Map>,
    /// The structures that are too slow for a map.
    pub(crate) left_out: Vec<&'static str>,
}

/// The page.
pub(crate) fn write(compared: &Compared<'_>, heat_maps: &[HeatMaps]) -> Result<String, Failure> {
    let Compared { scene, comparison } = compared;
    let facts = [
        ("Scene", (*scene).to_owned()),
        ("Primitives", thousands(comparison.primitives as u64)),
        ("Threads", comparison.threads.to_string()),
        ("Program", format!("raywood {}", env!("CARGO_PKG_VERSION"))),
    ];
    let tables = tables(comparison);
    let (structures, rays) = tables.split_at(1);
    let body = html! {
        (page::facts(&facts))
        ul { @for line in ray_sets(comparison) { li { (line) } } }
        @for note in notes(comparison) { p { (note) } }
        section {
            h2 { "Structures" }
            @for table in structures { (page::table(table)) }
            p {
                "Q expects rays that pass through the whole box, evenly spread, and hit nothing. It cannot know where real rays go: a grid with all \
                 detail in a few cells looks good to it."
                @if has_brute_force(comparison) { " Brute force, whose bars would hide all others, is in the tables only." }
            }
            div.charts { @for chart in structure_charts(comparison) { (charts::figure(&chart)?) } }
        }
        section {
            h2 { "Rays" }
            (charts::figure(&speeds(comparison))?)
            @for table in rays { (page::table(table)) }
        }
        @for heat_maps in heat_maps { (section_of_maps(heat_maps)) }
        section {
            h2 { "Levels" }
            p { "How many nodes and leaves lie on each level, the root's first, and how many references are in these leaves. A grid's \
                 cells are one level below it." }
            (charts::figure(&depths(comparison))?)
            @for structure in &comparison.structures { (levels(structure)) }
        }
    };
    Ok(page::html(&format!("Structures compared: {scene}"), STYLE, &body))
}

fn has_brute_force(comparison: &Comparison) -> bool {
    comparison.structures.iter().any(|structure| structure.kind == StructureKind::BruteForce)
}

/// The structures that bars can show beside each other: brute force, thousands of times slower, would leave nothing of the others.
fn comparable(comparison: &Comparison) -> impl Iterator<Item = &StructureReport> {
    comparison.structures.iter().filter(|structure| structure.kind != StructureKind::BruteForce)
}

fn structure_charts(comparison: &Comparison) -> Vec<Chart> {
    let chart = |title, axis: &str, value: fn(&StructureReport) -> f64| {
        let values = comparable(comparison).map(|structure| Some(value(structure))).collect();
        with_bars(comparison, title, axis, vec![BarSeries { name: axis.to_owned(), values }])
    };
    vec![
        chart("Time to build", "milliseconds", |structure| 1e3 * structure.build.median()),
        chart("Memory", "MB", |structure| structure.stats.bytes as f64 / 1e6),
        chart("Q, the cost of a ray that hits nothing", "node visits and primitive tests", |s| {
            s.stats.q
        }),
    ]
}

fn speeds(comparison: &Comparison) -> Chart {
    let series = comparison.ray_sets.iter().enumerate().map(|(number, set)| BarSeries {
        name: set.kind.name().to_owned(),
        values: comparable(comparison)
            .map(|structure| structure.traces.get(number))
            .map(|traces| traces.filter(|t| t.rays > 0).map(Traces::million_rays_per_second))
            .collect(),
    });
    let series = series.collect();
    with_bars(comparison, "Speed: longer is faster", "million rays a second", series)
}

/// Bars for each structure, with as many decimals as show two digits of the smallest.
fn with_bars(comparison: &Comparison, title: &str, axis: &str, series: Vec<BarSeries>) -> Chart {
    let names = comparable(comparison).map(|structure| structure.kind.name().to_owned());
    let values = series.iter().flat_map(|series| series.values.iter().flatten().copied());
    let smallest = values.filter(|value| *value > 0.0).reduce(f64::min).unwrap_or(1.0);
    Chart::Bars(BarChart {
        title: title.to_owned(),
        value: Axis::linear(axis),
        decimals: (1 - smallest.log10().floor() as i32).clamp(0, 6) as usize,
        categories: names.collect(),
        series,
    })
}

/// Where the references lie, of each structure: the histogram of its depth.
fn depths(comparison: &Comparison) -> Chart {
    let series = |structure: &StructureReport| {
        let StructureReport { kind, stats, .. } = structure;
        let share = |references: usize| 100.0 * references as f64 / stats.references.max(1) as f64;
        let levels = stats.levels.iter().enumerate();
        let points = levels.map(|(level, l)| [level as f64, share(l.references)]).collect();
        Series::measured(kind.name(), points)
    };
    Chart::Plot(Plot {
        title: "Where the references lie: the share of each level's leaves".to_owned(),
        x: Axis::linear("level, the root's is 0"),
        y: Axis::linear("references, % of all"),
        series: comparable(comparison).map(series).collect(),
    })
}

fn levels(StructureReport { kind, stats, .. }: &StructureReport) -> Markup {
    let caption = format!("Levels of {}", kind.name());
    let mut table = Table::new(caption, &["level", "nodes", "leaves", "references"]);
    for (number, level) in stats.levels.iter().enumerate() {
        let counts = [number, level.nodes, level.leaves, level.references];
        table.rows.push(counts.map(Cell::count).to_vec());
    }
    html! {
        details { summary { (kind.name()) } (page::table(&table)) }
    }
}

fn section_of_maps(HeatMaps { title, maps, left_out }: &HeatMaps) -> Markup {
    html! {
        section {
            h2 { (title) }
            p {
                "One ray through the centre of each pixel, all maps on one scale."
                @if !left_out.is_empty() { " Too slow to be drawn: " (left_out.join(", ")) "." }
            }
            div.maps {
                @for Map { name, png } in maps {
                    figure {
                        figcaption { (name) }
                        img alt={ (title) ", " (name) } src={ "data:image/png;base64," (STANDARD.encode(png)) };
                    }
                }
            }
        }
    }
}
