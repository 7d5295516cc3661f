//! Writes JSON lines.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::super::TableWriter;
use super::super::text::write_lines;
use crate::query::sink::Sink;
use crate::query::table::{Column, Table, Values};

/// Writes an object a line.
pub(crate) struct JsonWriter<'a> {
    sink: Sink<'a>,
}

impl<'a> JsonWriter<'a> {
    pub(crate) fn new(sink: Sink<'a>) -> Self {
        Self { sink }
    }
}

impl TableWriter for JsonWriter<'_> {
    fn write(&mut self, table: &Table) -> io::Result<()> {
        let questions = table.lists.as_ref().map_or(table.rows, |lists| lists.offsets.len() - 1);
        write_lines(&mut self.sink, questions, |rows, text| {
            for row in rows {
                match &table.lists {
                    None => append_object(&table.columns, row, text),
                    Some(lists) => {
                        text.push_str("{\"hits\":[");
                        let range = lists.offsets[row]..lists.offsets[row + 1];
                        for (number, hit) in range.enumerate() {
                            text.push_str(if number > 0 { "," } else { "" });
                            append_object(&table.columns, hit, text);
                        }
                        text.push_str("]}");
                    }
                }
                text.push('\n');
            }
        })
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.sink.flush()
    }
}

/// A row as an object. The names need no escapes.
fn append_object(columns: &[Column], row: usize, text: &mut String) {
    for (place, Column { field, values }) in columns.iter().enumerate() {
        let separator = if place > 0 { ',' } else { '{' };
        let _ = write!(text, "{separator}\"{}\":", field.name());
        match field.width() {
            1 => append(values, row, text),
            width if is_nan(values, row * width) => text.push_str("null"),
            width => {
                for axis in 0..width {
                    text.push(if axis > 0 { ',' } else { '[' });
                    append(values, row * width + axis, text);
                }
                text.push(']');
            }
        }
    }
    text.push('}');
}

fn is_nan(values: &Values, number: usize) -> bool {
    matches!(values, Values::F32(values) if values[number].is_nan())
}

/// A number in as few digits as tell it from all others, `null` where nothing is hit.
fn append(values: &Values, number: usize, text: &mut String) {
    // Writing to a string cannot fail.
    let _ = match values {
        Values::F32(values) if values[number].is_finite() => write!(text, "{:?}", values[number]),
        Values::I32(values) if values[number] >= 0 => write!(text, "{}", values[number]),
        Values::Bool(values) => write!(text, "{}", values[number]),
        _ => write!(text, "null"),
    };
}
