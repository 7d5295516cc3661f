//! What a comparison shows people: tables of rounded numbers, and what must be said of them.

use raywood::Counts;
use raywood_lab::figures::{Cell, Table};
use raywood_lab::{Comparison, RaySetSummary, StructureReport, Traces};

use super::Compared;
use crate::exporters::contents::{Contents, measured};
use crate::print::{thousands, threads};

/// All of it.
pub(super) fn contents(Compared { scene, comparison }: &Compared<'_>) -> Contents {
    let primitives = thousands(comparison.primitives as u64);
    Contents {
        heading: format!("{scene}: {primitives} primitives, {}", threads(comparison.threads)),
        facts: ray_sets(comparison),
        tables: tables(comparison),
        notes: notes(comparison),
    }
}

/// All tables.
pub(super) fn tables(comparison: &Comparison) -> Vec<Table> {
    let per_ray = |caption, part: fn(&Counts) -> u64| {
        per_kind(caption, comparison, |traces| {
            Cell::significant(traces.per_ray(part(&traces.counts)))
        })
    };
    vec![
        structures(comparison),
        per_kind("Million rays a second", comparison, |traces| {
            measured(traces.million_rays_per_second(), &traces.timing)
        }),
        per_ray("Nodes or cells entered by a ray", |counts| counts.nodes),
        per_ray("Boxes tested by a ray", |counts| counts.boxes),
        per_ray("Primitives tested by a ray", |counts| counts.primitives),
    ]
}

/// What rays were traced, in a line for each set.
pub(super) fn ray_sets(comparison: &Comparison) -> Vec<String> {
    let line = |set: &RaySetSummary| {
        let (rays, hits) = (thousands(set.rays as u64), thousands(set.hits as u64));
        format!("{rays} {} rays, {hits} of them hit: {}", set.kind.name(), set.kind.description())
    };
    comparison.ray_sets.iter().map(line).collect()
}

/// What must be said of the numbers.
pub(super) fn notes(comparison: &Comparison) -> Vec<String> {
    let mut notes = vec![
        "Every answer of every structure agrees with the reference's for the same ray.".to_owned(),
        "Times are medians of rounds in which the structures take turns, one kind of rays after the other; ± is half the distance between the quartiles."
            .to_owned(),
    ];
    for structure in &comparison.structures {
        let pairs = structure.traces.iter().zip(&comparison.ray_sets);
        let sampled: Vec<_> = pairs
            .filter(|(traces, set)| traces.rays < set.rays)
            .map(|(traces, _)| format!("{} {}", thousands(traces.rays as u64), traces.kind.name()))
            .collect();
        if !sampled.is_empty() {
            let name = structure.kind.name();
            notes.push(format!("{name} traced only a sample: {} rays.", sampled.join(", ")));
        }
    }
    notes
}

fn structures(comparison: &Comparison) -> Table {
    let columns = ["structure", "build ms", "MB", "nodes", "depth", "refs/prim", "Q"];
    let mut table = Table::new("Structures", &columns);
    for StructureReport { kind, build, stats, .. } in &comparison.structures {
        table.rows.push(vec![
            Cell::text(kind.name()),
            measured(1e3 * build.median(), build),
            Cell::significant(stats.bytes as f64 / 1e6),
            Cell::count(stats.nodes),
            Cell::count(stats.depth),
            Cell::Number(stats.duplication(), 2),
            Cell::significant(stats.q),
        ]);
    }
    table
}

/// A table of one number for each structure and kind of rays.
fn per_kind(caption: &str, comparison: &Comparison, cell: impl Fn(&Traces) -> Cell) -> Table {
    let kinds = comparison.ray_sets.iter().map(|set| set.kind.name());
    let columns: Vec<_> = ["structure"].into_iter().chain(kinds).collect();
    let mut table = Table::new(caption, &columns);
    for structure in &comparison.structures {
        let measured =
            |traces: &Traces| if traces.rays == 0 { Cell::Nothing } else { cell(traces) };
        let name = Cell::text(structure.kind.name());
        let row = [name].into_iter().chain(structure.traces.iter().map(measured));
        table.rows.push(row.collect());
    }
    table
}
