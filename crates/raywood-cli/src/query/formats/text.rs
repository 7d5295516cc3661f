//! Rows as lines of text, made on all cores.

use std::io::{self, Write};
use std::ops::Range;

use rayon::prelude::*;

/// How many rows a task takes.
const PIECE: usize = 2048;

/// Writes the lines of `rows` rows in order; `append` makes those of a range.
pub(super) fn write_lines(
    out: &mut dyn Write,
    rows: usize,
    append: impl Fn(Range<usize>, &mut String) + Sync,
) -> io::Result<()> {
    let starts: Vec<_> = (0..rows).step_by(PIECE).collect();
    let lines = |&start: &usize| {
        let mut text = String::new();
        append(start..rows.min(start + PIECE), &mut text);
        text
    };
    let texts: Vec<_> = starts.par_iter().map(lines).collect();
    texts.iter().try_for_each(|text| out.write_all(text.as_bytes()))
}
