//! Writes comma-separated values.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::super::text::write_lines;
use super::super::{Layout, TableWriter};
use crate::query::sink::Sink;
use crate::query::table::{Table, Values};

/// Writes a line a row.
pub(crate) struct CsvWriter<'a> {
    sink: Sink<'a>,
}

impl<'a> CsvWriter<'a> {
    /// Writes the line of names.
    pub(crate) fn new(mut sink: Sink<'a>, layout: &Layout<'_>) -> io::Result<Self> {
        let mut names: Vec<String> = Vec::new();
        if layout.lists {
            names.push("ray".to_owned());
        }
        for field in layout.fields {
            match field.width() {
                1 => names.push(field.name().to_owned()),
                _ => names.extend(["x", "y", "z"].map(|axis| format!("{}_{axis}", field.name()))),
            }
        }
        writeln!(sink, "{}", names.join(","))?;
        Ok(Self { sink })
    }
}

impl TableWriter for CsvWriter<'_> {
    fn write(&mut self, table: &Table) -> io::Result<()> {
        let rays: Option<Vec<_>> = table.lists.as_ref().map(|lists| lists.questions().collect());
        write_lines(&mut self.sink, table.rows, |rows, text| {
            for row in rows {
                let mut separator = "";
                if let Some(rays) = &rays {
                    let _ = write!(text, "{}", rays[row]);
                    separator = ",";
                }
                for column in &table.columns {
                    let width = column.field.width();
                    for number in row * width..(row + 1) * width {
                        text.push_str(separator);
                        separator = ",";
                        append(&column.values, number, text);
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

/// A number in as few digits as tell it from all others.
fn append(values: &Values, number: usize, text: &mut String) {
    // Writing to a string cannot fail.
    let _ = match values {
        Values::F32(values) => write!(text, "{:?}", values[number]),
        Values::I32(values) => write!(text, "{}", values[number]),
        Values::Bool(values) => write!(text, "{}", values[number]),
    };
}
