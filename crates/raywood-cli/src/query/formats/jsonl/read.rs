//! Reads JSON lines.

use std::io::{BufRead, BufReader, Read};

use rayon::prelude::*;
use raywood_scene::quoted;
use serde_json::{Map, Value};

use super::super::Rows;
use crate::failure::Failure;
use crate::print;
use crate::query::input::{Input, MOST_WARNINGS, Stream};
use crate::query::kind::Subject;

/// A longer line is no ray.
const LONGEST_LINE: u64 = 1 << 20;

/// Lines are parsed when they have so many bytes together.
const MOST_BYTES: usize = 16 << 20;

/// Rows of JSON lines.
pub(crate) struct JsonRows {
    input: Input,
    reader: BufReader<Stream>,
    subject: Subject,
    /// The number of the last line that was read; the first is 1.
    line: u64,
    /// Names of values that are not used, and that the user was told of.
    unused: Vec<String>,
}

/// The numbers of a line, and the first name in it that is not used.
type Parsed = (Vec<f32>, Option<String>);

impl JsonRows {
    pub(crate) fn open(input: Input, subject: Subject) -> Result<Self, Failure> {
        let reader = BufReader::with_capacity(1 << 16, input.stream()?);
        Ok(Self { input, reader, subject, line: 0, unused: Vec::new() })
    }

    /// The next line that is not empty, with its number.
    fn next_line(&mut self) -> Result<Option<(u64, Vec<u8>)>, Failure> {
        loop {
            let mut text = Vec::new();
            let mut limited = (&mut self.reader).take(LONGEST_LINE);
            let length = limited
                .read_until(b'\n', &mut text)
                .map_err(|error| self.input.cannot_read(&error))?;
            if length == 0 {
                return Ok(None);
            }
            self.line += 1;
            if length as u64 == LONGEST_LINE {
                let line = self.line;
                return Err(self.input.complain_at(
                    line,
                    format_args!(
                        "longer than {LONGEST_LINE} bytes, expected {}",
                        example(self.subject)
                    ),
                ));
            }
            if !text.trim_ascii().is_empty() {
                return Ok(Some((self.line, text)));
            }
        }
    }
}

impl Rows for JsonRows {
    fn width(&self) -> usize {
        match self.subject {
            Subject::Rays => 8,
            Subject::Points => 3,
        }
    }

    fn total(&self) -> Option<u64> {
        None
    }

    fn read(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure> {
        let mut done = 0;
        while done < rows {
            let count = self.read_some(rows - done, numbers)?;
            if count == 0 {
                break;
            }
            done += count;
        }
        Ok(done)
    }
}

impl JsonRows {
    /// Appends the numbers of at most so many rows, fewer where lines are long; of none at the end.
    fn read_some(&mut self, rows: usize, numbers: &mut Vec<f32>) -> Result<usize, Failure> {
        let (mut lines, mut bytes) = (Vec::new(), 0);
        while lines.len() < rows
            && bytes < MOST_BYTES
            && let Some(line) = self.next_line()?
        {
            bytes += line.1.len();
            lines.push(line);
        }
        let subject = self.subject;
        let parse = |(line, text): &(u64, Vec<u8>)| {
            parse(text, subject).map_err(|message| (*line, message))
        };
        let parsed: Vec<Result<Parsed, (u64, String)>> =
            lines.par_iter().with_min_len(256).map(parse).collect();
        for result in parsed {
            let (row, unused) =
                result.map_err(|(line, message)| self.input.complain_at(line, message))?;
            numbers.extend(row);
            if let Some(name) = unused
                && !self.unused.contains(&name)
                && self.unused.len() < MOST_WARNINGS
            {
                let quoted = quoted(name.as_bytes());
                print::warning(format_args!("{}: {quoted} is not used", self.input.name()));
                self.unused.push(name);
            }
        }
        Ok(lines.len())
    }
}

/// What a line should look like.
fn example(subject: Subject) -> &'static str {
    match subject {
        Subject::Rays => r#"an object such as {"origin": [0, 0, 5], "direction": [0, 0, -1]}"#,
        Subject::Points => r#"an object such as {"point": [0, 0, 5]}"#,
    }
}

/// The numbers of a line.
fn parse(text: &[u8], subject: Subject) -> Result<Parsed, String> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let value: Value = serde_json::from_slice(text).map_err(|error| {
        let (column, expected) = (error.column(), example(subject));
        format!("not JSON from column {column} on; expected {expected}")
    })?;
    let Value::Object(object) = value else {
        return Err(format!("no object; expected {}", example(subject)));
    };
    let mut numbers = Vec::with_capacity(8);
    let names: &[&str] = match subject {
        Subject::Rays => {
            numbers.extend(vector(&object, "origin", subject)?);
            numbers.extend(vector(&object, "direction", subject)?);
            numbers.push(limit(&object, "t_min", 0.0)?);
            numbers.push(limit(&object, "t_max", f32::INFINITY)?);
            &["origin", "direction", "t_min", "t_max"]
        }
        Subject::Points => {
            numbers.extend(vector(&object, "point", subject)?);
            &["point"]
        }
    };
    let unused = object.keys().find(|name| !names.contains(&name.as_str())).cloned();
    Ok((numbers, unused))
}

/// Three numbers, NaN for `null`.
fn vector(object: &Map<String, Value>, name: &str, subject: Subject) -> Result<[f32; 3], String> {
    let number = |value: &Value| match value {
        Value::Null => Some(f32::NAN),
        value => value.as_f64().map(|number| number as f32),
    };
    let Some(value) = object.get(name) else {
        return Err(format!("no `{name}`; expected {}", example(subject)));
    };
    let numbers: Option<Vec<f32>> =
        value.as_array().and_then(|values| values.iter().map(number).collect());
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("`{name}` is not an array of three numbers"))
}

/// A number, `missing` if it is not there or `null`.
fn limit(object: &Map<String, Value>, name: &str, missing: f32) -> Result<f32, String> {
    match object.get(name) {
        None | Some(Value::Null) => Ok(missing),
        Some(value) => value
            .as_f64()
            .map(|number| number as f32)
            .ok_or_else(|| format!("`{name}` is not a number")),
    }
}
