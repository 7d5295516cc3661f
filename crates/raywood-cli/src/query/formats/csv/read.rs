//! Reads comma-separated values.

use std::io::{self, Read};

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};
use raywood_scene::quoted;

use super::super::Rows;
use crate::failure::Failure;
use crate::query::input::{Input, Stream};
use crate::query::kind::Subject;

/// More bytes than this are no row.
const LONGEST_RECORD: usize = 1 << 20;

/// A number of a row: the names that its column may have, and what it is if the column is missing or the field empty.
struct Wanted {
    names: &'static [&'static str],
    missing: Option<f32>,
    empty: f32,
}

/// A number that must be there.
const fn needed(names: &'static [&'static str]) -> Wanted {
    Wanted { names, missing: None, empty: f32::NAN }
}

/// A number that need not be there.
const fn optional(names: &'static [&'static str], value: f32) -> Wanted {
    Wanted { names, missing: Some(value), empty: value }
}

const RAY: [Wanted; 8] = [
    needed(&["origin_x", "ox"]),
    needed(&["origin_y", "oy"]),
    needed(&["origin_z", "oz"]),
    needed(&["direction_x", "dx"]),
    needed(&["direction_y", "dy"]),
    needed(&["direction_z", "dz"]),
    optional(&["t_min"], 0.0),
    optional(&["t_max"], f32::INFINITY),
];

const POINT: [Wanted; 3] = [needed(&["x"]), needed(&["y"]), needed(&["z"])];

/// Rows of comma-separated values.
pub(crate) struct CsvRows {
    input: Input,
    reader: Reader<Bounded>,
    record: ByteRecord,
    wanted: &'static [Wanted],
    /// The column of each number, if there is one.
    columns: Vec<Option<usize>>,
    fields: usize,
    /// Whether `record` was read but not yet asked for.
    is_ahead: bool,
}

impl CsvRows {
    /// Reads the line of names, or finds that the first line is one of numbers.
    pub(crate) fn open(input: Input, subject: Subject) -> Result<Self, Failure> {
        let wanted: &[Wanted] = match subject {
            Subject::Rays => &RAY,
            Subject::Points => &POINT,
        };
        let stream = Bounded { stream: input.stream()?, left: LONGEST_RECORD };
        let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(stream);
        let mut record = ByteRecord::new();
        let found = reader.read_byte_record(&mut record);
        if !found.map_err(|error| cannot_read(&input, &record, error))? {
            return Err(input.complain(format_args!("empty, expected {}", example(subject))));
        }
        let fields = record.len();
        let is_numbers = record.iter().all(|field| parse(field, 0.0).is_some())
            && record.iter().any(|field| !field.trim_ascii().is_empty());
        let columns = match is_numbers {
            true => columns_in_order(&input, fields, subject)?,
            false => columns_by_name(&input, &record, wanted, subject)?,
        };
        Ok(Self { input, reader, record, wanted, columns, fields, is_ahead: is_numbers })
    }

    /// Appends the numbers of the record that was read.
    fn append(&self, numbers: &mut Vec<f32>) -> Result<(), Failure> {
        if self.record.len() != self.fields {
            let (found, expected) = (self.record.len(), self.fields);
            return Err(self.input.complain_at(
                line_of(&self.record),
                format_args!("{found} fields, expected {expected} as in the first line"),
            ));
        }
        for (wanted, column) in self.wanted.iter().zip(&self.columns) {
            let Some(column) = *column else {
                numbers.extend(wanted.missing);
                continue;
            };
            let field = &self.record[column];
            let number = parse(field, wanted.empty);
            let Some(number) = number else {
                let (name, found) = (wanted.names[0], quoted(field));
                return Err(self.input.complain_at(
                    line_of(&self.record),
                    format_args!("`{name}` is {found}, expected a number"),
                ));
            };
            numbers.push(number);
        }
        Ok(())
    }
}

