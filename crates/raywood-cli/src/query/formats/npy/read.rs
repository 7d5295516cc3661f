//! Reads rows from one array.

use std::io;

use super::super::Rows;
use super::NpyArray;
use crate::failure::Failure;
use crate::query::input::{Bytes, Input, Stream};
use crate::query::kind::Subject;

/// The rows of an array.
pub(crate) struct NpyRows(NpyArray);

impl NpyRows {
    /// Reads the header. Standard input is read piece by piece too, unless it is in Fortran order.
    pub(crate) fn open(input: Input, subject: Subject) -> Result<Self, Failure> {
        let array =
            NpyArray::open(&input, String::new(), input.stream()?, |mut rest, start, columns| {
                let (bytes, start) = match &input {
                    Input::File(path) if path.is_file() => (Bytes::File(path.clone()), start),
                    _ => (Bytes::in_memory(&mut rest)?, 0),
                };
                let column = |&offset: &u64| Ok(Box::new(bytes.open(start + offset)?) as Stream);
                columns.iter().map(column).collect::<io::Result<_>>()
            })?;
        Self::new(array, subject)
    }

    /// The rows of an array, if its shape is right.
    pub(in crate::query) fn new(array: NpyArray, subject: Subject) -> Result<Self, Failure> {
        match (subject, array.shape()) {
            (Subject::Rays, [_, 6 | 8]) | (Subject::Points, [_, 3]) => Ok(Self(array)),
            (Subject::Rays, _) => Err(array.unexpected(
                "(N, 6), origin and direction of each ray, or (N, 8), with t_min and t_max",
            )),
            (Subject::Points, _) => Err(array.unexpected("(N, 3), a point each")),
        }
    }
}

impl Rows for NpyRows {
    fn width(&self) -> usize {
        self.0.width()
    }

    fn total(&self) -> Option<u64> {
        Some(self.0.rows())
    }

    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure> {
        self.0.read(rows, numbers)
    }
}
