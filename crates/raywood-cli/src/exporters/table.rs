//! Tables for a terminal: columns of equal width, numbers to the right.

use raywood_lab::figures::{Cell, Table};

use super::Compared;
use super::contents::{notes, ray_sets, tables};
use crate::print::thousands;
use crate::report::values::cell;

pub(super) fn write(Compared { scene, comparison }: &Compared<'_>) -> String {
    let primitives = thousands(comparison.primitives as u64);
    let mut text = format!("{scene}: {primitives} primitives, {} threads\n", comparison.threads);
    for line in ray_sets(comparison) {
        text += &format!("  {line}\n");
    }
    for table in tables(comparison) {
        text += &format!("\n{}\n{}", table.caption, lines(&table));
    }
    text += "\n";
    for note in notes(comparison) {
        text += &format!("{note}\n");
    }
    text
}

/// The heading and rows of a table: the first column to the left, the rest to the right.
fn lines(table: &Table) -> String {
    let cells = |row: &Vec<Cell>| row.iter().map(cell).collect::<Vec<_>>();
    let rows: Vec<_> =
        [table.columns.clone()].into_iter().chain(table.rows.iter().map(cells)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<_> = (0..table.columns.len()).map(|c| width(c).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in &rows {
        let (name, numbers) = (&row[0], row.iter().zip(&widths).skip(1));
        text += &format!("  {name:<width$}", width = widths[0]);
        numbers.for_each(|(number, width)| text += &format!("  {number:>width$}"));
        text += "\n";
    }
    text
}
