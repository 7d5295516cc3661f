//! The formats of arrays, each in a folder with its reader and its writer. A new one is a line in each function of [`Format`].

pub(crate) mod csv;
pub(crate) mod jsonl;
pub(crate) mod npy;
pub(crate) mod npz;
mod text;

use std::io;
use std::path::Path;

use super::field::Field;
use super::input::Input;
use super::kind::Subject;
use super::sink::Sink;
use super::table::Table;
use crate::failure::Failure;

/// Rows of numbers that are read piece by piece.
pub(crate) trait Rows: Send {
    /// How many numbers a row has: 3 of points; of rays 6, or 8 with `t_min` and `t_max`.
    fn width(&self) -> usize;

    /// How many rows there are, where that is known beforehand.
    fn total(&self) -> Option<u64>;

    /// Appends the numbers of at most so many rows and returns of how many; of none at the end.
    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure>;
}

/// Writes tables one after the other.
pub(crate) trait TableWriter: Send {
    /// Writes the rows of a table, or keeps them for the end.
    fn write(&mut self, table: &Table) -> io::Result<()>;

    /// Writes what is still to be written.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// What is written.
pub(crate) struct Layout<'a> {
    /// The columns.
    pub(crate) fields: &'a [Field],
    /// Whether each row of the input has a list of answers.
    pub(crate) lists: bool,
    /// How many rows will be written, where that is known beforehand.
    pub(crate) rows: Option<u64>,
}

/// The formats of arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// Comma-separated values with a line of names
    Csv,
    /// A JSON object a line
    Jsonl,
    /// One array of numpy
    Npy,
    /// Several arrays of numpy, by name
    Npz,
}

impl Format {
    /// The format that a file's name tells by its ending.
    pub(crate) fn of_name(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "csv" => Some(Self::Csv),
            "jsonl" | "ndjson" => Some(Self::Jsonl),
            "npy" => Some(Self::Npy),
            "npz" => Some(Self::Npz),
            _ => None,
        }
    }

    /// Begins to read.
    pub(crate) fn read(self, input: Input, subject: Subject) -> Result<Box<dyn Rows>, Failure> {
        Ok(match self {
            Self::Csv => Box::new(csv::CsvRows::open(input, subject)?),
            Self::Jsonl => Box::new(jsonl::JsonRows::open(input, subject)?),
            Self::Npy => Box::new(npy::NpyRows::open(input, subject)?),
            Self::Npz => Box::new(npz::NpzRows::open(input, subject)?),
        })
    }

    /// Begins to write.
    pub(crate) fn write<'a>(
        self,
        sink: Sink<'a>,
        layout: &Layout<'_>,
    ) -> io::Result<Box<dyn TableWriter + 'a>> {
        Ok(match self {
            Self::Csv => Box::new(csv::CsvWriter::new(sink, layout)?),
            Self::Jsonl => Box::new(jsonl::JsonWriter::new(sink)),
            Self::Npy => Box::new(npy::NpyWriter::new(sink, layout)?),
            Self::Npz => Box::new(npz::NpzWriter::new(sink, layout)),
        })
    }
}
