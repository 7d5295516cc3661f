//! What a report shows people, whatever the format.

use raywood_lab::Timing;
use raywood_lab::figures::{Cell, Table};

/// A heading, facts, tables of rounded numbers, and what must be said of them.
pub(crate) struct Contents {
    /// What the report is about, in a line.
    pub(crate) heading: String,
    /// What was measured, and on what: a line each.
    pub(crate) facts: Vec<String>,
    /// The numbers.
    pub(crate) tables: Vec<Table>,
    /// A sentence or two each.
    pub(crate) notes: Vec<String>,
}

/// A number that follows from a time; one that was measured once has no spread.
pub(super) fn measured(value: f64, timing: &Timing) -> Cell {
    match timing.rounds() {
        0 | 1 => Cell::significant(value),
        _ => Cell::with_spread(value, timing.spread()),
    }
}
