//! Writes an array for each column.

use std::io::{self, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::super::npy::{column_type, header};
use super::super::{Layout, TableWriter};
use crate::query::field::Field;
use crate::query::sink::Sink;
use crate::query::table::Table;

/// Keeps the arrays and writes them at the end.
pub(crate) struct NpzWriter<'a> {
    sink: Sink<'a>,
    arrays: Arrays,
}

/// What will be written.
struct Arrays {
    /// The numbers of each column, in bytes.
    columns: Vec<(Field, Vec<u8>)>,
    rows: u64,
    /// Where the answers to each row of the input begin, where these are lists.
    offsets: Option<Vec<u8>>,
}

impl<'a> NpzWriter<'a> {
    pub(crate) fn new(sink: Sink<'a>, layout: &Layout<'_>) -> Self {
        let columns = layout.fields.iter().map(|&field| (field, Vec::new())).collect();
        let offsets = layout.lists.then(|| 0_i64.to_le_bytes().to_vec());
        Self { sink, arrays: Arrays { columns, rows: 0, offsets } }
    }
}

impl Arrays {
    /// Writes all arrays into an archive.
    fn write(self, mut archive: ZipWriter<impl Write + Seek>) -> io::Result<()> {
        if let Some(offsets) = &self.offsets {
            let rows = (offsets.len() / size_of::<i64>()) as u64;
            write_array(&mut archive, "offsets", &header("'<i8'", rows, 1), offsets)?;
        }
        for (field, bytes) in self.columns {
            let header = header(&format!("'{}'", column_type(field)), self.rows, field.width());
            write_array(&mut archive, field.name(), &header, &bytes)?;
        }
        archive.finish()?.flush()
    }
}

fn write_array(
    archive: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    header: &[u8],
    bytes: &[u8],
) -> io::Result<()> {
    // What is longer than 32 bits can tell needs another form of entry.
    let is_large = bytes.len() >= (1 << 31);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .large_file(is_large);
    archive.start_file(format!("{name}.npy"), options)?;
    archive.write_all(header)?;
    archive.write_all(bytes)
}

impl TableWriter for NpzWriter<'_> {
    fn write(&mut self, table: &Table) -> io::Result<()> {
        let Arrays { columns, rows, offsets } = &mut self.arrays;
        for ((field, bytes), column) in columns.iter_mut().zip(&table.columns) {
            column.values.append_bytes(0..table.rows * field.width(), bytes);
        }
        if let (Some(offsets), Some(lists)) = (offsets, &table.lists) {
            for &end in &lists.offsets[1..] {
                offsets.extend((*rows as i64 + end as i64).to_le_bytes());
            }
        }
        *rows += table.rows as u64;
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        let Self { sink, arrays } = *self;
        match sink {
            Sink::File(file) => arrays.write(ZipWriter::new(file)),
            pipe @ Sink::Pipe(_) => arrays.write(ZipWriter::new_stream(pipe)),
        }
    }
}
