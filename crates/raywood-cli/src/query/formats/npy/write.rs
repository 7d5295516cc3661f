//! Writes all columns as one array.

use std::io::{self, Write};

use super::super::{Layout, TableWriter};
use super::{column_type, header};
use crate::query::sink::Sink;
use crate::query::table::Table;

/// Writes an array row by row. Where neither the number of rows is known beforehand nor one can go back to write it, rows wait in memory.
pub(crate) struct NpyWriter<'a> {
    sink: Sink<'a>,
    /// The type of the array.
    descr: String,
    width: usize,
    /// How many rows the header that was written tells of, if any.
    promised: Option<u64>,
    rows: u64,
    waiting: Vec<u8>,
}

impl<'a> NpyWriter<'a> {
    /// Writes the header, or makes room for it.
    pub(crate) fn new(mut sink: Sink<'a>, layout: &Layout<'_>) -> io::Result<Self> {
        let (descr, width) = match (layout.fields, layout.lists) {
            (&[field], false) => (format!("'{}'", column_type(field)), field.width()),
            (fields, lists) => {
                let ray = lists.then(|| "('ray', '<i8')".to_owned());
                let columns = fields.iter().map(|&field| {
                    let shape = if field.width() > 1 {
                        format!(", ({},)", field.width())
                    } else {
                        String::new()
                    };
                    format!("('{}', '{}'{shape})", field.name(), column_type(field))
                });
                let columns: Vec<_> = ray.into_iter().chain(columns).collect();
                (format!("[{}]", columns.join(", ")), 1)
            }
        };
        let mut promised = layout.rows.filter(|_| !layout.lists);
        if promised.is_none() && sink.is_file() {
            promised = Some(0);
        }
        if let Some(rows) = promised {
            sink.write_all(&header(&descr, rows, width))?;
        }
        Ok(Self { sink, descr, width, promised, rows: 0, waiting: Vec::new() })
    }
}

impl TableWriter for NpyWriter<'_> {
    fn write(&mut self, table: &Table) -> io::Result<()> {
        let mut rays = table.lists.as_ref().map(|lists| lists.questions());
        for row in 0..table.rows {
            if let Some(ray) = rays.as_mut().and_then(Iterator::next) {
                self.waiting.extend((ray as i64).to_le_bytes());
            }
            for column in &table.columns {
                let width = column.field.width();
                column.values.append_bytes(row * width..(row + 1) * width, &mut self.waiting);
            }
        }
        self.rows += table.rows as u64;
        if self.promised.is_some() {
            self.sink.write_all(&self.waiting)?;
            self.waiting.clear();
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        if self.promised != Some(self.rows) {
            let header = header(&self.descr, self.rows, self.width);
            match self.promised {
                Some(_) => self.sink.rewrite_start(&header)?,
                None => {
                    self.sink.write_all(&header)?;
                    self.sink.write_all(&self.waiting)?;
                }
            }
        }
        self.sink.flush()
    }
}
