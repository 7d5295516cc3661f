//! A comparison as tables of words and rounded numbers, for people.

use raywood::{Counts, StructureKind};
use raywood_lab::{Comparison, StructureReport, Traces};

use crate::print::thousands;

/// A table: the first column names the rows, the others hold numbers.
pub(crate) struct TextTable {
    /// What the numbers are.
    pub(crate) title: &'static str,
    /// What stands above the columns.
    pub(crate) header: Vec<String>,
    /// The rows, as long as the header.
    pub(crate) rows: Vec<Vec<String>>,
}

impl TextTable {
    /// The widths of the columns in characters.
    pub(crate) fn widths(&self) -> Vec<usize> {
        let width = |column: usize| {
            let cells =
                self.rows.iter().chain([&self.header]).map(|row| row[column].chars().count());
            cells.max().unwrap_or(0)
        };
        (0..self.header.len()).map(width).collect()
    }
}

/// All tables of a comparison.
pub(crate) fn tables(comparison: &Comparison) -> Vec<TextTable> {
    let mut tables = vec![structures(comparison)];
    if comparison.structures.iter().any(|structure| !structure.traces.is_empty()) {
        tables.push(per_kind("million rays a second", comparison, speed));
        tables.push(per_kind("nodes or cells entered by a ray", comparison, |traces| {
            mean(traces, |counts| counts.nodes)
        }));
        tables.push(per_kind("boxes tested by a ray", comparison, |traces| {
            mean(traces, |counts| counts.boxes)
        }));
        tables.push(per_kind("primitives tested by a ray", comparison, |traces| {
            mean(traces, |counts| counts.primitives)
        }));
    }
    tables
}

/// What rays were traced, in a line for each set.
pub(crate) fn ray_sets(comparison: &Comparison) -> Vec<String> {
    let line = |set: &raywood_lab::RaySetSummary| {
        let (rays, hits) = (thousands(set.rays as u64), thousands(set.hits as u64));
        format!("{rays} {} rays, {hits} of them hit: {}", set.kind.name(), set.kind.description())
    };
    comparison.ray_sets.iter().map(line).collect()
}

/// What must be said of the numbers.
pub(crate) fn notes(comparison: &Comparison) -> Vec<String> {
    let mut notes = vec![
        "Every answer of every structure is equal to those of the others, to the bit.".to_owned(),
        "Times are medians of rounds taken in turns; ± is half the distance between the quartiles."
            .to_owned(),
    ];
    for structure in &comparison.structures {
        let sampled =
            structure.traces.iter().zip(&comparison.ray_sets).find(|(t, s)| t.rays < s.rays);
        if let Some((traces, _)) = sampled {
            let (name, rays) = (structure.kind.name(), thousands(traces.rays as u64));
            let kind = traces.kind.name();
            notes.push(format!("{name} traced a sample of the rays: of the {kind} ones {rays}."));
        }
    }
    notes
}

fn structures(comparison: &Comparison) -> TextTable {
    let header = ["structure", "build s", "±", "MB", "nodes", "depth", "refs/prim", "Q"];
    let row = |StructureReport { kind, build, stats, .. }: &StructureReport| {
        vec![
            kind.name().to_owned(),
            significant(build.median()),
            percent(build.spread()),
            format!("{:.1}", stats.bytes as f64 / 1e6),
            thousands(stats.nodes as u64),
            stats.depth.to_string(),
            format!("{:.2}", stats.duplication()),
            significant(stats.q),
        ]
    };
    TextTable {
        title: "structures",
        header: header.map(str::to_owned).to_vec(),
        rows: comparison.structures.iter().map(row).collect(),
    }
}

/// A table of one number for each structure and kind of rays.
fn per_kind(
    title: &'static str,
    comparison: &Comparison,
    cell: impl Fn(&Traces) -> String,
) -> TextTable {
    let kinds = comparison.ray_sets.iter().map(|set| set.kind.name().to_owned());
    let row = |structure: &StructureReport| {
        let name = StructureKind::name(structure.kind).to_owned();
        [name].into_iter().chain(structure.traces.iter().map(&cell)).collect()
    };
    TextTable {
        title,
        header: ["structure".to_owned()].into_iter().chain(kinds).collect(),
        rows: comparison.structures.iter().map(row).collect(),
    }
}

fn speed(traces: &Traces) -> String {
    match traces.rays {
        0 => "-".to_owned(),
        _ => {
            let speed = significant(traces.million_rays_per_second());
            format!("{speed} {}", percent(traces.timing.spread()))
        }
    }
}

fn mean(traces: &Traces, part: impl Fn(&Counts) -> u64) -> String {
    match traces.rays {
        0 => "-".to_owned(),
        _ => significant(traces.per_ray(part(&traces.counts))),
    }
}

/// A share as whole percents either way.
fn percent(share: f64) -> String {
    format!("±{:.0}%", 100.0 * share)
}

/// A number with three significant digits, without an exponent; large numbers are whole.
pub(crate) fn significant(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    if number.abs() >= 999.5 {
        return thousands(number.abs().round() as u64);
    }
    // As many digits after the point as the three need, of the number as it will be rounded.
    let rounded: f64 = format!("{number:.2e}").parse().unwrap_or(number);
    let digits = (2 - rounded.abs().log10().floor() as i32).clamp(0, 8) as usize;
    format!("{number:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn three_digits_count() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.00"),
            (0.012345, "0.0123"),
            (9.996, "10.0"),
            (99.96, "100"),
            (123.4, "123"),
            (999.4, "999"),
            (999.9, "1,000"),
            (1_234_567.8, "1,234,568"),
        ];
        for (number, text) in cases {
            assert_eq!(significant(number), text);
        }
    }
}