impl Rows for CsvRows {
    fn width(&self) -> usize {
        self.wanted.len()
    }

    fn total(&self) -> Option<u64> {
        None
    }

    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure> {
        for row in 0..rows {
            if !std::mem::take(&mut self.is_ahead) {
                self.reader.get_mut().left = LONGEST_RECORD;
                let found = self.reader.read_byte_record(&mut self.record);
                if !found.map_err(|error| cannot_read(&self.input, &self.record, error))? {
                    return Ok(row);
                }
            }
            self.append(numbers)?;
        }
        Ok(rows)
    }
}

/// The number that a field holds, `empty` if that is nothing.
fn parse(field: &[u8], empty: f32) -> Option<f32> {
    match field.trim_ascii() {
        [] => Some(empty),
        field => std::str::from_utf8(field).ok()?.parse().ok(),
    }
}

/// What the first line should be.
fn example(subject: Subject) -> &'static str {
    match subject {
        Subject::Rays => {
            "a line of names, origin_x,origin_y,origin_z,direction_x,direction_y,direction_z, or of 6 or 8 numbers"
        }
        Subject::Points => "a line of names, x,y,z, or of 3 numbers",
    }
}

/// The columns of lines that have no names.
fn columns_in_order(
    input: &Input,
    fields: usize,
    subject: Subject,
) -> Result<Vec<Option<usize>>, Failure> {
    let wanted = match (subject, fields) {
        (Subject::Rays, 6 | 8) => RAY.len(),
        (Subject::Points, 3) => POINT.len(),
        _ => {
            let message = format!("{fields} numbers and no names, expected {}", example(subject));
            return Err(input.complain_at(1, message));
        }
    };
    Ok((0..wanted).map(|column| (column < fields).then_some(column)).collect())
}

/// The columns that a line of names tells.
fn columns_by_name(
    input: &Input,
    header: &ByteRecord,
    wanted: &[Wanted],
    subject: Subject,
) -> Result<Vec<Option<usize>>, Failure> {
    let name = |field: &[u8]| String::from_utf8_lossy(field).trim().to_ascii_lowercase();
    let names: Vec<_> = header.iter().map(name).collect();
    let place_of =
        |wanted: &Wanted| names.iter().position(|name| wanted.names.contains(&name.as_str()));
    let columns: Vec<_> = wanted.iter().map(place_of).collect();
    for (wanted, column) in wanted.iter().zip(&columns) {
        if column.is_none() && wanted.missing.is_none() {
            let (name, expected) = (wanted.names[0], example(subject));
            let message = format!("no column `{name}`, expected {expected}");
            return Err(input.complain_at(1, message));
        }
    }
    let unused = names.iter().enumerate().filter(|(column, _)| !columns.contains(&Some(*column)));
    input.warn_of_unused("column", unused.map(|(_, name)| name.as_str()));
    Ok(columns)
}

/// A stream that refuses to go on where a record does not end, as behind a quotation mark that is never closed.
struct Bounded {
    stream: Stream,
    /// How many bytes may still be read for this record.
    left: usize,
}

impl Read for Bounded {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        let count = self.stream.read(bytes)?;
        self.left = self.left.saturating_sub(count);
        Ok(count)
    }
}

/// The line that a record begins in; the first is 1.
fn line_of(record: &ByteRecord) -> u64 {
    record.position().map_or(1, csv::Position::line)
}

/// What the reader of lines says of a record.
fn cannot_read(input: &Input, record: &ByteRecord, error: csv::Error) -> Failure {
    let text = error.to_string();
    match error.into_kind() {
        ErrorKind::Io(error) if error.kind() == io::ErrorKind::FileTooLarge => {
            let message = format!("a line or quotation of more than {LONGEST_RECORD} bytes");
            input.complain_at(line_of(record), message)
        }
        ErrorKind::Io(error) => input.cannot_read(&error),
        _ => input.complain(text),
    }
}
