//! Tables for a terminal: columns of equal width, numbers to the right.

use super::Compared;
use super::text_table::{notes, ray_sets, tables};
use crate::print::thousands;

pub(super) fn write(Compared { scene, comparison }: &Compared<'_>) -> String {
    let primitives = thousands(comparison.primitives as u64);
    let mut text = format!("{scene}: {primitives} primitives, {} threads\n", comparison.threads);
    for line in ray_sets(comparison) {
        text += &format!("  {line}\n");
    }
    for table in tables(comparison) {
        text += &format!("\n{}\n", table.title);
        let widths = table.widths();
        for row in [&table.header].into_iter().chain(&table.rows) {
            text += &line(row, &widths);
        }
    }
    text += "\n";
    for note in notes(comparison) {
        text += &format!("{note}\n");
    }
    text
}

/// A row: the name to the left, the rest to the right.
fn line(row: &[String], widths: &[usize]) -> String {
    let mut line = String::from(" ");
    for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
        line += &if column == 0 { format!(" {cell:<width$}") } else { format!("  {cell:>width$}") };
    }
    line.truncate(line.trim_end().len());
    line + "\n"
}
