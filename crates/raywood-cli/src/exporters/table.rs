//! Tables for a terminal: columns of equal width, numbers to the right.

use raywood_lab::figures::{Cell, Table};

use super::Contents;
use crate::print::wrapped;
use crate::report::values::cell;

/// Text is no wider than this.
const WIDTH: usize = 80;

pub(super) fn write(Contents { heading, facts, tables, notes }: &Contents) -> String {
    let mut text = format!("{heading}\n");
    for fact in facts {
        for (number, line) in wrapped(fact, WIDTH - 4).iter().enumerate() {
            text += &format!("  {}{line}\n", if number == 0 { "" } else { "  " });
        }
    }
    for table in tables {
        text += &format!("\n{}\n{}", table.caption, lines(table));
    }
    text += "\n";
    for note in notes {
        text += &(wrapped(note, WIDTH).join("\n") + "\n");
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
