//! An array of rows, read piece by piece.

use std::io::{self, BufReader, Read};

use super::element::Element;
use super::header::{Header, HeaderError};
use crate::failure::Failure;
use crate::query::input::{Input, Stream};

/// An array of rows of numbers, not yet read to its end.
pub(in crate::query) struct NpyArray {
    input: Input,
    /// The name in messages, as "array `origins`: ", of one among several.
    label: String,
    element: Element,
    shape: Vec<u64>,
    /// One of all numbers in C order, or one for each column.
    streams: Vec<Stream>,
    row: u64,
    bytes: Vec<u8>,
}

impl NpyArray {
    /// Reads the header of an array whose bytes `stream` gives; `reopen` is asked for more streams if the array is in Fortran order, and told where to
    /// begin. An array in C order is read through `stream` alone.
    pub(in crate::query) fn open(
        input: &Input,
        label: String,
        mut stream: Stream,
        reopen: impl FnOnce(Stream, u64, &[u64]) -> io::Result<Vec<Stream>>,
    ) -> Result<Self, Failure> {
        let header = Header::read(&mut stream).map_err(|error| match error {
            HeaderError::Io(error) => cannot_read(input, &label, &error),
            HeaderError::Wrong(message) => input.complain(format_args!("{label}{message}")),
        })?;
        let Header { element, fortran_order, shape, length } = header;
        let (rows, width) = rows_and_width(&shape);
        let size = element.size() as u64;
        if rows.checked_mul(width).and_then(|n| n.checked_mul(size)).is_none_or(|n| n >= 1 << 62) {
            return Err(input.complain(format_args!(
                "{label}shape {} is too large to be true",
                shape_text(&shape)
            )));
        }
        // Only shapes with few columns are read at all.
        let streams = if fortran_order && (2..=8).contains(&width) {
            let offsets: Vec<_> = (0..width).map(|column| column * rows * size).collect();
            let streams = reopen(stream, length, &offsets);
            streams.map_err(|error| cannot_read(input, &label, &error))?
        } else {
            vec![stream]
        };
        let streams = streams.into_iter().map(buffered).collect();
        Ok(Self { input: input.clone(), label, element, shape, streams, row: 0, bytes: Vec::new() })
    }

    /// The lengths of its dimensions.
    pub(in crate::query) fn shape(&self) -> &[u64] {
        &self.shape
    }

    /// How many rows there are: of one number each if there is one dimension, one row of one number if there is none.
    pub(in crate::query) fn rows(&self) -> u64 {
        rows_and_width(&self.shape).0
    }

    /// How many numbers a row has.
    pub(in crate::query) fn width(&self) -> usize {
        rows_and_width(&self.shape).1 as usize
    }

    /// The array is not as expected.
    pub(in crate::query) fn unexpected(&self, expected: &str) -> Failure {
        let shape = shape_text(&self.shape);
        self.input.complain(format_args!("{}shape {shape}, expected {expected}", self.label))
    }

    /// Appends at most so many rows and returns how many; none at the end.
    pub(in crate::query) fn read(
        &mut self,
        rows: usize,
        numbers: &mut Vec<f32>,
    ) -> Result<usize, Failure> {
        let width = self.width();
        let rows = (self.rows() - self.row).min(rows as u64) as usize;
        if rows > 0 {
            match self.streams.len() {
                1 => self.fill(0, rows * width, width, numbers)?,
                _ => self.read_columns(rows, numbers)?,
            }
            self.row += rows as u64;
            if self.row == self.rows() {
                self.check_end()?;
            }
        }
        Ok(rows)
    }

    /// Rows of an array in Fortran order.
    fn read_columns(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<(), Failure> {
        let (start, width) = (numbers.len(), self.streams.len());
        numbers.resize(start + rows * width, 0.0);
        let mut column = Vec::new();
        for number in 0..width {
            column.clear();
            self.fill(number, rows, 1, &mut column)?;
            for (row, &value) in column.iter().enumerate() {
                numbers[start + row * width + number] = value;
            }
        }
        Ok(())
    }

    /// Appends numbers of a stream that has so many of each row.
    fn fill(
        &mut self,
        stream: usize,
        count: usize,
        per_row: usize,
        numbers: &mut Vec<f32>,
    ) -> Result<(), Failure> {
        let size = self.element.size();
        let wanted = (count * size) as u64;
        self.bytes.clear();
        let mut limited = (&mut self.streams[stream]).take(wanted);
        limited.read_to_end(&mut self.bytes).map_err(|error| self.cannot_read(&error))?;
        if self.bytes.len() as u64 != wanted {
            let row = self.row + (self.bytes.len() / (size * per_row)) as u64;
            return Err(self.input.complain(format_args!(
                "{}ends in row {row}, expected {} rows as its shape says",
                self.label,
                self.rows()
            )));
        }
        self.element.decode(&self.bytes, numbers);
        Ok(())
    }

    /// Reads on behind the last row, where there should be nothing.
    fn check_end(&mut self) -> Result<(), Failure> {
        // The last column's stream has read all that comes before too.
        if let Some(stream) = self.streams.last_mut()
            && stream.read(&mut [0]).map_err(|error| self.cannot_read(&error))? > 0
        {
            let (label, rows) = (&self.label, self.rows());
            crate::print::warning(format_args!(
                "{}: {label}what follows the {rows} rows of the array is not read",
                self.input.name()
            ));
        }
        Ok(())
    }

    fn cannot_read(&self, error: &io::Error) -> Failure {
        cannot_read(&self.input, &self.label, error)
    }
}

/// Of one array among several, which.
fn cannot_read(input: &Input, label: &str, error: &io::Error) -> Failure {
    input.cannot_read(&io::Error::new(error.kind(), format!("{label}{error}")))
}

fn buffered(stream: Stream) -> Stream {
    Box::new(BufReader::with_capacity(1 << 16, stream))
}

/// How many rows of how many numbers a shape has.
fn rows_and_width(shape: &[u64]) -> (u64, u64) {
    match *shape {
        [] => (1, 1),
        [rows] => (rows, 1),
        [rows, width] => (rows, width),
        // More dimensions are refused.
        _ => (0, 0),
    }
}

/// A shape as Python writes it.
fn shape_text(shape: &[u64]) -> String {
    match shape {
        [rows] => format!("({rows},)"),
        _ => format!("({})", shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    }
}
